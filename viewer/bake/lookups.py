"""Where a microfacet lobe looks up the filtered environment.

The environment is filtered for a lobe seen along the normal (n = v = r). An oblique lobe is another one. Masking and
the factor NoL lean it from the mirror direction towards n, and the Fresnel part b leans the other way. Half vectors
that tilt by d in the plane of incidence turn the reflected direction by 2 d, but those that tilt across it only by
2 d VoH: the lobe is stretched in that plane. So it is the sum of filtered lobes about as wide as it is across, along
directions in that plane. Its wide tails are a share of the irradiance at n, which the surface needs anyhow:

    L ~ sum_i w_i filtered(d_i, level_i) + (1 - sum_i w_i) irradiance(n) / pi,    w_i >= 0, sum_i w_i <= 1

The weights add up to 1, so a white furnace stays white. Both parts of the lobe, a and b, share the lookups and have
weights of their own. The irradiance may not bring more light from farther than TAIL from the lobe's mean direction than
the lobe does: a lamp out there can be a thousand times as bright as what the lobe sees.

Directions and levels minimise the expected squared error in random environments, whose coefficients of degree n have
the variance p_n = (n + 1)^-2, near that of photographed environments. With the spectra lambda of the filters, the
normalised lobe K, and Z_i(x) = sum_n p_n (2 n + 1) / (4 pi) lambda_n,i P_n(x), the addition theorem of Legendre's
polynomials gives the error

    <K, K> - 2 sum_i w_i <K, Z_i> + sum_ij w_i w_j <Z_i, Z_j>
    <K, Z_i> = int K(l) Z_i(l . d_i) dl
    <Z_i, Z_j> = sum_n p_n (2 n + 1) / (4 pi) lambda_n,i lambda_n,j P_n(d_i . d_j)

The best weights for given lookups are those of a small quadratic programme. The lookups themselves are found by a
descent along one coordinate after the other, for all views and roughnesses at once. A small penalty on differences
between neighbours makes the table smooth, so that it can be interpolated.
"""

from __future__ import annotations

from itertools import chain, combinations

import numpy as np

from .irradiance import cosine_spectrum
from .lobe_samples import lobe_samples
from .lobes import lobe_spectrum
from .prefilter import LEVEL_ROUGHNESS, level_of_roughness

GRID = 16  # rows and columns that are fitted; those between are interpolated
DEGREE = 255
TYPICAL_F0 = (0.04, 0.9)  # the errors of a dielectric and of a metal count alike
_NARROW_COLUMNS = 2  # roughnesses whose pair is twice half the single one: that lobe is narrow however it is seen
TAIL = np.radians(60)
T_BOUNDS = (-0.5, 5.0)  # of t: near the normal r = n and t has no effect
WIDEST = np.radians(110)  # largest angle between a lookup and n

_IRRADIANCE = len(LEVEL_ROUGHNESS)  # index of the irradiance among the filters
_ANGLES = 2048  # steps of the tables over angles between 0 and pi
_PSI = np.linspace(0, 1.02 * WIDEST, 200)  # angles of lookups that <K, Z> is tabulated for
_NODES, _SWEEPS, _FIRM_SWEEPS, _SMOOTHNESS = 12, 10, 5, 1e-2


def fit_lookups(ndf: str, masking: str) -> list[np.ndarray]:
    """The lookups of the best sum of one filtered lobe, (GRID, GRID, 1, 4) float64, and of two, (GRID, GRID, 2, 4): t,
    level, and the weights in the parts a and b.

    Row j is NoV = (j / (GRID-1))^2, column i is perceptual roughness i / (GRID-1). A lookup looks along mix(n, r, t).
    """
    fit = _Fit(ndf, masking)
    single, pair = (fit.lookups(fit.descend(start)) for start in fit.starts())
    single[:, 0] = [1, 0, 1, 1]  # the mirror
    pair[:, :_NARROW_COLUMNS] = single[:, :_NARROW_COLUMNS] * [1, 1, 0.5, 0.5]
    return [single, pair]


class _Fit:
    """The errors of lookups for all cells of the grid, C of them, row by row. Below, x is (C, 2 count): the t of
    `count` lookups, then their levels."""

    def __init__(self, ndf: str, masking: str) -> None:
        axis = np.arange(GRID) / (GRID - 1)
        NoV = np.maximum(axis**2, 1e-4)
        NoV[-1] = np.cos(1e-3)  # for v = n the plane of incidence is undefined
        self.theta, self.roughness = np.repeat(np.arccos(NoV), GRID), np.tile(axis, GRID)
        self.lobe_filter, self.filters = _filter_products(ndf)
        columns = [self._column(ndf, masking, NoV, max(r, 0.03) ** 2) for r in axis]
        self.on_lobe, albedo, self.most_irradiance = (
            np.stack(kind, axis=1).reshape(GRID * GRID, *kind[0].shape[1:]) for kind in zip(*columns, strict=True))
        of_parts = albedo[..., None] * np.stack([TYPICAL_F0, np.ones(2)])
        self.shares = of_parts / of_parts.sum(axis=1, keepdims=True)  # of the parts in the lobes with TYPICAL_F0
        # psi, the angle from n, has tan psi = t sin theta / (1 - t + t cos theta), solved for t
        slope = np.sin(WIDEST) * (1 - np.cos(self.theta)) + np.cos(WIDEST) * np.sin(self.theta)
        self.t_most = np.minimum(np.sin(WIDEST) / np.where(slope > 0, slope, 1e-9), T_BOUNDS[1])

    def _column(self, ndf: str, masking: str, NoV: np.ndarray, alpha: float) -> tuple[np.ndarray, ...]:
        """<K, Z>, (GRID, len(_PSI), filters, parts), and the albedos of the parts and the largest weights that they
        allow the irradiance, (GRID, parts)."""
        directions, parts = lobe_samples(ndf, masking, NoV, alpha, _NODES)
        albedo = parts.sum(axis=1)
        most = np.stack([_tail(directions, part, of_lobe=True) / _tail(directions, part, of_lobe=False)
                         for part in np.moveaxis(parts, 2, 0)], axis=1)
        axes = np.stack([np.cos(_PSI), np.sin(_PSI)])
        found = []
        for l, weights in zip(directions, parts / albedo[:, None], strict=True):  # noqa: E741
            angle = np.arccos(np.clip(l[:, :2].astype(np.float32) @ axes.astype(np.float32), -1, 1))
            at = np.rint(angle.T * (_ANGLES / np.pi)).astype(np.int32)
            found.append(np.einsum("psl,sq->plq", self.lobe_filter[at], weights.astype(np.float32), optimize=True))
        return np.stack(found).astype(np.float64), albedo, np.clip(most, 0, 1)

    def starts(self) -> list[np.ndarray]:
        r, level = self.roughness, level_of_roughness(self.roughness)
        return [np.stack([1 - 0.3 * r, 0.8 * level], axis=1),
                np.stack([0.93 - 0.3 * r, 1 + 0 * r, (1 - 0.3 * r) * level, (0.45 + 0.25 * r) * level], axis=1)]

    def lookups(self, x: np.ndarray) -> np.ndarray:
        """(GRID, GRID, count, 4)"""
        count = x.shape[1] // 2
        places = x.reshape(-1, 2, count).swapaxes(1, 2)
        return np.concatenate([places, self.errors(x)[1][:, :count]], axis=2).reshape(GRID, GRID, count, 4)

    def descend(self, x: np.ndarray) -> np.ndarray:
        """Improves x in place. A step along a coordinate goes to the best of four values: the one that there is, one
        on either side, and the vertex of the parabola through these."""
        count = x.shape[1] // 2
        scale = 0.7 * self._quadratic(x)[0][:, 0, 0]
        step = np.repeat([0.1, 0.3], count)[None] * np.ones_like(x)
        stiffness = np.repeat([1.0, 0.25], count)
        mirror = self.roughness == 0
        for sweep in range(_SWEEPS):
            smoothness = _SMOOTHNESS * (10 if sweep < _FIRM_SWEEPS else 1)
            for k in range(2 * count):
                around = _mean_of_neighbours(x[:, k])

                def tried(by: np.ndarray | float, k: int = k, around: np.ndarray = around,
                          penalty: float = smoothness * stiffness[k]) -> tuple[np.ndarray, np.ndarray]:
                    y = self._within(x, k, x[:, k] + by)
                    return self.errors(y)[0] / scale + penalty * (y[:, k] - around) ** 2, y[:, k]

                here, less, more = tried(0.0), tried(-step[:, k]), tried(step[:, k])
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
                step[:, k] *= np.where(best == 0, 0.5, np.where(np.abs(vertex) > 1, 1.3, 0.8))
                step[:, k] = np.clip(step[:, k], 5e-3, 0.5)
        return x

    def _within(self, x: np.ndarray, k: int, value: np.ndarray) -> np.ndarray:
        """x with the coordinate k changed, within its bounds. The first lookup stays the one nearer to n."""
        x, count = x.copy(), x.shape[1] // 2
        if k >= count:
            x[:, k] = np.clip(value, 0, len(LEVEL_ROUGHNESS) - 1)
            return x
        x[:, k] = np.clip(value, T_BOUNDS[0], self.t_most)
        if count == 2:
            x[:, k] = np.minimum(x[:, 0], x[:, 1]) if k == 0 else np.maximum(x[:, 0], x[:, 1])
        return x

    def errors(self, x: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """The error without <K, K>, summed over TYPICAL_F0, (C,), and the best weights, (C, count + 1, parts). The last
        weight is that of the irradiance."""
        products, on_lobe = self._quadratic(x)
        weights = _best_weights(products, on_lobe, self.most_irradiance)
        of_lobes = np.einsum("cip,cpf->cif", weights, self.shares)
        square = np.einsum("cif,cij,cjf->c", of_lobes, products, of_lobes)
        return square - 2 * np.einsum("cip,cpf,cif->c", on_lobe, self.shares, of_lobes), weights

    def _quadratic(self, x: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """<Z, Z>, (C, count + 1, count + 1), and <K, Z>, (C, count + 1, parts)."""
        t, level = np.split(x, 2, axis=1)
        theta = self.theta[:, None]
        psi = np.arctan2(t * np.sin(theta), 1 - t + t * np.cos(theta))
        psi = np.concatenate([np.clip(psi, 0, WIDEST), 0 * theta], axis=1)
        low = np.minimum(level.astype(int), len(LEVEL_ROUGHNESS) - 2)
        blend = np.zeros((*psi.shape, _IRRADIANCE + 1))
        np.put_along_axis(blend[:, :-1], low[..., None], (1 - level + low)[..., None], -1)
        np.put_along_axis(blend[:, :-1], low[..., None] + 1, (level - low)[..., None], -1)
        blend[:, -1, _IRRADIANCE] = 1

        place = psi / _PSI[1]
        before = np.minimum(place.astype(int), len(_PSI) - 2)
        part = (place - before)[..., None, None]
        cell = np.arange(len(x))[:, None]
        on_lobe = (1 - part) * self.on_lobe[cell, before] + part * self.on_lobe[cell, before + 1]
        between = np.rint(np.abs(psi[:, :, None] - psi[:, None]) * (_ANGLES / np.pi)).astype(int)
        rows = np.matmul(blend[:, :, None, None], self.filters[between])[:, :, :, 0]
        return (rows * blend[:, None]).sum(axis=-1), np.matmul(blend[:, :, None], on_lobe)[:, :, 0]


def _tail(directions: np.ndarray, part: np.ndarray, of_lobe: bool) -> np.ndarray:
    """What share of a part's lobe, or else of the irradiance at n, comes from farther than TAIL from the mean direction
    of the part, (GRID,)."""
    mean = np.einsum("js,jsk->jk", part, directions) * [1, 1, 0]
    mean /= np.linalg.norm(mean, axis=1, keepdims=True)
    if of_lobe:
        far = np.einsum("jsk,jk->js", directions, mean) < np.cos(TAIL)
        return (part * far).sum(axis=1) / part.sum(axis=1)
    u, v = (np.indices((48, 48)).reshape(2, -1) + 0.5) / 48  # cosine-weighted directions
    around = np.stack([np.sqrt(1 - u), np.sqrt(u) * np.cos(np.pi * v), np.sqrt(u) * np.sin(np.pi * v)])
    return (mean @ around < np.cos(TAIL)).mean(axis=1)


def _filter_products(ndf: str) -> tuple[np.ndarray, np.ndarray]:
    """Z, (angles, filters) float32, and <Z, Z>, (angles, filters, filters), over the angle from 0 to pi. The filters
    are those of the levels, and of the irradiance."""
    spectra = np.stack([lobe_spectrum(ndf, r * r, DEGREE) if r else np.ones(DEGREE + 1) for r in LEVEL_ROUGHNESS]
                       + [cosine_spectrum(DEGREE)])
    n = np.arange(DEGREE + 1)
    power = (2 * n + 1) / (4 * np.pi * (n + 1.0) ** 2)
    power[0] = 0  # the weights add up to 1, so the mean is exact
    cosine = np.cos(np.linspace(0, np.pi, _ANGLES + 1))
    legendre = [np.ones_like(cosine), cosine]
    for k in range(2, DEGREE + 1):
        legendre.append(((2 * k - 1) * cosine * legendre[-1] - (k - 1) * legendre[-2]) / k)
    table = np.stack(legendre)
    pairs = (power * spectra[:, None] * spectra).reshape(-1, DEGREE + 1) @ table
    return ((power * spectra) @ table).T.astype(np.float32), pairs.T.reshape(-1, len(spectra), len(spectra)).copy()


def _best_weights(products: np.ndarray, on_lobe: np.ndarray, most: np.ndarray) -> np.ndarray:
    """The weights, (C, n, parts), of least error: not negative, of sum 1, and the last one at most `most`, (C, parts).

    The error is convex, so if the best last weight is too large, the best allowed one is `most`.
    """
    free = _nonnegative_weights(products, on_lobe, np.ones_like(most))
    fixed = most[:, None]
    bounded = _nonnegative_weights(products[:, :-1, :-1], on_lobe[:, :-1] - fixed * products[:, :-1, -1:], 1 - most)
    return np.where(free[:, -1:] > fixed, np.concatenate([bounded, fixed], axis=1), free)


def _nonnegative_weights(products: np.ndarray, on_lobe: np.ndarray, total: np.ndarray) -> np.ndarray:
    """The weights, (C, n, parts), not negative and of sum `total`, (C, parts), of least error: the best of the
    solutions in which some of the n are 0. A hair of regularisation makes equal lookups share alike."""
    cells, n, parts = on_lobe.shape
    least = np.full((cells, parts), np.inf)
    best = np.zeros_like(on_lobe)
    for used in chain.from_iterable(combinations(range(n), k) for k in range(1, n + 1)):
        k, some = len(used), list(used)
        system = np.ones((cells, k + 1, k + 1))
        system[:, :k, :k] = products[:, some][:, :, some] + 1e-6 * products[:, :1, :1] * np.eye(k)
        system[:, k, k] = 0
        weights = np.zeros_like(on_lobe)
        weights[:, some] = np.linalg.solve(system, np.concatenate([on_lobe[:, some], total[:, None]], axis=1))[:, :k]
        error = np.einsum("cip,cij,cjp->cp", weights, products, weights) - 2 * (weights * on_lobe).sum(axis=1)
        better = (weights.min(axis=1) > -1e-9) & (error < least)
        least = np.where(better, error, least)
        best = np.where(better[:, None], weights, best)
    return np.maximum(best, 0)


def _mean_of_neighbours(values: np.ndarray) -> np.ndarray:
    grid = np.pad(values.reshape(GRID, GRID), 1, mode="edge")
    return ((grid[2:, 1:-1] + grid[:-2, 1:-1] + grid[1:-1, 2:] + grid[1:-1, :-2]) / 4).ravel()
