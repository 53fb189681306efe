"""A binary tree of lights, by which shaders/trace/light_tree.glsl chooses one that matters where it is needed.

Conty Estevez and Kulla 2018, "Importance Sampling of Many Lights with Adaptive Tree Splitting", without the splitting.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..layout import LIGHT_LEAF, LIGHT_TWO_SIDED, MOST_LIGHT_LEVELS
from .light_bounds import LightBounds, bounds_texels, union


@dataclass(frozen=True, eq=False)
class LightTree:
    """The nodes below the root, in pairs of siblings: node 2 k and node 2 k + 1, and those of the root first.

    `links` (N,) uint32 says what a node is (LIGHT_LEAF of viewer/trace/layout.py). `trails` has the way to each light:
    bit k is the choice at level k.
    """

    bounds: LightBounds
    links: NDArray[np.uint32]
    trails: NDArray[np.uint32]

    def texels(self, numbers: NDArray) -> NDArray[np.uint32]:
        """The section of the scene buffer, (2 N, 4), where `numbers` are those of the lights."""
        is_leaf = self.links >= LIGHT_LEAF
        of = np.where(is_leaf, self.links & np.uint32(LIGHT_LEAF - 1), 0)
        return bounds_texels(self.bounds, np.where(is_leaf, LIGHT_LEAF | numbers[of], self.links).astype(np.uint32))


def build_light_tree(lights: LightBounds) -> LightTree:
    """The tree of at least two lights. All nodes of a level are halved at once."""
    count = len(lights)
    links, trails = np.zeros(2 * count - 2, np.uint32), np.zeros(count, np.uint32)
    is_one_sided = (lights.spread < np.pi) & (lights.flags & LIGHT_TWO_SIDED == 0)
    rows = np.vstack([lights.low.T, lights.high.T, lights.intensity, lights.axis.T * lights.intensity * is_one_sided])
    order, starts = np.arange(count), np.array([0])  # of the level's groups, one after the other
    levels: list[slice] = []
    pairs = 0
    while len(starts):
        level = len(levels)
        sizes = np.diff(starts, append=len(order))
        moved, left = _halved(rows, starts, sizes, 2**(MOST_LIGHT_LEVELS - 1 - level))
        order, rows = order[moved], rows[:, moved]
        bounds = np.stack([starts, starts + left], axis=1).ravel()
        sizes = np.diff(bounds, append=len(order))
        is_right = np.repeat(np.arange(len(sizes)) % 2, sizes)
        trails[order] |= is_right.astype(np.uint32) << np.uint32(level)
        first = 2 * pairs
        pairs += len(starts)
        is_leaf = sizes == 1
        node = links[first:first + len(sizes)]
        node[is_leaf] = LIGHT_LEAF | order[bounds[is_leaf]]
        node[~is_leaf] = pairs + np.arange(len(sizes) - is_leaf.sum())
        levels.append(slice(first, first + len(sizes)))
        is_inner = np.repeat(~is_leaf, sizes)
        order, rows = order[is_inner], rows[:, is_inner]
        starts = np.concatenate([[0], np.cumsum(sizes[~is_leaf])[:-1]]).astype(int)[:(~is_leaf).sum()]
    return LightTree(_bottom_up(lights, links, levels), links, trails)


def _bottom_up(lights: LightBounds, links: NDArray, levels: list[slice]) -> LightBounds:
    """The bounds of all nodes."""
    is_leaf = links >= LIGHT_LEAF
    found = lights[np.where(is_leaf, links & np.uint32(LIGHT_LEAF - 1), 0)]
    for level in reversed(levels):
        inner = np.flatnonzero(~is_leaf[level]) + level.start
        both = union(found[2 * links[inner].astype(int)], found[2 * links[inner].astype(int) + 1])
        for name in LightBounds.__dataclass_fields__:
            getattr(found, name)[inner] = getattr(both, name)
    return found


def _halved(rows: NDArray, starts: NDArray, sizes: NDArray, most: int) -> tuple[NDArray, NDArray]:
    """The order in which each group is sorted along the longest side of its box, and how many of it go to the left.

    That is where the cost of both parts is least, the sum of intensity times squared diagonal of the box times
    1 + 3 (1 - R). R is the length of the mean axis: 1 where all shine towards one side, 0 where they do to all, so that
    the last factor is about the paper's measure of directions, relative to that of one triangle. Groups without an
    extent, and those of more than `most` / 2 lights, which might need too many levels, are halved by number.
    """
    groups = np.arange(len(starts))
    group = np.repeat(groups, sizes)
    center = rows[:3] + rows[3:6]
    low, high = (side.reduceat(center, starts, axis=1) for side in (np.minimum, np.maximum))
    longest = (high - low).argmax(axis=0)
    extent = (high - low)[longest, groups]
    place = center[longest[group], np.arange(len(group))] - low[longest, groups][group]
    order = np.argsort(group + 0.5 * place / np.where(extent > 0, extent, 1)[group], kind="stable")
    costs = _costs(rows[:, order], starts, sizes, group)
    least = np.flatnonzero(costs == np.minimum.reduceat(costs, starts)[group])
    _, first = np.unique(group[least], return_index=True)
    left = least[first] - starts + 1
    return order, np.where((extent > 0) & (2 * sizes <= most), left, sizes // 2)


def _costs(rows: NDArray, starts: NDArray, sizes: NDArray, group: NDArray) -> NDArray:
    """The cost of a cut behind each light, infinite behind the last of a group."""
    ends = starts + sizes - 1
    low, high, weighted = rows[:3], rows[3:6], rows[6:]
    sums = weighted.cumsum(axis=1)
    left = sums - (sums[:, starts] - weighted[:, starts])[:, group]
    right = sums[:, ends][:, group] - sums
    # Running extremes of all groups in one go: values of a group lie in [group, group + 1].
    base, top = np.minimum.reduceat(low, starts, axis=1), np.maximum.reduceat(high, starts, axis=1)
    scale = 1 / np.maximum((top - base).max(axis=0), 1e-300)
    near, far = ((side - base[:, group]) * scale[group] for side in (low, high))
    # The first part's box, from its far sides and, turned round, its near ones; and the other part's, backwards
    first, last = (_running(far, group) + _running(1 - near, group) - 1, np.zeros_like(far))
    backwards = group[-1] - group[::-1]
    last[:, :-1] = (_running(far[:, ::-1], backwards) + _running(1 - near[:, ::-1], backwards) - 1)[:, -2::-1]
    costs = _cost(left, first) + _cost(right, last)
    costs[ends] = np.inf
    return costs


def _running(values: NDArray, group: NDArray) -> NDArray:
    return np.maximum.accumulate(values + group, axis=1) - group


def _cost(sums: NDArray, box: NDArray) -> NDArray:
    return (4 * sums[0] - 3 * np.sqrt(sums[1]**2 + sums[2]**2 + sums[3]**2)) * (box[0]**2 + box[1]**2 + box[2]**2)
