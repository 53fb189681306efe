"""The node hierarchy in its static pose. It is traversed without recursion, so files may nest nodes to any depth."""

from __future__ import annotations

import numpy as np

from .element import Element

MAX_ROW_ERROR = 1e-3
"""Of the last row of a matrix: products of float32 matrices are off by this much; a projection is by far more."""


class Nodes:
    """The nodes are `items`. `world` (N, 4, 4) float64 takes each node's space to world space."""

    def __init__(self, root: Element) -> None:
        self.items = root.array("nodes")
        self._children = [node.indices("children", len(self.items)) for node in self.items]
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

    def _world_matrices(self) -> np.ndarray:
        world = np.empty((len(self.items), 4, 4))
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
        for node in order:
            local = local_matrix(self.items[node])
            world[node] = local if parent[node] < 0 else world[parent[node]] @ local
        broken = np.flatnonzero(~np.isfinite(world).all(axis=(1, 2)))
        if len(broken):
            raise self.items[broken[0]].error("the transformation overflows")
        return world


def local_matrix(node: Element) -> np.ndarray:
    """A node's local transform, (4, 4) float64 for column vectors."""
    if "matrix" in node:
        matrix = np.array(node.vector("matrix", 16)).reshape(4, 4).T
        error = np.abs(matrix[3] - (0, 0, 0, 1)).max()
        if error > MAX_ROW_ERROR:
            raise node.error("the last row must be 0 0 0 1", "matrix")
        if error > 1e-6:
            node.warn(f"the last row is off by {error:.2g}; 0 0 0 1 is used", "matrix")
        matrix[3] = 0, 0, 0, 1
        return matrix
    matrix = np.eye(4)
    if "rotation" in node:
        matrix[:3, :3] = _rotation(node)
    if "scale" in node:
        matrix[:3, :3] *= node.vector("scale", 3)
    if "translation" in node:
        matrix[:3, 3] = node.vector("translation", 3)
    return matrix


def _rotation(node: Element) -> np.ndarray:
    quaternion = np.array(node.vector("rotation", 4))
    peak = np.abs(quaternion).max()
    if peak == 0:
        node.warn("the quaternion is zero; no rotation is used", "rotation")
        return np.eye(3)
    quaternion /= peak  # so that squares neither overflow nor underflow
    x, y, z, w = quaternion / np.linalg.norm(quaternion)
    return np.array([[1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
                     [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
                     [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)]])
