"""Adds missing normals and tangents to meshes."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from .arrays import rows_of
from .material import Texture
from .mesh import Mesh
from .normals import creased_normals, flat_normals, grouped_normals, smooth_normals
from .tangents import make_tangents
from .triangles import triangles_of
from .weld import weld


def picked(mesh: Mesh, source: np.ndarray) -> Mesh:
    """The mesh with each vertex k replaced by a copy of vertex source[k]. The indices are not changed."""
    return replace(mesh, positions=mesh.positions[source], normals=rows_of(mesh.normals, source),
                   tangents=rows_of(mesh.tangents, source), uvs=tuple(uv[source] for uv in mesh.uvs),
                   colors=rows_of(mesh.colors, source))


def with_flat_normals(mesh: Mesh) -> Mesh:
    """The mesh with flat normals and no shared vertices. Tangents are dropped, since they belong to other normals."""
    if mesh.indices is not None:
        mesh = replace(picked(mesh, mesh.indices), indices=None)
    return replace(mesh, normals=flat_normals(mesh.positions), tangents=None)


def with_creased_normals(mesh: Mesh) -> Mesh:
    """The mesh with smooth normals except at sharp edges, where vertices are split; see `creased_normals`."""
    return _with_corner_normals(mesh, creased_normals(mesh.positions, triangles_of(mesh)))


def with_grouped_normals(mesh: Mesh, groups: np.ndarray) -> Mesh:
    """The mesh with normals that are smooth within the smoothing group of each triangle, (T,); see `grouped_normals`.
    """
    return _with_corner_normals(mesh, grouped_normals(mesh.positions, triangles_of(mesh), groups))


def _with_corner_normals(mesh: Mesh, normals: np.ndarray) -> Mesh:
    """The mesh with the (T, 3, 3) normals of its corners, where vertices are split that have several."""
    vertex, normals = triangles_of(mesh).ravel(), normals.reshape(-1, 3)
    first = np.zeros(len(mesh.positions), np.int64)
    first[vertex[::-1]] = np.arange(len(vertex))[::-1]
    # Most vertices have one normal; the corners with another than that of the first one need sorting.
    same = first[vertex]
    differs = np.flatnonzero((normals != normals[same]).any(axis=1))
    again = weld(vertex[differs, None].astype(np.uint32).view(np.float32), normals[differs])
    same[differs] = differs[again]
    is_first = np.zeros(len(vertex), bool)
    is_first[same] = True
    return replace(picked(mesh, vertex[is_first]), normals=normals[is_first],
                   indices=(np.cumsum(is_first, dtype=np.uint32) - np.uint32(1))[same], tangents=None)


def with_repaired_normals(mesh: Mesh, bad: np.ndarray) -> Mesh:
    """The mesh with smooth normals in place of those that `bad` (N,) bool marks. The mesh must have normals."""
    assert mesh.normals is not None
    computed = smooth_normals(mesh.positions, triangles_of(mesh))
    return replace(mesh, normals=np.where(bad[:, None], computed, mesh.normals))


def with_tangents(mesh: Mesh, texture: Texture | None) -> Mesh:
    """The mesh with tangents for the texture coordinates of `texture`, or for the first UV set if it is None.

    Vertices at mirrored seams of the texture are split. A mesh without these coordinates gets no tangents.
    """
    return split_for_tangents(mesh, texture)[0]


def split_for_tangents(mesh: Mesh, texture: Texture | None) -> tuple[Mesh, np.ndarray | None]:
    """As `with_tangents`; and the vertex of `mesh` that each of the new vertices is a copy of, None for the same."""
    uv_set = texture.uv_set if texture is not None else 0
    if mesh.normals is None or uv_set >= len(mesh.uvs):
        return replace(mesh, tangents=None), None
    uvs = mesh.uvs[uv_set]
    if texture is not None and texture.transform is not None:
        matrix = texture.transform.matrix()
        uvs = (uvs @ matrix[:, :2].T + matrix[:, 2]).astype(np.float32)
    source, tangents, triangles = make_tangents(mesh.positions, mesh.normals, uvs, triangles_of(mesh))
    return replace(picked(mesh, source), tangents=tangents, indices=triangles.ravel()), source
