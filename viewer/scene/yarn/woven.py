"""The yarns of a weave as curves, and their fibres."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np

from ...errors import UsageError
from ..curves import Curves
from ..weave import LEAST_BEND, Weave, Yarn
from .fibres import joined, yarn_fibres
from .kind import YarnKind

_STEPS = 6
"""Points of a yarn's axis on each cell."""


@dataclass(frozen=True)
class _System:
    """The warp (`axis` 1, along +Y) or the weft (`axis` 0). `above` has a row for each yarn, with its crossings; a cell
    is `apart` from one yarn to the next and `pitch` along it. `height` is that of an arc over one crossing."""

    yarn: Yarn
    axis: int
    above: np.ndarray
    apart: float
    pitch: float
    height: float

    @property
    def offsets(self) -> np.ndarray:
        """Where the yarns lie, about 0."""
        count = len(self.above)
        return (np.arange(count) - (count - 1) / 2) * self.apart

    @property
    def length(self) -> float:
        return self.above.shape[1] * self.pitch

    def lifted(self, yarn: np.ndarray, along: np.ndarray) -> np.ndarray:
        """The height of yarns at places on them, about 0: an arc over and an arc under other yarns in turn, all with
        the same slope at their ends. An arc over n crossings is n times as high as one over a single one."""
        count = self.above.shape[1]
        place = along / self.pitch + count / 2
        cell = np.clip(np.floor(place).astype(np.int64), 0, count - 1)
        before, after = _runs(self.above)
        n = (before + 1 + after)[yarn, cell]
        t = (place - cell + before[yarn, cell]) / n
        return np.where(self.above[yarn, cell], 4.0, -4.0) * self.height * n * t * (1 - t)


def weave_yarns(weave: Weave, repeats: tuple[int, int] = (1, 1)) -> Curves:
    """The warp and then the weft yarns of a piece of cloth with so many repeats of the draft in u and v.

    u is +X and v is +Y, and the warp that lies above is nearer to +Z; a unit of u is one of length. The cloth is about
    the origin. Yarns are round, and touch where they cross. They are as wide as the weave's, half of `Yarn.width` of
    their cell being their radius, unless one would go through another: round yarns leave gaps. Warp and weft bend in
    the ratio of their `Yarn.bend`. The colours are those of `Yarn`. Raises UsageError for repeats that are no two whole
    numbers above 0.
    """
    _check(repeats)
    slim = 1.0
    while _overlap(*_round(weave, (1, 1), slim), slim):
        slim *= 0.98
    parts = []
    for system in _round(weave, repeats, slim):
        yarn, along = _points(system)
        parts.append(_strands(system, yarn, along, system.lifted(yarn, along), slim))
    return joined(*parts)


def weave_fibres(weave: Weave, kind: YarnKind, repeats: tuple[int, int] = (1, 1)) -> Curves:
    """The fibres of a weave whose yarns are pressed flat, as those of cloth are, and leave no more gaps than it says.

    The cloth lies as that of `weave_yarns` does. A yarn is as wide as the weave's and bends by `Yarn.bend` where it
    goes from one side to the other. It is spun as `kind`, with the twist of `Yarn`. Its cross-section is a lens of such
    a height that yarns touch where they cross (Hearle and Shanahan 1978), and none goes through another. Raises
    UsageError as `weave_yarns` and `yarn_fibres` do.
    """
    _check(repeats)
    warp, weft = _flat(weave, repeats)
    return joined(*(_pressed(system, other.height, replace(kind, twist=system.yarn.twist))
                    for system, other in ((warp, weft), (weft, warp))))


def _check(repeats: tuple[int, int]) -> None:
    is_pair = isinstance(repeats, (tuple, list)) and len(repeats) == 2
    if not is_pair or any(not isinstance(count, int) or count < 1 for count in repeats):
        raise UsageError(f"repeats={repeats}: they must be two whole numbers above 0")


def _flat(weave: Weave, repeats: tuple[int, int]) -> tuple[_System, _System]:
    above = np.tile(np.array(weave.draft), repeats[::-1])
    across, along = 1 / weave.density[0], 1 / weave.density[1]
    slopes = [math.tan(math.radians(max(yarn.bend, LEAST_BEND))) for yarn in (weave.warp, weave.weft)]
    return (_System(weave.warp, 1, above.T, across, along, slopes[0] * along / 4),
            _System(weave.weft, 0, ~above, along, across, slopes[1] * across / 4))


def _round(weave: Weave, repeats: tuple[int, int], slim: float) -> tuple[_System, _System]:
    """With heights at which round yarns touch, `slim` times as thick as the weave's."""
    warp, weft = _flat(weave, repeats)
    touching = slim * (warp.yarn.width * warp.apart + weft.yarn.width * weft.apart) / 2
    scale = touching / (warp.height + weft.height)
    return replace(warp, height=warp.height * scale), replace(weft, height=weft.height * scale)


def _overlap(warp: _System, weft: _System, slim: float) -> bool:
    """Whether a warp and a weft yarn come nearer to each other than where they cross, by the arcs over one crossing:
    longer ones keep farther away."""
    apart = slim * (warp.yarn.width * warp.apart + weft.yarn.width * weft.apart) / 2
    t = np.linspace(-1.0, 1.0, 81)
    arc = np.where(np.abs(t) <= 0.5, 1 - 4 * t * t, 4 * (np.abs(t) - 1)**2 - 1)  # over one crossing, under the next
    height = warp.height * arc[None] + weft.height * arc[:, None]
    square = (t * warp.apart)[:, None]**2 + (t * weft.apart)[None]**2 + height**2
    return bool(square.min() < (apart * (1 - 1e-6))**2)


def _runs(above: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """For each crossing the number of those before and after it on the same side, as far as the nearest on the other
    one. The draft repeats."""
    found = []
    for step in (1, -1):
        count, same = np.zeros(above.shape, np.int64), np.ones(above.shape, bool)
        for k in range(1, above.shape[1]):
            same &= np.roll(above, step * k, axis=1) == above
            count += same
        found.append(count)
    return found[0], found[1]


def _points(system: _System) -> tuple[np.ndarray, np.ndarray]:
    """The yarn of each point, and its place along it."""
    steps = _STEPS * system.above.shape[1] + 1
    yarn = np.repeat(np.arange(len(system.above)), steps)
    return yarn, np.tile(np.linspace(-0.5, 0.5, steps) * system.length, len(system.above))


def _strands(system: _System, yarn: np.ndarray, along: np.ndarray, height: np.ndarray, slim: float) -> Curves:
    points = np.empty((len(yarn), 3))
    points[:, 1 - system.axis], points[:, system.axis], points[:, 2] = system.offsets[yarn], along, height
    offsets = np.searchsorted(yarn, np.arange(len(system.above) + 1))
    return Curves("weave", points, np.full(len(yarn), slim * system.yarn.width * system.apart / 2), offsets,
                  np.zeros(len(system.above), bool), "catmull-rom", np.tile(system.yarn.color, (len(yarn), 1)))


def _pressed(system: _System, thickness: float, kind: YarnKind) -> Curves:
    """Fibres of straight round yarns, moved to where they are in lenses of half so much `thickness` that follow the
    yarns. What leaves the yarn leaves it as far."""
    count = len(system.above)
    axes, places = _points(system)
    made = yarn_fibres(_strands(system, axes, places, np.zeros(len(places)), 1.0), kind)
    points = made.points.astype(np.float64)
    along, across = points[:, system.axis], points[:, 1 - system.axis]
    strand = np.repeat(np.arange(made.strand_count), made.lengths)
    # The yarn of a strand is that whose axis one of its points is nearest to.
    near = np.clip(np.round(across / system.apart + (count - 1) / 2).astype(np.int64), 0, count - 1)
    distance = np.abs(across - system.offsets[near])
    nearest = distance == np.minimum.reduceat(distance, made.offsets[:-1])[strand]
    of_strand = np.empty(made.strand_count, np.int64)
    of_strand[strand[nearest]] = near[nearest]
    yarn = of_strand[strand]
    half = system.yarn.width * system.apart / 2
    u, v = (across - system.offsets[yarn]) / half, points[:, 2] / half
    size = np.maximum(np.hypot(u, v), 1.0)
    inside = thickness * (v / size) * np.sqrt(np.maximum(1 - (u / size)**2, 0.0))
    points[:, 2] = system.lifted(yarn, along) + inside + half * v * (1 - 1 / size)
    return replace(made, points=points)
