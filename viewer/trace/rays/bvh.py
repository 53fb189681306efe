"""The bounding volume hierarchy of a scene as one texture, which shaders/trace/bvh.glsl traverses.

The triangles of meshes that are placed once are in one tree in tracer space. A mesh that is placed several times has a
tree of its own in its own space, and a tree over the instances refers to it. Two kinds of instances are copied to
tracer space instead: those that are smaller than a reference, and those whose matrix cannot be inverted well in
float32. Curves have a tree of their own in tracer space (curve_boxes.py), beside that of the triangles.

Texels (RGBA32UI):
    node      7: lower x, upper x, lower y, upper y, lower z, upper z of its four children, and their references
    triangle  3: a corner each, and in w the number in its mesh, x of a hit (kind and instance), flags
    instance  4: rows of tracer-to-mesh, then the reference to its tree, x of a hit, flags, 0
    curve     1: the row of a segment's first point, x of a hit, 0, 0
    point     1: x, y, z and radius, the rows of `TraceCurves.points`
"""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from ..layout import INSTANCE_MASK, KIND_SHIFT
from . import bvh4
from .bvh4 import LEAF, LEAF_SHIFT, NOTHING, NOWHERE, Bvh4
from .curve_boxes import curve_boxes
from .flatten import flatten

if TYPE_CHECKING:
    from ..scene.curves import TraceCurves
    from ..scene.geometry import TraceGeometry, TraceInstance

NODE_TEXELS, TRIANGLE_TEXELS, INSTANCE_TEXELS = 7, 3, 4

INSTANCE = LEAF | 7 << LEAF_SHIFT
"""A reference to an instance. It cannot be that of a leaf, since no leaf has eight triangles."""

CURVES_LEAF = LEAF | 4 << LEAF_SHIFT
"""CURVES_LEAF | (count - 1) << LEAF_SHIFT | first is a leaf of curves: no leaf has more than four triangles."""
_MAX_CURVES = 3

_SMALL_MESH = 4  # triangles, which need no more memory than an instance with its box
_MAX_STRETCH = 1e4


@dataclass
class Bvh:
    """`texels`, (n, 4) uint32, has the nodes, then the triangles from texel `triangles` on, then the instances from
    `instances` on, and the curves and their points likewise.

    `root` is the reference of the root, `stack` the stack size that a traversal needs. `trees` has the trees by what
    they are over: COPIED, the number of a mesh, INSTANCES, or CURVES.
    """

    texels: NDArray[np.uint32]
    triangles: int
    instances: int
    curves: int
    points: int
    root: int
    stack: int
    has_instances: bool
    has_see_through: bool
    has_curves: bool
    trees: dict[int, Bvh4]


IS_SEE_THROUGH, HAS_OPEN_BACK, IS_MIRRORED, IS_PANE = 1, 2, 4, 8
"""Flags of triangles and instances, as shaders/trace/bvh_tests.glsl reads them."""

COPIED, INSTANCES, CURVES = -1, -2, -3


def build_bvh(geometry: TraceGeometry, before: Bvh | None = None) -> Bvh:
    """Build the trees over all instances, or refit those that `before` has, of the same triangles elsewhere."""
    uses = Counter(instance.mesh for instance in geometry.instances)
    matrices = np.array([instance.transform[:, :3] for instance in geometry.instances]).reshape(-1, 3, 3)
    is_stretched = np.linalg.cond(matrices) > _MAX_STRETCH
    placed: dict[int, list[tuple[int, TraceInstance]]] = {}
    copied = []
    for index, instance in enumerate(geometry.instances):
        small = len(geometry.meshes[instance.mesh].triangles) <= _SMALL_MESH
        if small or uses[instance.mesh] == 1 or is_stretched[index]:
            copied.append((index, instance))
        else:
            placed.setdefault(instance.mesh, []).append((index, instance))
    forest = _Forest({} if before is None else before.trees)
    vertices, triangles, hits = flatten(geometry, copied)
    # In the space of a mesh, fronts are those of its triangles; a copy of a mirrored one has them on the other side.
    flags = np.array([_flags(instance) | IS_MIRRORED * instance.is_mirrored for instance in geometry.instances],
                     np.uint32)
    root = forest.add(COPIED, vertices, triangles, hits[:-1], flags)
    if placed:
        root = forest.place(geometry, placed, vertices, root)
    if geometry.curves is not None:
        root = forest.add_curves(geometry.curves, root)
    return forest.packed(root, bool((flags & IS_SEE_THROUGH).any()))


class _Forest:
    """Collects the trees. Those that are `known` are refitted."""

    def __init__(self, known: dict[int, Bvh4]) -> None:
        self._known = known
        self._trees: dict[int, Bvh4] = {}
        self._nodes: list[NDArray[np.uint32]] = []
        self._triangles: list[NDArray[np.uint32]] = []
        self._instances = np.empty((0, INSTANCE_TEXELS, 4), np.uint32)
        self._curves = self._points = np.empty((0, 4), np.uint32)
        self._node_count = self._triangle_count = 0
        self._stack = 1

    def add(
        self,
        key: int,
        vertices: NDArray[np.float32],
        triangles: NDArray[np.integer],
        hits: NDArray[np.uint32] | None = None,
        flags: NDArray[np.uint32] | None = None,
    ) -> int:
        """Add a tree over triangles (T, 3); returns the reference to it. `hits` (T, 2) are x and y of their hits."""
        corners = vertices[triangles]
        tree = self._tree(key, corners.min(axis=1), corners.max(axis=1))
        texels = np.zeros((len(triangles), TRIANGLE_TEXELS, 4), np.uint32)
        texels[..., :3] = corners[tree.order].view(np.uint32)
        texels[:, 0, 3] = tree.order
        if hits is not None and flags is not None:
            texels[:, 0, 3], texels[:, 1, 3] = hits[tree.order, 1], hits[tree.order, 0]
            texels[:, 2, 3] = flags[texels[:, 1, 3] & INSTANCE_MASK]
        inner = (tree.children & LEAF) == 0
        leaf = ~inner & (tree.children != NOTHING)
        tree.children[inner] += np.uint32(self._node_count)
        tree.children[leaf] += np.uint32(self._triangle_count)
        self._push(tree)
        root = tree.root
        if root != NOTHING:
            root += self._triangle_count if root & LEAF else self._node_count - len(tree.children)
        self._triangles.append(texels)
        self._triangle_count += len(texels)
        self._stack = max(self._stack, tree.stack)
        return root

    def _tree(self, key: int, lower: NDArray[np.float32], upper: NDArray[np.float32],
              max_leaf: int = bvh4.MAX_LEAF) -> Bvh4:
        """A tree over boxes, whose references the caller may change."""
        known = self._known.get(key)
        tree = bvh4.refit(known, lower, upper) if known is not None else None
        self._trees[key] = tree = tree or bvh4.build(lower, upper, max_leaf)
        return replace(tree, children=tree.children.copy())

    def place(
        self,
        geometry: TraceGeometry,
        placed: dict[int, list[tuple[int, TraceInstance]]],
        copied: NDArray[np.float32],
        copied_root: int,
    ) -> int:
        """Add a tree over instances (by mesh) and over the tree of copied triangles; returns the reference to it."""
        lower, upper, records = [], [], []
        for mesh_index, instances in placed.items():
            mesh = geometry.meshes[mesh_index]
            root = self.add(mesh_index, mesh.positions, mesh.triangles)
            transforms = np.array([instance.transform for _, instance in instances])
            low, high = _moved_box(transforms, mesh.positions.min(axis=0), mesh.positions.max(axis=0))
            lower.append(low)
            upper.append(high)
            record = np.zeros((len(instances), INSTANCE_TEXELS, 4), np.uint32)
            record[:, :3] = _inverse(transforms).astype(np.float32).view(np.uint32)
            record[:, 3, 0] = root
            record[:, 3, 1] = [instance.kind.number << KIND_SHIFT | index for index, instance in instances]
            record[:, 3, 2] = [_flags(instance) for _, instance in instances]
            records.append(record)
        self._instances = np.concatenate(records)
        references = INSTANCE | np.arange(len(self._instances), dtype=np.int64)
        if copied_root != NOTHING:
            lower.append(copied.min(axis=0)[None])
            upper.append(copied.max(axis=0)[None])
            references = np.append(references, copied_root)
        tree = self._tree(INSTANCES, np.concatenate(lower), np.concatenate(upper), max_leaf=1)
        references = references[tree.order]
        if tree.root & LEAF:
            return int(references[0])
        leaf = (tree.children & LEAF != 0) & (tree.children != NOTHING)
        tree.children[tree.children & LEAF == 0] += np.uint32(self._node_count)
        tree.children[leaf] = references[tree.children[leaf] & ((1 << LEAF_SHIFT) - 1)]
        self._push(tree)
        self._stack += tree.stack
        return self._node_count - len(tree.children)

    def add_curves(self, curves: TraceCurves, triangles_root: int) -> int:
        """Add a tree over curves, and a node over it and the one over triangles; returns the reference to that."""
        lower, upper, segment = curve_boxes(curves)
        tree = self._tree(CURVES, lower, upper, _MAX_CURVES)
        segment = segment[tree.order]
        self._curves = np.zeros((len(segment), 4), np.uint32)
        self._curves[:, 0], self._curves[:, 1] = curves.first[segment], curves.codes[segment]
        self._points = curves.points.view(np.uint32)
        leaf = (tree.children & LEAF != 0) & (tree.children != NOTHING)
        tree.children[tree.children & LEAF == 0] += np.uint32(self._node_count)
        tree.children[leaf] |= np.uint32(CURVES_LEAF)
        root = tree.root | CURVES_LEAF if tree.root & LEAF else self._node_count
        self._push(tree)
        self._stack = max(self._stack, tree.stack)
        if triangles_root == NOTHING:
            return root
        above = Bvh4(np.full((1, 3, 4), NOWHERE, np.float32), np.full((1, 3, 4), NOWHERE, np.float32),
                     np.array([[root, triangles_root, NOTHING, NOTHING]], np.uint32), tree.order, 0, 0)
        above.lower[0, :, 0], above.upper[0, :, 0] = lower.min(axis=0), upper.max(axis=0)
        above.lower[0, :, 1], above.upper[0, :, 1] = -_EVERYWHERE, _EVERYWHERE
        self._push(above)
        self._stack += 1
        return self._node_count - 1

    def _push(self, tree: Bvh4) -> None:
        texels = np.empty((len(tree.children), NODE_TEXELS, 4), np.uint32)
        texels[:, 0:6:2] = tree.lower.view(np.uint32)
        texels[:, 1:6:2] = tree.upper.view(np.uint32)
        texels[:, 6] = tree.children
        self._nodes.append(texels)
        self._node_count += len(texels)

    def packed(self, root: int, has_see_through: bool) -> Bvh:
        parts = [part.reshape(-1, 4)
                 for part in (*self._nodes, *self._triangles, self._instances, self._curves, self._points)]
        triangles = self._node_count * NODE_TEXELS
        instances = triangles + self._triangle_count * TRIANGLE_TEXELS
        curves = instances + len(self._instances) * INSTANCE_TEXELS
        return Bvh(np.concatenate(parts), triangles, instances, curves, curves + len(self._curves), root, self._stack,
                   len(self._instances) > 0, has_see_through, len(self._curves) > 0, self._trees)


def _flags(instance: TraceInstance) -> int:
    return (IS_SEE_THROUGH * instance.see_through | HAS_OPEN_BACK * instance.has_open_back
            | IS_PANE * instance.is_pane)


def _moved_box(
    transforms: NDArray[np.float64], low: NDArray[np.float32], high: NDArray[np.float32]
) -> tuple[NDArray[np.float32], NDArray[np.float32]]:
    """Boxes (n, 3) that hold a box transformed by each of the matrices (n, 3, 4), with `_SLACK` for float32."""
    matrices = transforms[:, :, :3]
    middle = matrices @ (0.5 * (low + high.astype(np.float64))) + transforms[:, :, 3]
    half = np.abs(matrices) @ (0.5 * (high.astype(np.float64) - low)) + _SLACK
    return (middle - half).astype(np.float32), (middle + half).astype(np.float32)


_EVERYWHERE = 1.01
"""All geometry is within 1 of the origin, but for rounding."""

_SLACK = 1e-6
"""Rays are transformed to instances in float32. This is a few units in the last place of the scene's radius."""


def _inverse(transforms: NDArray[np.float64]) -> NDArray[np.float64]:
    """Inverses of affine matrices, (n, 3, 4) of (n, 3, 4)."""
    matrices = np.linalg.inv(transforms[:, :, :3])
    return np.concatenate([matrices, -matrices @ transforms[:, :, 3:]], axis=2)
