"""Morph targets and skins, applied to vertices on the CPU."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from .mesh import Mesh
from .normals import flat_normals


@dataclass(frozen=True, eq=False)
class MorphTarget:
    """What one target adds to the vertices at weight 1, (N, 3) or, for colours, (N, 3 or 4); None for nothing."""

    positions: np.ndarray | None = None
    normals: np.ndarray | None = None
    tangents: np.ndarray | None = None
    uvs: tuple[np.ndarray | None, ...] = ()
    colors: np.ndarray | None = None


@dataclass(frozen=True, eq=False)
class Deformation:
    """How the vertices of a mesh move.

    `joints` (K, N) integers and `weights` (K, N) float64, which sum to 1 at each vertex, say which matrices move it;
    they are None without a skin. With `is_faceted` the normals are those of the facets, whatever their shape.
    """

    targets: tuple[MorphTarget, ...] = ()
    joints: np.ndarray | None = None
    weights: np.ndarray | None = None
    is_faceted: bool = False

    def picked(self, source: np.ndarray) -> Deformation:
        """Of a mesh whose vertex k is a copy of vertex source[k]."""
        def pick(array: np.ndarray | None) -> np.ndarray | None:
            return None if array is None else array[source]

        def pick_columns(array: np.ndarray | None) -> np.ndarray | None:
            return None if array is None else np.ascontiguousarray(array[:, source])

        targets = tuple(MorphTarget(pick(t.positions), pick(t.normals), pick(t.tangents), tuple(map(pick, t.uvs)),
                                    pick(t.colors)) for t in self.targets)
        return replace(self, targets=targets, joints=pick_columns(self.joints),
                       weights=pick_columns(self.weights))

    def applied(self, rest: Mesh, weights: tuple[float, ...], matrices: np.ndarray | None) -> Mesh:
        """`rest` deformed by these weights of the targets, and by the matrices of the joints, (J, 4, 4) float64.

        What does not change is the same array as that of `rest`.
        """
        mesh = self._morphed(rest, weights)
        if matrices is not None and self.joints is not None and self.weights is not None:
            mesh = _skinned(mesh, blend_matrices(self.joints, self.weights, matrices), self.is_faceted)
        if self.is_faceted and mesh.positions is not rest.positions:
            mesh = replace(mesh, normals=_facet_normals(mesh))
        return mesh

    def _morphed(self, rest: Mesh, weights: tuple[float, ...]) -> Mesh:
        active = [(target, weight) for target, weight in zip(self.targets, weights) if weight]
        changes: dict[str, Any] = {}

        def moved(base: np.ndarray, deltas: list[np.ndarray | None]) -> np.ndarray:
            """`base` plus the sum of weight * delta; `base` itself if there are no deltas."""
            if all(delta is None for delta in deltas):
                return base
            out = base.astype(np.float64)
            for delta, (_, weight) in zip(deltas, active):
                if delta is not None:
                    out[:, :delta.shape[1]] += weight * delta
            return out.astype(np.float32)

        changes["positions"] = moved(rest.positions, [t.positions for t, _ in active])
        if (base := rest.normals) is not None:
            normals = moved(base, [t.normals for t, _ in active])
            changes["normals"] = base if normals is base else unit_or(normals, base)
        if (base := rest.tangents) is not None:
            changes["tangents"] = tangents = moved(base, [t.tangents for t, _ in active])
            if tangents is not base:
                tangents[:, :3] = unit_or(tangents[:, :3], base[:, :3])
        if (base := rest.colors) is not None:
            colors = moved(base, [t.colors for t, _ in active])
            changes["colors"] = base if colors is base else np.clip(colors, 0, 1)
        changes["uvs"] = tuple(moved(uv, [t.uvs[k] if k < len(t.uvs) else None for t, _ in active])
                               for k, uv in enumerate(rest.uvs))
        return replace(rest, **changes) if active else rest


def influences(joints: np.ndarray, weights: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """`Deformation.joints` and `.weights` of (N, K) joints and weights as a file has them.

    A vertex whose weights are all 0 follows its first joint. What has no weight at any vertex is dropped.
    """
    weights = np.maximum(weights.T.astype(np.float64), 0.0)
    total = weights.sum(axis=0)
    weights[0] = np.where(total > 0, weights[0], 1.0)
    weights /= np.where(total > 0, total, 1.0)
    used = weights.any(axis=1)
    return np.ascontiguousarray(joints.T[used], np.intp), weights[used]


def blend_matrices(joints: np.ndarray, weights: np.ndarray, matrices: np.ndarray) -> np.ndarray:
    """Linear blend skinning: for each vertex sum_k w_k M_k, as (3, 4, N) float64, from (K, N) joints and weights."""
    entries = np.ascontiguousarray(matrices[:, :3].reshape(-1, 12).T)
    out = np.zeros((12, joints.shape[1]))
    for joint, weight in zip(joints, weights):
        part = entries.take(joint, axis=1, mode="clip")  # "raise", the default, takes twice the time
        part *= weight
        out += part
    return out.reshape(3, 4, -1)


def _skinned(mesh: Mesh, blend: np.ndarray, is_faceted: bool) -> Mesh:
    sides = blend_sides(blend)
    indices = mesh.indices
    if mesh.topology == "triangles" and not (sides > 0).all():
        indices = rewound(len(mesh.positions), mesh.indices, sides)
    normals, tangents = mesh.normals, mesh.tangents
    if normals is not None and not is_faceted:
        normals = unit_or((_times(cofactors(blend), normals) * sides).T, normals)
    if tangents is not None:
        turned = np.empty_like(tangents)
        turned[:, :3] = unit_or(_times(blend[:, :3], tangents[:, :3]).T, tangents[:, :3])
        turned[:, 3] = tangents[:, 3] * sides
        tangents = turned
    positions = (_times(blend[:, :3], mesh.positions) + blend[:, 3]).T.astype(np.float32, order="C")
    return replace(mesh, positions=positions, indices=indices, normals=normals, tangents=tangents)


def cofactors(blend: np.ndarray) -> np.ndarray:
    """The cofactors (3, 3, N) of the 3x3 part: det * inverse transpose, which also exists for singular matrices."""
    (a, b, c), (d, e, f), (g, h, i) = blend[:, :3]
    return np.array([[e * i - f * h, f * g - d * i, d * h - e * g],
                     [h * c - i * b, i * a - g * c, g * b - h * a],
                     [b * f - c * e, c * d - a * f, a * e - b * d]])


def blend_sides(blend: np.ndarray) -> np.ndarray:
    """-1 where a matrix of (3, 4, N) mirrors, else 1, (N,) float32."""
    (a, b, c), (d, e, f), (g, h, i) = blend[:, :3]
    determinant = a * (e * i - f * h) + b * (f * g - d * i) + c * (d * h - e * g)
    return np.where(determinant < 0, np.float32(-1), np.float32(1))


def rewound(count: int, indices: np.ndarray | None, sides: np.ndarray) -> np.ndarray:
    """The (M,) uint32 corners of triangles (None: 0..count-1), those turned round that the skin mirrors.

    A mirrored triangle winds clockwise as seen from outside (glTF 2.0, 3.7.4). The joints decide and not the mesh's
    node, which has no say in where a skinned mesh lies; of three corners that differ, two outvote one.
    """
    corners = (np.arange(count, dtype=np.uint32) if indices is None else indices)
    triangles = corners[:len(corners) // 3 * 3].reshape(-1, 3).copy()
    mirrored = sides[triangles].sum(axis=1) < 0
    triangles[mirrored] = triangles[mirrored][:, [0, 2, 1]]
    return triangles.ravel()


def unit_or(vectors: np.ndarray, otherwise: np.ndarray) -> np.ndarray:
    """(N, 3) vectors at length 1, float32, with the rows of `otherwise` for those without length or not finite."""
    with np.errstate(all="ignore"):
        length = np.sqrt(np.einsum("ij,ij->i", vectors, vectors))[:, None]
        good = (length > 0) & np.isfinite(length)
        return np.where(good, vectors / np.where(good, length, 1.0), otherwise).astype(np.float32)


def _times(matrices: np.ndarray, vectors: np.ndarray) -> np.ndarray:
    """(3, 3, N) matrices times (N, 3) vectors, as (3, N) float64.

    Whole columns are multiplied: a loop over vertices, which einsum makes of it, takes five times as long.
    """
    x, y, z = vectors.T.astype(np.float64)
    return matrices[:, 0] * x + matrices[:, 1] * y + matrices[:, 2] * z


def _facet_normals(mesh: Mesh) -> np.ndarray:
    """The normals of a mesh whose triangles share no vertices; a vertex of no triangle keeps its own."""
    if mesh.indices is None:
        return flat_normals(mesh.positions)
    assert mesh.normals is not None
    normals = mesh.normals.copy()
    normals[mesh.indices] = flat_normals(mesh.positions[mesh.indices])
    return normals
