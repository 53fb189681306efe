"""Morph targets and skins, applied on the CPU in the static pose of the file."""

from __future__ import annotations

import numpy as np

from .accessors import Accessors
from .element import Element
from .nodes import Nodes


def morph(base: np.ndarray, deltas: list[np.ndarray], weights: list[float]) -> np.ndarray:
    """base + the sum of weight * delta over the targets (glTF 2.0, 3.7.2.2); all arrays are (N, C) float32."""
    out = base.astype(np.float64)
    for delta, weight in zip(deltas, weights):
        out[:, :delta.shape[1]] += weight * delta
    return out.astype(np.float32)


class Skins:
    """The file's skins. The joint matrices of a skin are computed once."""

    def __init__(self, root: Element, nodes: Nodes, accessors: Accessors) -> None:
        self.items = root.array("skins")
        self._nodes, self._accessors = nodes, accessors
        self._matrices: dict[int, np.ndarray] = {}

    def joint_matrices(self, index: int) -> np.ndarray:
        """Each joint's world matrix times its inverse bind matrix, (J, 4, 4) float64. The transform of the mesh's node
        is ignored (glTF 2.0, 3.7.3.3)."""
        if index not in self._matrices:
            skin = self.items[index]
            joints = skin.indices("joints", len(self._nodes.items))
            if not joints:
                raise skin.error("a skin needs joints", "joints")
            world = self._nodes.world[joints]
            accessor = skin.index("inverseBindMatrices", len(self._accessors.items), None)
            if accessor is not None:
                inverse_bind = self._accessors.floats(accessor, "MAT4")
                if len(inverse_bind) < len(joints):
                    raise skin.error(f"{len(inverse_bind)} matrices for {len(joints)} joints", "inverseBindMatrices")
                world = world @ inverse_bind[:len(joints)].reshape(-1, 4, 4).transpose(0, 2, 1).astype(np.float64)
            if not np.isfinite(world).all():
                raise skin.error("the joint matrices must be finite", "inverseBindMatrices")
            self._matrices[index] = world
        return self._matrices[index]


def blend_matrices(joints: np.ndarray, weights: np.ndarray, matrices: np.ndarray) -> np.ndarray:
    """Linear blend skinning: for each vertex sum_k w_k M_k, (N, 3, 4) float64, from (N, K) joints and weights.

    The weights are normalised to sum to 1. A vertex whose weights are all 0 follows its first joint.
    """
    weights = np.maximum(weights.astype(np.float64), 0.0)
    total = weights.sum(axis=1, keepdims=True)
    weights[:, :1] = np.where(total > 0, weights[:, :1], 1.0)
    weights /= np.where(total > 0, total, 1.0)
    rows = matrices[:, :3].reshape(-1, 12)
    out = np.zeros((len(joints), 12))
    for k in range(joints.shape[1]):
        out += weights[:, k, None] * rows[joints[:, k]]
    return out.reshape(-1, 3, 4)


def skin_positions(positions: np.ndarray, blend: np.ndarray) -> np.ndarray:
    """(N, 3) float32 points transformed by (N, 3, 4) matrices."""
    return (np.einsum("nij,nj->ni", blend[..., :3], positions) + blend[..., 3]).astype(np.float32)


def skin_directions(directions: np.ndarray, blend: np.ndarray) -> np.ndarray:
    """(N, 3) float32 unit tangents transformed by (N, 3, 4) matrices."""
    return _unit(np.einsum("nij,nj->ni", blend[..., :3], directions))


def skin_normals(normals: np.ndarray, blend: np.ndarray) -> np.ndarray:
    """(N, 3) float32 unit normals transformed by the inverse transpose of (N, 3, 4) matrices."""
    a = blend[..., :3]
    # The matrix of cofactors equals det * inverse transpose, and also exists for singular matrices.
    cofactor = np.stack([np.cross(a[:, 1], a[:, 2]), np.cross(a[:, 2], a[:, 0]), np.cross(a[:, 0], a[:, 1])], axis=1)
    return _unit(np.einsum("nij,nj->ni", cofactor, normals) * blend_sides(blend)[:, None])


def blend_sides(blend: np.ndarray) -> np.ndarray:
    """-1 where a (N, 3, 4) matrix mirrors, else 1, (N,) float32."""
    return np.where(np.linalg.det(blend[..., :3]) < 0, np.float32(-1), np.float32(1))


def rewound(count: int, indices: np.ndarray | None, sides: np.ndarray) -> np.ndarray | None:
    """The (M,) uint32 corners of triangles (None: 0..count-1), those turned round that the skin mirrors.

    A mirrored triangle winds clockwise as seen from outside (3.7.4). The joints decide and not the mesh's node, which
    has no say in where a skinned mesh lies; of three corners that differ, two outvote one.
    """
    if (sides > 0).all():
        return indices
    corners = (np.arange(count, dtype=np.uint32) if indices is None else indices)
    triangles = corners[:len(corners) // 3 * 3].reshape(-1, 3).copy()
    mirrored = sides[triangles].sum(axis=1) < 0
    triangles[mirrored] = triangles[mirrored][:, [0, 2, 1]]
    return triangles.ravel()


def _unit(vectors: np.ndarray) -> np.ndarray:
    length = np.linalg.norm(vectors, axis=1, keepdims=True)
    return (vectors / np.where(length > 0, length, 1.0)).astype(np.float32)
