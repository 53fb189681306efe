"""Builds a binary bounding volume hierarchy from the leaves up, by parallel locally-ordered clustering (PLOC).

D. Meister, J. Bittner: Parallel Locally-Ordered Clustering for Bounding Volume Hierarchy Construction, IEEE TVCG 24(3),
2018. The boxes are sorted along a Morton curve. In each round, every cluster looks for the near cluster on the curve
with which it has the smallest common box, and clusters that chose each other merge. A round is a few numpy operations
on whole arrays. The number of rounds, and so the depth, is bounded: if hardly any clusters chose each other, and after
`_MAX_ROUNDS` rounds, neighbours on the curve merge in pairs.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

_RADIUS = 8
"""How far along the curve clusters search.

A larger radius is slower and no better: costs change by about 3 % either way.
"""

_BLOCK = 1 << 15
"""Clusters that are searched at once, few enough to stay in the cache."""

_MAX_ROUNDS = 48


@dataclass
class BinaryTree:
    """Nodes 0 to N - 1 are the leaves along the curve; the following N - 1 the inner nodes, children before parents.

    `lower` and `upper` are (3, 2 N - 1) float32, `children` is (N - 1, 2), `leaves` (N,) is the number of each leaf's
    box. `rounds` are slices of inner nodes; no node is below another of the same slice.
    """

    lower: NDArray[np.float32]
    upper: NDArray[np.float32]
    children: NDArray[np.int32]
    leaves: NDArray[np.intp]
    rounds: list[slice]

    @property
    def count(self) -> int:
        return len(self.leaves)


def cluster(lower: NDArray[np.float32], upper: NDArray[np.float32], max_rounds: int = _MAX_ROUNDS) -> BinaryTree:
    """A tree over boxes, `lower` and `upper` (N, 3), N >= 1. With `max_rounds` 0 its depth is ceil(log2 N)."""
    count = len(lower)
    leaves = np.argsort(_morton(lower, upper), kind="stable")
    tree = BinaryTree(
        np.empty((3, 2 * count - 1), np.float32),
        np.empty((3, 2 * count - 1), np.float32),
        np.empty((count - 1, 2), np.int32),
        leaves,
        [],
    )
    low, high = np.ascontiguousarray(lower[leaves].T), np.ascontiguousarray(upper[leaves].T)
    tree.lower[:, :count], tree.upper[:, :count] = low, high
    nodes = np.arange(count, dtype=np.int32)
    made = count
    while len(nodes) > 1:
        index = np.arange(len(nodes), dtype=np.int32)
        partner = _partners(low, high)
        merges = (partner[partner] == index) & (index < partner)
        if len(tree.rounds) >= max_rounds or 16 * np.count_nonzero(merges) < len(nodes):
            partner, merges = index ^ 1, (index % 2 == 0) & (index + 1 < len(nodes))
        left = np.flatnonzero(merges)
        right = partner[left]
        parents = slice(made, made + len(left))
        tree.children[made - count : parents.stop - count] = np.stack([nodes[left], nodes[right]], 1)
        low[:, left] = np.minimum(low[:, left], low[:, right])
        high[:, left] = np.maximum(high[:, left], high[:, right])
        tree.lower[:, parents], tree.upper[:, parents] = low[:, left], high[:, left]
        nodes[left] = np.arange(parents.start, parents.stop, dtype=np.int32)
        stays = np.ones(len(nodes), bool)
        stays[right] = False
        nodes, low, high = nodes[stays], low[:, stays], high[:, stays]
        tree.rounds.append(slice(made - count, parents.stop - count))
        made = parents.stop
    return tree


def half_area(lower: NDArray[np.float32], upper: NDArray[np.float32]) -> NDArray[np.float32]:
    """Half the surface areas of boxes (3, ...)."""
    x, y, z = upper[0] - lower[0], upper[1] - lower[1], upper[2] - lower[2]
    return x * y + z * (x + y)


def _partners(low: NDArray[np.float32], high: NDArray[np.float32]) -> NDArray[np.int32]:
    """For each of the boxes (3, n) along the curve, the best partner for a merge at most `_RADIUS` away."""
    count = low.shape[1]
    partners = np.empty(count, np.int32)
    for start in range(0, count, _BLOCK):
        stop = min(start + _BLOCK, count)
        first, last = max(start - _RADIUS, 0), min(stop + _RADIUS, count)
        near = _nearest(low[:, first:last], high[:, first:last])
        partners[start:stop] = near[start - first : stop - first] + first
    return partners


def _nearest(low: NDArray[np.float32], high: NDArray[np.float32]) -> NDArray[np.int32]:
    count = low.shape[1]
    best = np.full(count, np.inf, np.float32)
    index = np.arange(count, dtype=np.int32)
    partner = index.copy()
    for step in range(1, min(_RADIUS, count - 1) + 1):
        area = half_area(np.minimum(low[:, :-step], low[:, step:]), np.maximum(high[:, :-step], high[:, step:]))
        if step == 1:
            area[::2] *= 1 - 2.0**-20  # a tie-break for equal boxes, as in a grid: the same two choose each other
        for mine, other in ((slice(None, -step), slice(step, None)), (slice(step, None), slice(None, -step))):
            better = area < best[mine]
            np.copyto(best[mine], area, where=better)
            np.copyto(partner[mine], index[other], where=better)
    return partner


def _morton(lower: NDArray[np.float32], upper: NDArray[np.float32]) -> NDArray[np.uint64]:
    """Morton codes of the boxes' centres, 21 bits for each axis."""
    centers = 0.5 * (lower.astype(np.float64) + upper)
    start = centers.min(axis=0)
    extent = (centers.max(axis=0) - start).max()
    cells = ((centers - start) * ((2**21 - 1) / extent if extent > 0 else 0.0)).astype(np.uint64)
    spread = np.zeros(len(cells), np.uint64)
    for axis in range(3):
        bits = cells[:, axis]
        # Put two zeros between any two bits, halving the groups of bits in each step.
        for shift, mask in _SPREAD:
            bits = (bits | bits << shift) & mask
        spread |= bits << np.uint64(axis)
    return spread


_SPREAD = [
    (np.uint64(shift), np.uint64(mask))
    for shift, mask in (
        (32, 0x001F00000000FFFF),
        (16, 0x001F0000FF0000FF),
        (8, 0x100F00F00F00F00F),
        (4, 0x10C30C30C30C30C3),
        (2, 0x1249249249249249),
    )
]
