"""Meshes given the normals and tangents that they lack."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from .material import Texture
from .mesh import Mesh
from .normals import creased_normals, flat_normals, smooth_normals
from .tangents import make_tangents
from .triangles import triangles_of
from .weld import weld


def picked(mesh: Mesh, source: np.ndarray) -> Mesh:
    """The mesh with vertex k a copy of vertex source[k]; the indices are left as they are."""
    def pick(array: np.ndarray | None) -> np.ndarray | None:
        return None if array is None else array[source]
    return replace(mesh, positions=mesh.positions[source], normals=pick(mesh.normals), tangents=pick(mesh.tangents),
                   uvs=tuple(uv[source] for uv in mesh.uvs), colors=pick(mesh.colors))


def with_flat_normals(mesh: Mesh) -> Mesh:
    """Every triangle with corners and a normal of its own; tangents, which belonged to other normals, are dropped."""
    if mesh.indices is not None:
        mesh = replace(picked(mesh, mesh.indices), indices=None)
    return replace(mesh, normals=flat_normals(mesh.positions), tangents=None)


def with_creased_normals(mesh: Mesh) -> Mesh:
    """Smooth but for sharp edges, where vertices are split; see `creased_normals`."""
    triangles = triangles_of(mesh)
    vertex = triangles.ravel()
    normals = creased_normals(mesh.positions, triangles).reshape(-1, 3)
    first = weld(vertex[:, None].astype(np.uint32).view(np.float32), normals)
    kept, indices = np.unique(first, return_inverse=True)
    return replace(picked(mesh, vertex[kept]), normals=normals[kept], indices=indices.astype(np.uint32), tangents=None)


def with_mended_normals(mesh: Mesh, bad: np.ndarray) -> Mesh:
    """Smooth normals in place of those that are `bad` (N,), of a mesh that has normals."""
    assert mesh.normals is not None
    computed = smooth_normals(mesh.positions, triangles_of(mesh))
    return replace(mesh, normals=np.where(bad[:, None], computed, mesh.normals))


def with_tangents(mesh: Mesh, texture: Texture | None) -> Mesh:
    """Tangents along the coordinates that `texture` is read at, or else along the first UV set.

    Vertices are split where they must be. A mesh without the coordinates gets no tangents.
    """
    uv_set = texture.uv_set if texture is not None else 0
    if mesh.normals is None or uv_set >= len(mesh.uvs):
        return replace(mesh, tangents=None)
    uvs = mesh.uvs[uv_set]
    if texture is not None and texture.transform is not None:
        matrix = texture.transform.matrix()
        uvs = (uvs @ matrix[:, :2].T + matrix[:, 2]).astype(np.float32)
    source, tangents, triangles = make_tangents(mesh.positions, mesh.normals, uvs, triangles_of(mesh))
    return replace(picked(mesh, source), tangents=tangents, indices=triangles.ravel())
