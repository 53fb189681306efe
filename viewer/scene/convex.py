"""Tests whether a scene is convex: then there is no interreflection, since no surface sees another."""

from __future__ import annotations

import numpy as np

from .scene import Scene

_MAX_PAIRS = 1 << 24
"""The most pairs of a triangle and a vertex that are tested: about 0.1 s of one core."""
_BATCH = 64
"""Triangles per step."""
_TOLERANCE = 1e-4
"""The distance, in radii of the scene, that a vertex may lie in front of a triangle's plane. Small triangles have
inexact normals."""


def is_convex(scene: Scene) -> bool:
    """Whether all vertices lie behind, or in, the plane of each triangle.

    It is also False if the scene has too many triangles to test, and if it has none.
    """
    points, triangles = [], []
    for instance in scene.instances:
        mesh, transform = scene.meshes[instance.mesh], instance.transform
        positions = (mesh.positions @ transform[:3, :3].T + (transform[:3, 3] - scene.center)) / scene.radius
        drawn = positions if mesh.indices is None else positions[mesh.indices]
        points.append(drawn)
        corners = drawn[: 3 * mesh.triangle_count].reshape(-1, 3, 3)
        triangles.append(corners if np.linalg.det(transform[:3, :3] / scene.radius) > 0 else corners[:, ::-1])
    count = sum(map(len, triangles))
    if not 0 < count * count <= 2 * _MAX_PAIRS:  # a closed surface has half as many vertices as triangles
        return False
    vertices, planes = np.unique(np.concatenate(points), axis=0), np.concatenate(triangles)
    for first in range(0, count, _BATCH):  # for most scenes that are not convex, the first batch shows it
        a, b, c = planes[first:first + _BATCH].swapaxes(0, 1)
        normal = np.cross(b - a, c - a)
        distance = (normal @ vertices.T).max(axis=1) - np.einsum("ij,ij->i", normal, a)
        # `normal` is as long as twice the area. The second term passes triangles without area, which have no plane.
        if (distance > _TOLERANCE * (np.linalg.norm(normal, axis=1) + _TOLERANCE)).any():
            return False
    return True
