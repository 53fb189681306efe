"""The node hierarchy at rest. It is traversed without recursion, so files may nest nodes to any depth."""

from __future__ import annotations

import numpy as np

from .. import rig
from ..animation import unit_quaternions
from .element import Element

MAX_ROW_ERROR = 1e-3
"""Of the last row of a matrix: products of float32 matrices are off by this much; a projection is by far more."""


VISIBILITY = "KHR_node_visibility"


class Nodes:
    """The nodes are `items`. `world` (N, 4, 4) float64 takes each node's space to world space, at rest."""

    def __init__(self, root: Element) -> None:
        self.items = root.array("nodes")
        self._children = [node.indices("children", len(self.items)) for node in self.items]
        self.hierarchy = self._hierarchy()
        self.world = self._world_matrices()

    def reachable(self, roots: list[int], place: Element) -> list[int]:
        """The nodes under `roots`, parents first. Raises InputError if a node is reached twice."""
        seen: dict[int, None] = {}
        stack = roots[::-1]
        while stack:
            node = stack.pop()
            if node in seen:
                raise place.error(f"nodes[{node}] is reached twice", "nodes")
            seen[node] = None
            stack.extend(reversed(self._children[node]))
        return list(seen)

    def roots(self) -> list[int]:
        """The nodes without a parent."""
        children = {child for node in self._children for child in node}
        return [node for node in range(len(self.items)) if node not in children]

    def _order(self) -> tuple[list[int], list[int]]:
        """Each node's parent, -1 for none, and all nodes, parents first."""
        parent = [-1] * len(self.items)
        for node, children in enumerate(self._children):
            for child in children:
                if parent[child] >= 0:
                    problem = f"nodes[{child}] is a child of nodes[{parent[child]}] already"
                    raise self.items[node].error(problem, "children")
                parent[child] = node
        # Every node has at most one parent, so a node that no root reaches is on a cycle or below one.
        order = [node for node, above in enumerate(parent) if above < 0]
        for node in order:
            order.extend(self._children[node])
        if len(order) < len(self.items):
            node = next(iter(set(range(len(self.items))) - set(order)))
            raise self.items[node].error("the node is its own ancestor, or is below a node that is its own ancestor")
        return parent, order

    def _hierarchy(self) -> rig.Nodes:
        parent, order = self._order()
        count = len(self.items)
        depth = [0] * count
        for node in order:
            depth[node] = depth[parent[node]] + 1 if parent[node] >= 0 else 0
        translations, rotations, scales = np.zeros((count, 3)), np.tile([0.0, 0.0, 0.0, 1.0], (count, 1)), \
            np.ones((count, 3))
        matrices: dict[int, np.ndarray] = {}
        for k, item in enumerate(self.items):
            if "matrix" in item:
                matrices[k] = _matrix(item)
                continue
            if "translation" in item:
                translations[k] = item.vector("translation", 3)
            if "rotation" in item:
                rotations[k] = _rotation(item)
            if "scale" in item:
                scales[k] = item.vector("scale", 3)
        visible = np.array([place is None or place.boolean("visible", True)
                            for place in (item.extension(VISIBILITY) for item in self.items)], bool)
        return rig.Nodes(np.array(parent, np.intp), np.array(depth, np.intp), translations, rotations, scales, matrices,
                         visible)

    def _world_matrices(self) -> np.ndarray:
        world = self.hierarchy.world(self.hierarchy.at_rest)
        broken = np.flatnonzero(~np.isfinite(world).all(axis=(1, 2)))
        if len(broken):
            raise self.items[broken[0]].error("the transformation overflows")
        return world


def _matrix(node: Element) -> np.ndarray:
    """A node's matrix, (4, 4) float64 for column vectors."""
    matrix = np.array(node.vector("matrix", 16)).reshape(4, 4).T
    error = np.abs(matrix[3] - (0, 0, 0, 1)).max()
    if error > MAX_ROW_ERROR:
        raise node.error("the last row must be 0 0 0 1", "matrix")
    if error > 1e-6:
        node.warn(f"the last row is off by {error:.2g}; 0 0 0 1 is used", "matrix")
    matrix[3] = 0, 0, 0, 1
    return matrix


def _rotation(node: Element) -> np.ndarray:
    quaternion = np.array(node.vector("rotation", 4))
    if not quaternion.any():
        node.warn("the quaternion is zero; no rotation is used", "rotation")
    return unit_quaternions(quaternion[None])[0]
