"""Trees over boxes are complete, have a low cost and a bounded depth for any boxes."""

from __future__ import annotations

import numpy as np
import pytest
from stand_ins import Geometry, Instance, Mesh, mesh, soup, sphere

from viewer.trace.rays import bvh4 as wide
from viewer.trace.rays.bvh import INSTANCE, NODE_TEXELS, build_bvh
from viewer.trace.rays.bvh4 import LEAF, LEAF_SHIFT, NOTHING, Bvh4
from viewer.trace.rays.ploc import BinaryTree, cluster, half_area

MAX_STACK = 96


def boxes(shape: Mesh) -> tuple[np.ndarray, np.ndarray]:
    corners = shape.positions[shape.triangles]
    return corners.min(axis=1), corners.max(axis=1)


def sweep_cost(lower: np.ndarray, upper: np.ndarray) -> float:
    """The sum of the areas of inner nodes over the area of the root, for the tree of a full sweep with the surface-area
    heuristic: every node is split at the place and axis where areas times counts are least."""
    lower, upper = lower.astype(np.float64), upper.astype(np.float64)
    total, todo = 0.0, [np.arange(len(lower))]
    while todo:
        inside = todo.pop()
        low, high = lower[inside], upper[inside]
        total += half_area(low.min(axis=0), high.max(axis=0))
        counts = np.arange(1, len(inside))
        splits = []
        for axis in range(3):
            order = np.argsort(low[:, axis] + high[:, axis], kind="stable")
            low_sorted, high_sorted = low[order], high[order]
            left = half_area(np.minimum.accumulate(low_sorted).T, np.maximum.accumulate(high_sorted).T)
            right = half_area(np.minimum.accumulate(low_sorted[::-1]).T, np.maximum.accumulate(high_sorted[::-1]).T)
            cost = left[:-1] * counts + right[::-1][1:] * counts[::-1]
            best = int(cost.argmin())
            splits.append((cost[best], axis, inside[order[: best + 1]], inside[order[best + 1 :]]))
        todo += [half for half in min(splits, key=lambda split: split[:2])[2:] if len(half) > 1]
    return total / half_area(lower.min(axis=0), upper.max(axis=0))


def check_binary(tree: BinaryTree, lower: np.ndarray, upper: np.ndarray) -> None:
    count = len(lower)
    assert sorted(tree.leaves) == list(range(count))
    assert sorted(tree.children.ravel()) == list(range(2 * count - 2))  # all but the root are one node's child
    for node, (left, right) in enumerate(tree.children, start=count):
        assert max(left, right) < node
    np.testing.assert_array_equal(tree.lower[:, :count], lower[tree.leaves].T)
    for bound, best in ((tree.lower, np.minimum), (tree.upper, np.maximum)):
        left, right = tree.children.T
        np.testing.assert_array_equal(bound[:, count:], best(bound[:, left], bound[:, right]))


def check_wide(tree: Bvh4, lower: np.ndarray, upper: np.ndarray, max_leaf: int = wide.MAX_LEAF) -> None:
    """Every primitive is in one leaf, inside all its boxes. No traversal needs a larger stack than the tree says."""
    seen: list[int] = []
    todo = [(tree.root, np.full(3, -np.inf), np.full(3, np.inf), 1)]
    while todo:
        reference, low, high, waiting = todo.pop()
        assert waiting <= tree.stack <= MAX_STACK
        if reference & LEAF:
            first, count = reference & (1 << LEAF_SHIFT) - 1, (reference >> LEAF_SHIFT & 7) + 1
            assert count <= max_leaf
            inside = tree.order[first : first + count]
            seen += inside.tolist()
            assert (lower[inside] >= low).all() and (upper[inside] <= high).all()
            continue
        children = [k for k in range(4) if tree.children[reference, k] != NOTHING]
        for k in range(4):
            box = tree.lower[reference, :, k], tree.upper[reference, :, k]
            if k in children:
                assert (box[0] >= low).all() and (box[1] <= high).all()
                todo.append((int(tree.children[reference, k]), *box, waiting + len(children) - 1))
            else:
                assert min(box[0]) > 1e20
    assert sorted(seen) == list(range(len(lower)))


@pytest.mark.parametrize("shape", [sphere(40, 50), soup(2000, 0.03), soup(2000, 0.5)], ids=["sphere", "small", "big"])
def test_a_tree_costs_about_what_the_full_sweep_costs(shape: Mesh) -> None:
    lower, upper = boxes(shape)
    tree = cluster(lower, upper)
    check_binary(tree, lower, upper)
    area = half_area(tree.lower.astype(np.float64), tree.upper.astype(np.float64))
    assert area[len(lower) :].sum() / area[-1] < 1.12 * sweep_cost(lower, upper)
    check_wide(wide.build(lower, upper), lower, upper)
    check_wide(wide.build(lower, upper, max_leaf=1), lower, upper, max_leaf=1)


def nested(count: int, ratio: float) -> tuple[np.ndarray, np.ndarray]:
    """Nested boxes that share a corner."""
    upper = (ratio ** -np.arange(count))[:, None] * np.ones(3)
    return np.zeros((count, 3), np.float32), upper.astype(np.float32)


DEGENERATE = {
    "one": (np.zeros((1, 3), np.float32), np.ones((1, 3), np.float32)),
    "two": (np.float32([[0, 0, 0], [1, 0, 0]]), np.float32([[1, 1, 1], [1, 0, 0]])),
    "the same a thousand times": (np.zeros((1000, 3), np.float32), np.ones((1000, 3), np.float32)),
    "points in one place": (np.full((777, 3), 0.3, np.float32),) * 2,
    "points on a line": (np.linspace(-1, 1, 999, dtype=np.float32)[:, None] * np.float32([1, 0, 0]),) * 2,
    "centred on one place": (-np.geomspace(1e-6, 1, 800, dtype=np.float32)[:, None].repeat(3, 1),
                             np.geomspace(1e-6, 1, 800, dtype=np.float32)[:, None].repeat(3, 1)),
    "nested": nested(1000, 1.01),
    "nested steeply": nested(120, 2.0),
    "needles": (np.float32([-1, 0, 0]) + np.float32([[0, 1e-7, 1e-4]]) * np.arange(500, dtype=np.float32)[:, None],
                np.float32([1, 0, 0]) + np.float32([[0, 1e-7, 1e-4]]) * np.arange(500, dtype=np.float32)[:, None]),
    "tiny beside huge": (np.float32([[-1, -1, -1]] + [[x * 1e-30] * 3 for x in range(300)]),
                         np.float32([[1, 1, 1]] + [[x * 1e-30] * 3 for x in range(300)])),
}


@pytest.mark.parametrize("name", DEGENERATE)
def test_degenerate_boxes_make_a_tree_all_the_same(name: str) -> None:
    lower, upper = DEGENERATE[name]
    for tree in (cluster(lower, upper), cluster(lower, upper, max_rounds=0)):
        check_binary(tree, lower, upper)
        assert len(tree.rounds) <= 48 + np.log2(len(lower)) + 1
    check_wide(wide.build(lower, upper), lower, upper)


@pytest.mark.parametrize("max_leaf", [1, 4])
@pytest.mark.parametrize("shape", [sphere(20, 25), soup(700, 0.1), soup(6, 0.5)], ids=["sphere", "soup", "six"])
def test_a_refitted_tree_holds_what_has_moved(shape: Mesh, max_leaf: int) -> None:
    tree = wide.build(*boxes(shape), max_leaf)
    same = wide.refit(tree, *boxes(shape))
    for name in ("lower", "upper"):
        np.testing.assert_array_equal(getattr(same, name), getattr(tree, name))
    x, y, z = shape.positions.T
    bent = mesh(np.stack([x + 0.3 * np.sin(2 * y), 1.3 * y, z - 0.2 * x], axis=1), shape.triangles)
    moved = wide.refit(tree, *boxes(bent))
    check_wide(moved, *boxes(bent), max_leaf)
    assert moved.cost == tree.cost and (moved.lower != tree.lower).any()


def test_a_tree_that_would_cost_too_much_is_not_refitted() -> None:
    lower, upper = boxes(soup(700, 0.05))
    tree = wide.build(lower, upper)
    shuffled = np.random.default_rng(1).permutation(len(lower))
    assert wide.refit(tree, lower[shuffled], upper[shuffled]) is None
    assert wide.refit(tree, lower[:-1], upper[:-1]) is None


def test_no_boxes_make_no_tree() -> None:
    nothing = np.empty((0, 3), np.float32)
    assert wide.build(nothing, nothing).root == NOTHING
    assert build_bvh(Geometry([])).root == NOTHING


def test_a_tree_that_would_be_too_deep_is_balanced(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(wide, "_MAX_STACK", 20)
    lower, upper = nested(120, 2.0)
    tree = wide.build(lower, upper)
    assert tree.stack <= 1 + 3 * np.ceil(np.log2(120))
    check_wide(tree, lower, upper)


def test_a_mesh_placed_often_is_kept_once() -> None:
    shape, count = sphere(10, 10), 50
    once = build_bvh(Geometry([shape]))
    transforms = [np.c_[0.1 * np.eye(3), (x / count, 0, 0)] for x in range(count)]
    often = build_bvh(Geometry([shape], [Instance(0, transform) for transform in transforms]))
    assert not once.has_instances and often.has_instances
    assert often.instances - often.triangles == once.instances - once.triangles
    assert len(often.texels) < len(once.texels) + count * (4 + NODE_TEXELS)


def test_what_a_matrix_flattens_is_copied() -> None:
    flat = [np.c_[np.diag([1, 1, 0]), (0, 0, z)] for z in (0.1, 0.2)]
    bvh = build_bvh(Geometry([sphere(10, 10)], [Instance(0, transform) for transform in flat]))
    assert not bvh.has_instances
    assert bvh.instances - bvh.triangles == 2 * 3 * len(sphere(10, 10).triangles)


def test_copied_triangles_lie_beside_the_instances() -> None:
    small = mesh([(0, 0, 0), (1, 0, 0), (0, 1, 0)], [(0, 1, 2)])
    placed = [Instance(0, np.c_[0.1 * np.eye(3), (x, 0, 0)]) for x in (-0.5, 0.5)]
    bvh = build_bvh(Geometry([sphere(6, 6), small], [*placed, Instance(1, np.eye(3, 4))]))
    references = bvh.texels[bvh.root * NODE_TEXELS + 6]
    assert sorted(references) == [LEAF, INSTANCE, INSTANCE | 1, NOTHING]
