"""The density of fibres on a grid, with their directions.

A fibre of radius r and length l in a volume V adds 2 r l sin(a) / V to the extinction of light that meets it at the
angle a. Over directions from all around the sine is pi / 4 in the mean. The unit of length is the side of a cell.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ..scene.curve_segments import segments
from ..scene.curves import Curves

CELLS = 1 << 13
"""About so many cells, as cubes, in the box about all curves."""
MEAN_SINE = math.pi / 4
_OWN = 0.71
"""A fibre of radius r is spread over the cells that it passes, of side c. From its place, anywhere in the cross-section
of a cell, the way out of that is 0.473 c across the fibre in the mean, on which it adds 2 r / c^2 times that to the
optical depth, whatever the angle to the fibre. Of this 3/4 are left where the depth is interpolated between cells."""
_OWN_PLACE = 9 / 16
"""So much of what a fibre along an axis adds to its cells is found at its place, anywhere in the cross-section of a
cell, where values are interpolated: 3/4 in each direction across it."""
_PAIRS = (0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2)


@dataclass(frozen=True, eq=False)
class FibreGrid:
    """Fibres in cells of side `cell` from the corner `low` (x, y, z) on.

    `density` (nz, ny, nx) is 2 r l / V: the extinction of light across them. `spread` (6, nz, ny, nx) is the mean
    of t t^T of their directions t, times the density: xx, yy, zz, xy, xz, yz. `mean` (3, nz, ny, nx) is that of t.
    `own` (nz, ny, nx) is what a fibre adds to the optical depth at its own place, which it does not hide from itself.
    """

    low: np.ndarray
    cell: float
    density: np.ndarray
    spread: np.ndarray
    mean: np.ndarray
    own: np.ndarray

    @property
    def shape(self) -> tuple[int, ...]:
        return self.density.shape

    @property
    def centers(self) -> np.ndarray:
        """(cells, 3), x fastest."""
        z, y, x = np.indices(self.shape).reshape(3, -1)
        return self.low + self.cell * (np.stack([x, y, z], axis=1) + 0.5)

    @property
    def filled(self) -> np.ndarray:
        """The share of space that fibres fill, (nz, ny, nx): pi r^2 l / V. None of it where fibres are yarns'."""
        filled: np.ndarray = np.float32(math.pi / 2 / _OWN) * self.density * self.own
        return filled

    @property
    def filled_by_others(self) -> np.ndarray:
        """The same for the others about a fibre, at its place."""
        return np.maximum(self.filled - np.float32(_OWN_PLACE * math.pi / _OWN**2) * self.own**2, 0)

    def moments(self) -> tuple[np.ndarray, np.ndarray]:
        """The axis (3, nz, ny, nx) of the fibres in each cell, and (5, nz, ny, nx) the mean over them of the Legendre
        polynomials P_0 to P_4 of the cosine of the angle to it. Those of P_3 and P_4 follow from P_2, as for a normal
        distribution."""
        filled = self.density > 0
        tensor = self.spread[:, filled] / self.density[filled]
        values, vectors = np.linalg.eigh(tensor[[0, 3, 4, 3, 1, 5, 4, 5, 2]].T.reshape(-1, 3, 3))
        found = vectors[:, :, 2].T
        cosine = (self.mean[:, filled] / self.density[filled] * found).sum(axis=0)
        first, second = np.minimum(np.abs(cosine), 1), np.clip(1.5 * values[:, 2] - 0.5, 0, 1)
        axis, means = np.zeros((3, *self.shape), np.float32), np.zeros((5, *self.shape), np.float32)
        axis[:, filled] = found * np.where(cosine < 0, -1, 1)
        means[:, filled] = np.ones_like(first), first, second, first * second**(5 / 3), second**(10 / 3)
        return axis, means

    def extinction(self, direction: np.ndarray) -> np.ndarray:
        """Of light along `direction` (x, y, z), or (3, nz, ny, nx): (nz, ny, nx). The mean of the sine over the fibres
        of a cell is taken for the root of the mean of its square."""
        d = np.asarray(direction, np.float32)
        across = self.density.copy()
        for part, (i, j) in zip(self.spread, _PAIRS, strict=True):
            across -= part * ((1 if i == j else 2) * d[i] * d[j])
        return np.sqrt(self.density * np.maximum(across, 0))

    def depth(self, direction: np.ndarray) -> np.ndarray:
        """The optical depth of other fibres along `direction` (x, y, z), from each cell on, (nz, ny, nx)."""
        sweep = _Sweep(direction)
        halves = sweep.slices(self.extinction(direction) / np.float32(2 * sweep.steepest))
        out, behind = [], np.zeros_like(halves[0])
        for half in halves:
            out.append(sweep.moved(behind) + half)
            behind = out[-1] + half
        return self._of_others(sweep.whole(out))

    def gathered(self, direction: np.ndarray, source: np.ndarray, kept: np.ndarray) -> np.ndarray:
        """The radiance (k, nz, ny, nx) that comes to each cell from `direction` (x, y, z), where others scatter as much
        as they would if the radiance `source` (k, nz, ny, nx) was all around them. `kept` (k,) of their extinction
        counts."""
        sweep, factor = _Sweep(direction), kept.astype(np.float32)[:, None, None]
        halves = sweep.slices(self.extinction(direction) / np.float32(2 * sweep.steepest))
        sources = sweep.slices(source)
        out, behind = [], np.zeros_like(sources[0])
        for half, own, here in zip(halves, sweep.slices(self.own), sources, strict=True):
            more = sweep.moved(behind) - here
            out.append(here + more * np.exp(-factor * np.maximum(half - own, 0)))
            behind = here + more * np.exp(-2 * factor * half)
        return sweep.whole(out)

    def depth_to(self, point: np.ndarray) -> np.ndarray:
        """The optical depth of other fibres from each cell to a point, (nz, ny, nx), by steps of a cell."""
        shape = np.array(self.shape[::-1])
        way = point - self.centers
        reach = np.maximum(np.linalg.norm(way, axis=1), 1e-30)
        steps = (way / reach[:, None]).astype(np.float32)
        at = ((self.centers - self.low) / self.cell + 0.5 + 0.5 * steps).astype(np.float32)  # centres at whole numbers
        fields = np.pad(np.concatenate([self.density[None], self.spread]), ((0, 0), (1, 1), (1, 1), (1, 1)))
        weights = np.stack([np.ones(len(at)), *(-(1 if i == j else 2) * steps[:, i] * steps[:, j] for i, j in _PAIRS)])
        depth = np.zeros(len(at))
        for step in range(int(np.ceil(np.linalg.norm(shape)))):
            inside = np.clip(at, 0, shape + 0.999)
            low = inside.astype(np.int32)
            x, y, z = low.T
            a, b, c = (inside - low).T
            lines = [(1 - a) * fields[:, z + k, y + j, x] + a * fields[:, z + k, y + j, x + 1]
                     for k in (0, 1) for j in (0, 1)]
            here = (1 - c) * ((1 - b) * lines[0] + b * lines[1]) + c * ((1 - b) * lines[2] + b * lines[3])
            across = np.sqrt(np.maximum(here[0] * (here * weights).sum(axis=0), 0))
            depth += across * ((step + 0.5) * self.cell < reach)
            at += steps
        return self._of_others(depth.reshape(self.shape))

    def _of_others(self, depth: np.ndarray) -> np.ndarray:
        return np.maximum(depth - self.own, 0)


class _Sweep:
    """Carries values (..., nz, ny, nx) against `direction` (x, y, z): from slice to slice along the axis it follows
    most. The first slice is the last that a ray passes. Values are interpolated within the slices."""

    def __init__(self, direction: np.ndarray) -> None:
        along = np.asarray(direction, np.float64)[::-1]  # z, y, x
        self._axis = int(np.abs(along).argmax()) - 3
        self._backwards = along[self._axis] > 0
        self.steepest = abs(along[self._axis])
        slopes = np.delete(along, self._axis) / self.steepest
        self._low = np.floor(slopes).astype(int)
        self._between = (slopes - self._low).astype(np.float32)

    def slices(self, values: np.ndarray) -> np.ndarray:
        slices = np.moveaxis(values, self._axis, 0)
        return slices[::-1] if self._backwards else slices

    def whole(self, slices: list[np.ndarray]) -> np.ndarray:
        """The opposite of `slices`."""
        stacked = np.stack(slices[::-1] if self._backwards else slices)
        return np.moveaxis(stacked, 0, self._axis)

    def moved(self, values: np.ndarray) -> np.ndarray:
        """`values` (..., n, m) of the slice before, at the places that the ray meets there; 0 beyond the edges."""
        n, m = values.shape[-2:]
        padded = np.zeros((*values.shape[:-2], n + 2, m + 2), values.dtype)
        padded[..., 1:-1, 1:-1] = values
        low, (a, b) = self._low, self._between
        parts = [[padded[..., 1 + y:1 + y + n, 1 + x:1 + x + m] for x in (low[1], min(low[1] + 1, 1))]
                 for y in (low[0], min(low[0] + 1, 1))]
        moved: np.ndarray = ((1 - a) * ((1 - b) * parts[0][0] + b * parts[0][1])
                             + a * ((1 - b) * parts[1][0] + b * parts[1][1]))
        return moved


def fibre_grid(all_curves: Sequence[Curves], are_yarns: bool = False) -> FibreGrid:
    """The density of all curves' fibres. The fibres of a curve that is a yarn hide light from each other."""
    corners = np.concatenate([curves.corners for curves in all_curves])
    low, high = corners.min(axis=0), corners.max(axis=0)
    sides = np.maximum(high - low, 1e-3 * (high - low).max() + 1e-30)
    cell = float(np.cbrt(sides.prod() / CELLS))
    cell = max(cell, float(sides.max()) / 256)
    shape = np.ceil(sides / cell).astype(int) + 2
    low = (low + high) / 2 - shape * cell / 2
    total = np.zeros((11, shape.prod()))
    for curves in all_curves:
        ends = segments(curves).ends.astype(np.float64)
        chord = ends[:, 1, :3] - ends[:, 0, :3]
        way = np.linalg.norm(chord, axis=1)
        along = (chord / np.maximum(way, 1e-300)[:, None]).T
        count = np.clip(np.ceil(2 * way / cell), 1, 512).astype(np.int64)
        which = np.repeat(np.arange(len(way)), count)
        t = (np.arange(len(which)) - np.repeat(np.cumsum(count) - count, count) + 0.5) / count[which]
        points = ends[which, 0] + t[:, None] * (ends[which, 1] - ends[which, 0])
        x, y, z = np.clip(((points[:, :3] - low) / cell).astype(np.int64), 0, shape - 1).T
        area = 2 * points[:, 3] * (way / count)[which]
        cells = (z * shape[1] + y) * shape[0] + x
        for k, share in enumerate([np.ones(len(way)), *(along[i] * along[j] for i, j in _PAIRS), *along]):
            total[k] += np.bincount(cells, area * share[which], len(total[k]))
        total[10] += np.bincount(cells, area * points[:, 3], len(total[10]))
    own = (0 if are_yarns else _OWN / cell) * total[10] / np.maximum(total[0], 1e-300)
    total = (total / cell**2).astype(np.float32).reshape(11, *shape[::-1])
    return FibreGrid(low, cell, total[0], total[1:7], total[7:10], own.astype(np.float32).reshape(shape[::-1]))
