"""A mesh whose faces are moved outwards, all by the same distance."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from ...scene.unit_vectors import unit_vectors
from .geometry import TraceMesh

_MOST = 4.0
"""A sharp corner moves by at most this many times the distance."""


def grown(mesh: TraceMesh, transform: NDArray[np.float64], is_mirrored: bool, distance: float) -> TraceMesh:
    """`mesh`, placed by `transform`, (3, 4), with its faces moved outwards by `distance`; vertices at one place stay at
    one place, so that edges do not open. The mesh itself where the transform flattens it."""
    matrix = transform[:, :3]
    if abs(np.linalg.det(matrix)) <= 1e-12 * np.linalg.norm(matrix) ** 3:
        return mesh
    _, first, place = np.unique(mesh.positions, axis=0, return_index=True, return_inverse=True)
    place = place.ravel()
    points = mesh.positions[first].astype(np.float64) @ matrix.T + transform[:, 3]
    corners = place[mesh.triangles]
    edges = points[np.roll(corners, -1, axis=1)] - points[corners]
    normals = np.cross(edges[:, 0], edges[:, 1]) * (-1 if is_mirrored else 1)
    size = np.linalg.norm(normals, axis=1)
    has_area = size > 0
    corners, edges, normals = corners[has_area], edges[has_area], normals[has_area] / size[has_area, None]
    out = np.zeros_like(points)
    for k in range(3):
        np.add.at(out, corners[:, k], normals * _angle(edges[:, k], -edges[:, k - 1])[:, None])
    out = unit_vectors(out)
    least = np.ones(len(points))  # cosine between the way of a corner and the normals of its faces
    for k in range(3):
        np.minimum.at(least, corners[:, k], np.einsum("ij,ij->i", out[corners[:, k]], normals))
    points += distance / np.maximum(least, 1 / _MOST)[:, None] * out
    moved = np.linalg.solve(matrix, (points - transform[:, 3]).T).T
    return replace(mesh, positions=moved[place].astype(np.float32))


def _angle(a: NDArray[np.float64], b: NDArray[np.float64]) -> NDArray[np.float64]:
    """Between rows of vectors, (N,)."""
    return np.arctan2(np.linalg.norm(np.cross(a, b), axis=1), np.einsum("ij,ij->i", a, b))
