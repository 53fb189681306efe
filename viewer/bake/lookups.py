"""Where a microfacet lobe looks up the filtered environment.

The environment is filtered for lobes seen along the normal (n = v = r). An oblique lobe is another one. Masking and
the factor NoL lean it from the mirror direction towards n, and the Fresnel part b leans the other way. Half vectors
that tilt by d in the plane of incidence turn the reflected direction by 2 d, but those that tilt across it only by
2 d VoH: the lobe is stretched in that plane. So it is the sum of filtered lobes about as wide as it is across, along
directions in that plane. Its wide tails are a share of the irradiance at n, which the surface needs anyhow:

    L ~ sum_i w_i filtered(d_i, level_i) + (1 - sum_i w_i) irradiance(n) / pi,    w_i >= 0, sum_i w_i <= 1

The weights add up to 1, so a white furnace stays white. Both parts of the lobe, a and b, share the lookups and have
weights of their own.

Directions and levels minimise the expected squared relative error under uniform light of radiance 1 and a lamp
somewhere, whose light is p g(c . l), where g is a blurred spot that integrates to 1. With the kernels K of the lobe and
k_i of the filters, which integrate to 1 too, blurred by g,

    error = int dc u(c) (sum_i w_i k_i(c) - K(c))^2,    u(c) = (p / (1 + p max(K(c), s max K)))^2

u is the weight of a relative error: a lamp that the lobe hardly sees must not be seen by a lookup, for it may be a
thousand times as bright as what the lobe does see. (Without it, with the absolute errors of random environments, metals
in a studio were too bright or too dark by half where no lamp is mirrored.) But a relative error is at most 1 where the
sum sees too little and has no bound where it sees too much, so that the best sum would be too narrow: at grazing angles
it had half of the light of a lamp beside the mirror direction. So below the share s of the largest K, one of FLOORS,
all errors count as at that share. LAMPS are small, for what is mirrored, and large, for what lights a room.

The best weights for given lookups are those of a small quadratic programme. The lookups themselves are found by a
descent along one coordinate after the other, for all views and roughnesses at once. A small penalty on differences
between neighbours makes the table smooth, so that it can be interpolated.
"""

from __future__ import annotations

from functools import reduce
from itertools import chain, combinations
from typing import NamedTuple

import numpy as np

from .irradiance import cosine_spectrum
from .lobe_samples import lobe_samples
from .prefilter import LEVELS, level_of_roughness, level_spectrum

GRID = 16  # rows and columns that are fitted; those between are interpolated
DEGREE = 255
TYPICAL_F0 = (0.04, 0.9)  # the errors of a dielectric and of a metal count alike
LAMPS = ((0.0, 1.0, 10.0), (0.2, 0.0, 40.0))  # radius in radians, radius as a multiple of alpha, radiance
FLOORS = (0.0, 0.4)  # s of one lookup, which is for narrow lobes, and of two
_SMALLEST_LAMP = 0.02  # radians
_NARROW_COLUMNS = 2  # roughnesses whose pair is twice half the single one: that lobe is narrow however it is seen
T_BOUNDS = (-0.5, 5.0)  # of t: near the normal r = n and t has no effect
WIDEST = np.radians(110)  # largest angle between a lookup and n

_ANGLES = 2048  # steps of the tables over angles between 0 and pi
_RINGS, _SECTORS = 14, 8  # places of the lamp: polar angles about the lobe, and azimuths of one half
_NODES, _SWEEPS, _FIRM_SWEEPS, _SMOOTHNESS = 10, 10, 5, 8e-3
_WIDE_ROUGHNESS = 0.75  # from here on the descent starts with one lookup that goes to the widest level at n


def fit_lookups(ndf: str, masking: str) -> list[np.ndarray]:
    """The lookups of the best sum of one filtered lobe, (GRID, GRID, 1, 4) float64, and of two, (GRID, GRID, 2, 4): t,
    level, and the weights in the parts a and b.

    Row j is NoV = (j / (GRID-1))^2, column i is perceptual roughness i / (GRID-1). A lookup looks along mix(n, r, t).
    """
    fit = _Fit(ndf, masking)
    found = []
    for start, floor in zip(fit.starts(), FLOORS, strict=True):
        fit.weigh(floor)
        found.append(fit.lookups(fit.descend(start)))
    single, pair = found
    single[:, 0] = [1, 0, 1, 1]  # the mirror
    pair[:, :_NARROW_COLUMNS] = single[:, :_NARROW_COLUMNS] * [1, 1, 0.5, 0.5]
    return [single, pair]


class _Sum(NamedTuple):
    """Lookups and the irradiance, n = count + 1 of them, for all cells: their kernels at the places of all lamps,
    (C, n, lamps Q); the integrals of u k_i k_j, (C, parts, n, n); and those of u k_i K, (C, parts, n)."""

    kernels: np.ndarray
    products: np.ndarray
    on_lobe: np.ndarray


class _Fit:
    """The errors of lookups for all cells of the grid, C of them, row by row. Below, x is (C, 2 count): the t of
    `count` lookups, then their levels. A lamp is at one of Q places."""

    def __init__(self, ndf: str, masking: str) -> None:
        axis = np.arange(GRID) / (GRID - 1)
        NoV = np.maximum(axis**2, 1e-4)
        NoV[-1] = np.cos(1e-3)  # for v = n the plane of incidence is undefined
        self.theta, self.roughness = np.repeat(np.arccos(NoV), GRID), np.tile(axis, GRID)
        # psi, the angle from n, has tan psi = t sin theta / (1 - t + t cos theta), solved for t
        slope = np.sin(WIDEST) * (1 - np.cos(self.theta)) + np.cos(WIDEST) * np.sin(self.theta)
        self.t_most = np.minimum(np.sin(WIDEST) / np.where(slope > 0, slope, 1e-9), T_BOUNDS[1])
        self.legendre = np.polynomial.legendre.legvander(np.cos(np.linspace(0, np.pi, _ANGLES + 1)), DEGREE)
        self.filters = np.stack([level_spectrum(ndf, k, DEGREE) for k in range(LEVELS)] + [cosine_spectrum(DEGREE)])
        columns = [self._column(ndf, masking, NoV, max(r, 0.05) ** 2) for r in axis]
        places, of_lobe, solid_angles, powers, shares, tables = (
            np.stack(kind) for kind in zip(*columns, strict=True))
        self.places, self.shares = (kind.swapaxes(0, 1).reshape(GRID * GRID, *kind.shape[2:])
                                    for kind in (places, shares))
        # (columns, lamps, GRID, Q, parts) to (C, parts, lamps Q)
        self.of_lobe = of_lobe.transpose(2, 0, 4, 1, 3).reshape(GRID * GRID, 2, len(LAMPS), -1)
        self.solid_angles, self.powers = np.tile(solid_angles, (GRID, 1)), np.tile(powers, (GRID, 1))
        self.tables = tables.ravel()
        lamps, of_column = tables.shape[1], tables[0, 0].size
        self.first = ((np.tile(np.arange(GRID), GRID)[:, None] * lamps + np.arange(lamps)) * of_column)[..., None]
        self.irradiance = self.tables[self.first + self._angles(0 * self.theta) + LEVELS].reshape(GRID * GRID, -1)

    def _column(self, ndf: str, masking: str, NoV: np.ndarray, alpha: float) -> tuple[np.ndarray, ...]:
        """Of one roughness: the places of the lamp, (GRID, Q, 3); K there, (lamps, GRID, Q, parts); the solid angles
        of the places, (Q,); p, (lamps,); how much the errors of the parts count, (GRID, parts); and the kernels of the
        filters, (lamps, angles, filters)."""
        directions, parts = lobe_samples(ndf, masking, NoV, alpha, _NODES)
        albedo = parts.sum(axis=1)
        parts = parts / albedo[:, None]
        places, solid_angle = _places(directions, parts.mean(axis=2), alpha)
        degrees = np.arange(DEGREE + 1)
        of_lobe, powers, tables = [], [], []
        for radius, of_alpha, radiance in LAMPS:
            sigma = max(radius + of_alpha * alpha, _SMALLEST_LAMP)
            blurred = (2 * degrees + 1) / (4 * np.pi) * np.exp(-degrees * (degrees + 1) * sigma**2 / 2)
            seen = _seen_lamp((self.legendre @ blurred).astype(np.float32), places, directions, parts)
            of_lobe.append(seen)
            powers.append(radiance * 2 * np.pi * sigma**2)
            tables.append(self.legendre @ (blurred * self.filters).T)
        of_parts = albedo[..., None] * np.stack([TYPICAL_F0, np.ones(2)])
        shares = ((of_parts / of_parts.sum(axis=1, keepdims=True)) ** 2).mean(axis=2)
        return places, np.stack(of_lobe), solid_angle, np.array(powers), shares, np.stack(tables)

    def weigh(self, floor: float) -> None:
        """Let errors count by u with s = `floor`."""
        power = self.powers[:, None, :, None]
        floored = np.maximum(self.of_lobe, floor * self.of_lobe.max(axis=3, keepdims=True))
        weights = self.solid_angles[:, None, None] * (power / (1 + power * floored)) ** 2
        of_lobe, self.weights = (kind.reshape(GRID * GRID, 2, -1) for kind in (self.of_lobe, weights))
        self.on_lobe = self.weights * of_lobe
        self.least = -(self.on_lobe * of_lobe).sum(axis=2)  # of no error: that of the weights is added to it

    def starts(self) -> list[np.ndarray]:
        r, level = self.roughness, level_of_roughness(self.roughness)
        wide = np.clip((r - _WIDE_ROUGHNESS) / (1 - _WIDE_ROUGHNESS), 0, 1)
        wide = wide * wide * (3 - 2 * wide)
        return [np.stack([1 - 0.3 * r, 0.8 * level], axis=1),
                np.stack([(0.93 - 0.3 * r) * (1 - wide), 1 + 0 * r,
                          (1 - wide) * (1 - 0.3 * r) * level + wide * 5.6, (0.45 + 0.25 * r) * level], axis=1)]

    def lookups(self, x: np.ndarray) -> np.ndarray:
        """(GRID, GRID, count, 4)"""
        count = x.shape[1] // 2
        places = x.reshape(-1, 2, count).swapaxes(1, 2)
        weights = self._errors(self._sum(x))[1][:, :count]
        return np.concatenate([places, weights], axis=2).reshape(GRID, GRID, count, 4)

    def descend(self, x: np.ndarray) -> np.ndarray:
        """Improves x in place. A step along a coordinate goes to the best of four values: the one that there is, one
        on either side, and the vertex of the parabola through these."""
        count = x.shape[1] // 2
        step = np.repeat([0.1, 0.3], count)[None] * np.ones_like(x)
        stiffness = np.repeat([1.0, 0.25], count)
        mirror = self.roughness == 0
        now = self._sum(x)
        for sweep in range(_SWEEPS):
            smoothness = _SMOOTHNESS * (10 if sweep < _FIRM_SWEEPS else 1)
            for k in range(2 * count):
                around = _mean_of_neighbours(x[:, k])

                def penalised(value: np.ndarray, lookups: _Sum, around: np.ndarray = around,
                              penalty: float = smoothness * stiffness[k]) -> np.ndarray:
                    return self._errors(lookups)[0] + penalty * (value - around) ** 2

                def tried(by: np.ndarray, k: int = k, now: _Sum = now) -> tuple[np.ndarray, np.ndarray]:
                    y = self._within(x, k, x[:, k] + by)
                    return penalised(y[:, k], self._with(now, y, k % count)), y[:, k]

                here, less, more = (penalised(x[:, k], now), x[:, k]), tried(-step[:, k]), tried(step[:, k])
                bend = less[0] + more[0] - 2 * here[0]
                slope = less[0] - more[0]
                vertex = np.where(bend > 1e-12, 0.5 * slope / np.maximum(bend, 1e-12), 2 * np.sign(slope))
                parabola = tried(step[:, k] * np.clip(vertex, -2, 2))
                error, value = (np.stack(pair) for pair in zip(here, less, more, parabola, strict=True))
                best = error.argmin(axis=0)
                chosen = np.take_along_axis(value, best[None], axis=0)[0]
                x[:, k] = np.where(mirror, float(k < count), chosen)
                if k < count:  # at the normal t has no effect, but what is beside it is interpolated with it
                    x[-GRID:, k] = x[-2 * GRID:-GRID, k]
                now = self._with(now, x, k % count)
                step[:, k] *= np.where(best == 0, 0.5, np.where(np.abs(vertex) > 1, 1.3, 0.8))
                step[:, k] = np.clip(step[:, k], 5e-3, 0.5)
        return x

    def _within(self, x: np.ndarray, k: int, value: np.ndarray) -> np.ndarray:
        """x with the coordinate k changed, within its bounds. The first lookup stays the one nearer to n."""
        x, count = x.copy(), x.shape[1] // 2
        if k >= count:
            x[:, k] = np.clip(value, 0, LEVELS - (1 if count == 2 else 2))  # one lookup alone is for narrow lobes
            return x
        x[:, k] = np.clip(value, T_BOUNDS[0], self.t_most)
        if count == 2:
            x[:, k] = np.minimum(x[:, 0], x[:, 1]) if k == 0 else np.maximum(x[:, 0], x[:, 1])
        return x

    def _errors(self, lookups: _Sum) -> tuple[np.ndarray, np.ndarray]:
        """The error, of both parts as they count, (C,), and the best weights, (C, count + 1, parts). The last weight
        is that of the irradiance."""
        best = _nonnegative_weights(lookups.products, lookups.on_lobe)
        error = np.einsum("cpi,cpij,cpj->cp", best, lookups.products, best) - 2 * (best * lookups.on_lobe).sum(axis=2)
        return ((error - self.least) * self.shares).sum(axis=1), best.swapaxes(1, 2)

    def _sum(self, x: np.ndarray) -> _Sum:
        cells, count = len(x), x.shape[1] // 2
        n, parts = count + 1, self.weights.shape[1]
        empty = _Sum(np.zeros((cells, n, self.weights.shape[2])), np.zeros((cells, parts, n, n)),
                     np.zeros((cells, parts, n)))
        return reduce(lambda found, i: self._with(found, x, i), range(n), empty)

    def _with(self, lookups: _Sum, x: np.ndarray, i: int) -> _Sum:
        """The sum with lookup i taken anew from x; the irradiance is the last one."""
        kernels, products, on_lobe = (array.copy() for array in lookups)
        count = x.shape[1] // 2
        kernels[:, i] = self._kernel(x[:, i], x[:, count + i]) if i < count else self.irradiance
        row = (self.weights * kernels[:, None, i]) @ kernels.swapaxes(1, 2)
        products[:, :, i] = products[..., i] = row
        on_lobe[..., i] = (self.on_lobe @ kernels[:, i, :, None])[..., 0]
        return _Sum(kernels, products, on_lobe)

    def _kernel(self, t: np.ndarray, level: np.ndarray) -> np.ndarray:
        """k of a lookup at the places of all lamps, (C, lamps Q)."""
        psi = np.clip(np.arctan2(t * np.sin(self.theta), 1 - t + t * np.cos(self.theta)), 0, WIDEST)
        low = np.minimum(level.astype(int), LEVELS - 2)[:, None, None]
        part, at = level[:, None, None] - low, self.first + self._angles(psi) + low
        return ((1 - part) * self.tables[at] + part * self.tables[at + 1]).reshape(len(t), -1)

    def _angles(self, psi: np.ndarray) -> np.ndarray:
        """Where the places of the lamp are in a table, (C, 1, Q), for a lookup at the angle psi, (C,), from n."""
        cosine = np.cos(psi)[:, None] * self.places[..., 0] + np.sin(psi)[:, None] * self.places[..., 1]
        at = np.rint(np.arccos(np.clip(cosine, -1, 1)) * (_ANGLES / np.pi)).astype(int)
        return (at * (LEVELS + 1))[:, None]


def _places(directions: np.ndarray, whole: np.ndarray, alpha: float) -> tuple[np.ndarray, np.ndarray]:
    """Places all around, (GRID, Q, 3), dense about the mean direction of the lobes, and their solid angles, (Q,). The
    coordinates are those of the directions."""
    mean = np.einsum("js,jsk->jk", whole, directions) * [1, 1, 0]
    mean /= np.linalg.norm(mean, axis=1, keepdims=True)
    node, weight = np.polynomial.legendre.leggauss(_RINGS)
    node, weight = (node + 1) / 2, weight / 2
    density = np.log(np.pi / (2 * alpha)) + 0.5
    angle = np.pi * np.sinh(density * node) / np.sinh(density)
    weight = weight * np.pi * density * np.cosh(density * node) / np.sinh(density) * np.sin(angle)
    azimuth = (np.arange(_SECTORS) + 0.5) / _SECTORS * np.pi
    along, up, across = (kind.ravel()[:, None] for kind in np.broadcast_arrays(
        np.cos(angle)[:, None], np.outer(np.sin(angle), np.cos(azimuth)), np.outer(np.sin(angle), np.sin(azimuth))))
    turned = mean[:, [1, 0, 2]] * [-1, 1, 0]
    places = along * mean[:, None] + up * turned[:, None] + across * [0, 0, 1]
    return places, np.repeat(weight, _SECTORS) * 2 * np.pi / _SECTORS


def _seen_lamp(lamp: np.ndarray, places: np.ndarray, directions: np.ndarray, parts: np.ndarray) -> np.ndarray:
    """What both parts of the lobes see of a lamp at the places, (GRID, Q, parts). `lamp` is a table over the angle."""
    found = []
    for place, direction, part in zip(places, directions, parts, strict=True):
        both = np.concatenate([direction, direction * [1, 1, -1]])  # the samples are one half of the lobe
        angle = np.arccos(np.clip(place.astype(np.float32) @ both.T.astype(np.float32), -1, 1))
        found.append(lamp[np.rint(angle * (_ANGLES / np.pi)).astype(np.int32)] @ np.concatenate([part, part]) / 2)
    return np.maximum(np.stack(found), 0)


def _nonnegative_weights(products: np.ndarray, on_lobe: np.ndarray) -> np.ndarray:
    """The weights, (C, parts, n), not negative and of sum 1, of least error: the best of the solutions in which some
    of the n are 0. A hair of regularisation makes equal lookups share alike."""
    cells, parts, n = on_lobe.shape
    size = np.trace(products, axis1=2, axis2=3)[..., None]
    products, on_lobe = products / size[..., None], on_lobe / size
    least = np.full((cells, parts), np.inf)
    best = np.zeros_like(on_lobe)
    for used in chain.from_iterable(combinations(range(n), k) for k in range(1, n + 1)):
        k, some = len(used), list(used)
        system = np.ones((cells, parts, k + 1, k + 1))
        system[..., :k, :k] = products[:, :, some][..., some] + 1e-6 * np.eye(k)
        system[..., k, k] = 0
        weights = np.zeros_like(on_lobe)
        asked = np.concatenate([on_lobe[..., some], np.ones((cells, parts, 1))], axis=2)
        weights[..., some] = np.linalg.solve(system, asked[..., None])[..., :k, 0]
        error = np.einsum("cpi,cpij,cpj->cp", weights, products, weights) - 2 * (weights * on_lobe).sum(axis=2)
        better = (weights.min(axis=2) > -1e-9) & (error < least)
        least = np.where(better, error, least)
        best = np.where(better[..., None], weights, best)
    return np.maximum(best, 0)


def _mean_of_neighbours(values: np.ndarray) -> np.ndarray:
    grid = np.pad(values.reshape(GRID, GRID), 1, mode="edge")
    return ((grid[2:, 1:-1] + grid[:-2, 1:-1] + grid[1:-1, 2:] + grid[1:-1, :-2]) / 4).ravel()
