"""A tree of boxes that is cheap to trace through, built from the leaves up, all clusters at once.

Parallel locally-ordered clustering: D. Meister, J. Bittner: Parallel Locally-Ordered Clustering for Bounding Volume
Hierarchy Construction, IEEE TVCG 24(3), 2018. The boxes are put along a Morton curve; time and again every cluster
looks for the one near it on the curve with which it makes the smallest box, and those that chose each other merge. Each
round is a handful of numpy operations on whole arrays. The number of rounds, and with it the depth, is bounded: where
hardly any chose each other, and after `_PATIENCE` rounds, neighbours merge two by two.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

_RADIUS = 8
"""How far along the curve clusters look. Farther is slower and not better: the costs go up and down by some 3 %."""

_BLOCK = 1 << 15
"""Clusters looked at together: few enough to stay in the cache."""

_PATIENCE = 48


@dataclass
class BinaryTree:
    """Nodes 0 to N - 1 are the leaves along the curve, the following N - 1 the inner ones, children before parents.

    `lower` and `upper` are (3, 2 N - 1) float32, `children` (N - 1, 2), `leaves` (N,) the box in each leaf. `rounds`
    are slices of inner nodes none of which is below another of the same slice.
    """

    lower: NDArray[np.float32]
    upper: NDArray[np.float32]
    children: NDArray[np.int32]
    leaves: NDArray[np.intp]
    rounds: list[slice]

    @property
    def count(self) -> int:
        return len(self.leaves)


def cluster(lower: NDArray[np.float32], upper: NDArray[np.float32], patience: int = _PATIENCE) -> BinaryTree:
    """A tree over boxes (N, 3) each, N >= 1; with `patience` 0 of depth ceil(log2 N)."""
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
        if len(tree.rounds) >= patience or 16 * np.count_nonzero(merges) < len(nodes):
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
    """Half the surface of boxes (3, ...)."""
    x, y, z = upper[0] - lower[0], upper[1] - lower[1], upper[2] - lower[2]
    return x * y + z * (x + y)


def _partners(low: NDArray[np.float32], high: NDArray[np.float32]) -> NDArray[np.int32]:
    """For each of the boxes (3, n) along the curve the one, at most `_RADIUS` away, that it would best merge with."""
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
            area[::2] *= 1 - 2.0**-20  # where all are alike, as in a grid, let the same two choose each other
        for mine, other in ((slice(None, -step), slice(step, None)), (slice(step, None), slice(None, -step))):
            better = area < best[mine]
            np.copyto(best[mine], area, where=better)
            np.copyto(partner[mine], index[other], where=better)
    return partner


def _morton(lower: NDArray[np.float32], upper: NDArray[np.float32]) -> NDArray[np.uint64]:
    """Places of the boxes' centres along a Z-order curve, 21 bits an axis."""
    centers = 0.5 * (lower.astype(np.float64) + upper)
    start = centers.min(axis=0)
    extent = (centers.max(axis=0) - start).max()
    cells = ((centers - start) * ((2**21 - 1) / extent if extent > 0 else 0.0)).astype(np.uint64)
    spread = np.zeros(len(cells), np.uint64)
    for axis in range(3):
        bits = cells[:, axis]
        # Two zeros between any two bits, by halves.
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
