"""Bounding volume hierarchies whose nodes have up to four children, as the shader traverses them.

A binary tree is cut where the surface-area heuristic finds a leaf of several primitives cheaper (J. Goldsmith, J.
Salmon: Automatic Creation of Object Hierarchies for Ray Tracing, 1987). Then every other level is removed: a node takes
its largest grandchildren for its children (I. Wald, C. Benthin, S. Boulos: Getting Rid of Packets, 2008). Each step
handles a whole level of the tree at once.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from .ploc import BinaryTree, cluster, half_area

LEAF, LEAF_SHIFT = 1 << 31, 28
"""A reference to a leaf: LEAF | (count - 1) << LEAF_SHIFT | first primitive. Others are the numbers of nodes."""

MAX_LEAF = 4

NOTHING = 0xFFFFFFFF
"""The reference of a missing child, or of an empty tree."""

NOWHERE = 1e30
"""The place of the boxes of missing children, which no ray reaches."""

_NODE_COST = 1.0
"""The cost of one node of the binary tree, relative to the test of one primitive."""

_MAX_GROWTH = 1.5
"""Of the cost of a tree whose triangles move. Above it, building a tree pays for many rays."""

_MAX_STACK = 96
"""Larger than the stack for a balanced binary tree of 2^26 leaves, whose depth is 26."""


@dataclass
class Bvh4:
    """Boxes and references of each node's children: `lower` and `upper` (nodes, 3, 4) float32, `children` (nodes, 4)
    uint32.

    `order` (N,) is the order of the primitives in the leaves. `root` is the reference of the root, `stack` the stack
    size that a traversal needs. `cost` is the sum of the areas of all boxes, over that of the root, when the tree was
    built: about the boxes that a ray tests.
    """

    lower: NDArray[np.float32]
    upper: NDArray[np.float32]
    children: NDArray[np.uint32]
    order: NDArray[np.intp]
    root: int
    stack: int
    cost: float = 0.0


def build(lower: NDArray[np.float32], upper: NDArray[np.float32], max_leaf: int = MAX_LEAF) -> Bvh4:
    """The tree over boxes, `lower` and `upper` (N, 3), with leaves of at most `max_leaf` (1 to 7) primitives."""
    if not len(lower):
        empty = np.empty((0, 3, 4), np.float32)
        return Bvh4(empty, empty, np.empty((0, 4), np.uint32), np.empty(0, np.intp), NOTHING, 0)
    tree = _collapse(cluster(lower, upper), max_leaf)
    if tree.stack > _MAX_STACK:  # deeply nested boxes: take the balanced tree along the curve
        tree = _collapse(cluster(lower, upper, max_rounds=0), max_leaf)
    tree.cost = _cost(tree)
    return tree


def refit(tree: Bvh4, lower: NDArray[np.float32], upper: NDArray[np.float32]) -> Bvh4 | None:
    """The tree with the boxes of primitives that have moved; None if it should rather be built.

    That is so if its cost has grown by `_MAX_GROWTH`, or if the number of primitives is another.
    """
    if len(tree.order) != len(lower) or not len(tree.children):
        return None
    boxes_low, boxes_high = (np.full((len(tree.children), 4, 3), NOWHERE, np.float32) for _ in range(2))
    present = tree.children != NOTHING
    leaf = present & (tree.children & LEAF != 0)
    first = (tree.children[leaf] & ((1 << LEAF_SHIFT) - 1)).astype(np.intp)
    count = (tree.children[leaf] >> LEAF_SHIFT & 7) + 1
    for boxes, ends, nearest in ((boxes_low, lower, np.minimum), (boxes_high, upper, np.maximum)):
        ends = ends[tree.order]
        found = ends[first]
        for k in range(1, int(count.max(initial=1))):
            has = count > k
            found[has] = nearest(found[has], ends[first[has] + k])
        boxes[leaf] = found
    inner = present & ~leaf
    for nodes in reversed(_levels(tree.children, inner)):  # a node's children are in the level below
        rows, columns = np.nonzero(inner[nodes])
        rows += nodes.start
        below = tree.children[rows, columns].astype(np.intp)
        here = present[below][..., None]
        boxes_low[rows, columns] = boxes_low[below].min(axis=1, where=here, initial=np.inf)
        boxes_high[rows, columns] = boxes_high[below].max(axis=1, where=here, initial=-np.inf)
    moved = replace(tree, lower=np.ascontiguousarray(boxes_low.transpose(0, 2, 1)),
                    upper=np.ascontiguousarray(boxes_high.transpose(0, 2, 1)))
    return moved if _cost(moved) <= _MAX_GROWTH * tree.cost else None


def _levels(children: NDArray[np.uint32], inner: NDArray[np.bool_]) -> list[slice]:
    """The nodes of each level, which have numbers in a row."""
    levels, first, end = [], 0, 1
    while first < end:
        levels.append(slice(first, end))
        below = children[first:end][inner[first:end]]
        first, end = end, max(end, int(below.max(initial=0)) + 1)
    return levels


def _cost(tree: Bvh4) -> float:
    if not len(tree.children):
        return 0.0
    present = (tree.children != NOTHING)[:, None]
    sizes = np.where(present, tree.upper - tree.lower, 0).astype(np.float64)
    root = tree.upper[0].max(axis=1, where=present[0], initial=-np.inf) - tree.lower[0].min(
        axis=1, where=present[0], initial=np.inf)
    x, y, z = sizes.swapaxes(0, 1)
    a, b, c = root.tolist()
    return float((x * y + y * z + z * x).sum() / max(a * b + b * c + c * a, 1e-300))


def _collapse(tree: BinaryTree, max_leaf: int) -> Bvh4:
    count, area = tree.count, half_area(tree.lower, tree.upper)
    size, is_leaf = _cut(tree, area, max_leaf)
    first = _places(tree, size)
    order = np.empty(count, np.intp)
    order[first[:count]] = tree.leaves

    def references(nodes: NDArray[np.int32], numbers: NDArray[np.integer]) -> NDArray[np.uint32]:
        leaves = LEAF | (size[nodes] - 1) << LEAF_SHIFT | first[nodes]
        return np.where(is_leaf[nodes], leaves, numbers).astype(np.uint32)

    root = np.array([2 * count - 2], np.int32)
    if is_leaf[root[0]]:
        empty = np.empty((0, 3, 4), np.float32)
        return Bvh4(empty, empty, np.empty((0, 4), np.uint32), order, int(references(root, root)[0]), 1)
    boxes_low, boxes_high, links = [], [], []
    frontier, pending, made, stack = root, np.ones(1, np.int64), 1, 1
    while len(frontier):
        children = _open(tree, area, is_leaf, frontier)
        present = children >= 0
        inner = present & ~is_leaf[children]
        numbers = made + np.cumsum(inner).reshape(inner.shape) - 1
        links.append(np.where(present, references(children, numbers), NOTHING).astype(np.uint32))
        boxes_low.append(np.where(present, tree.lower[:, children], NOWHERE).transpose(1, 0, 2))
        boxes_high.append(np.where(present, tree.upper[:, children], NOWHERE).transpose(1, 0, 2))
        pending = pending + present.sum(axis=1) - 1  # the node is popped, its children are pushed
        stack = max(stack, int(pending.max()))
        made += int(inner.sum())
        frontier, pending = children[inner], np.repeat(pending, inner.sum(axis=1))
    return Bvh4(np.concatenate(boxes_low), np.concatenate(boxes_high), np.concatenate(links), order, 0, stack)


def _cut(tree: BinaryTree, area: NDArray[np.float32], max_leaf: int) -> tuple[NDArray[np.int64], NDArray[np.bool_]]:
    """For each node, the number of primitives below it and whether it becomes a leaf."""
    count = tree.count
    size = np.ones(2 * count - 1, np.int64)
    cost = area.copy()
    is_leaf = np.ones(2 * count - 1, bool)
    for made in tree.rounds:
        nodes = slice(made.start + count, made.stop + count)
        left, right = tree.children[made].T
        size[nodes] = size[left] + size[right]
        together = size[nodes] * area[nodes]
        apart = cost[left] + cost[right] + _NODE_COST * area[nodes]
        is_leaf[nodes] = (size[nodes] <= max_leaf) & (together <= apart)
        cost[nodes] = np.where(is_leaf[nodes], together, apart)
    return size, is_leaf


def _places(tree: BinaryTree, size: NDArray[np.int64]) -> NDArray[np.int64]:
    """For each node, the place of its first primitive, if the primitives of each node are contiguous."""
    first = np.zeros(2 * tree.count - 1, np.int64)
    for made in reversed(tree.rounds):
        left, right = tree.children[made].T
        parents = first[made.start + tree.count : made.stop + tree.count]
        first[left], first[right] = parents, parents + size[left]
    return first


def _open(
    tree: BinaryTree, area: NDArray[np.float32], is_leaf: NDArray[np.bool_], nodes: NDArray[np.int32]
) -> NDArray[np.int32]:
    """The children (nodes, 4) of each node, -1 for none. Twice, the largest child that is not a leaf is replaced by its
    own children."""
    children = np.full((len(nodes), 4), -1, np.int32)
    children[:, :2] = tree.children[nodes - tree.count]
    for new in (2, 3):
        sizes = np.where((children >= 0) & ~is_leaf[children], area[children], -1.0)
        largest = sizes.argmax(axis=1)
        (rows,) = np.nonzero(sizes[np.arange(len(nodes)), largest] >= 0)
        opened = children[rows, largest[rows]]
        children[rows, largest[rows]], children[rows, new] = tree.children[opened - tree.count].T
    return children
