"""Whether a scene is convex, so that none of its surfaces can see another."""

from __future__ import annotations

import numpy as np

from .scene import Scene

_MOST = 1 << 24
"""Pairs of triangles and vertices that are looked at: about 0.1 s of one core."""
_AT_ONCE = 64
_FLAT = 1e-4
"""In radii of the scene: how far before a triangle's plane a vertex may lie. Small triangles have rough normals."""


def is_convex(scene: Scene) -> bool:
    """Whether everything lies behind, or in, the plane of each triangle. False also where there is too much to look at,
    and where there are no triangles."""
    points, triangles = [], []
    for instance in scene.instances:
        mesh, transform = scene.meshes[instance.mesh], instance.transform
        place = (mesh.positions @ transform[:3, :3].T + (transform[:3, 3] - scene.center)) / scene.radius
        drawn = place if mesh.indices is None else place[mesh.indices]
        points.append(drawn)
        corners = drawn[: 3 * mesh.triangle_count].reshape(-1, 3, 3)
        triangles.append(corners if np.linalg.det(transform[:3, :3] / scene.radius) > 0 else corners[:, ::-1])
    count = sum(map(len, triangles))
    if not 0 < count * count <= 2 * _MOST:  # a closed surface has half as many vertices as triangles
        return False
    everything, planes = np.unique(np.concatenate(points), axis=0), np.concatenate(triangles)
    for first in range(0, count, _AT_ONCE):  # most scenes show at the first ones that they are not
        a, b, c = planes[first:first + _AT_ONCE].swapaxes(0, 1)
        normal = np.cross(b - a, c - a)
        reach = (normal @ everything.T).max(axis=1) - np.einsum("ij,ij->i", normal, a)
        if (reach > _FLAT * (np.linalg.norm(normal, axis=1) + _FLAT)).any():  # what has no area has no plane
            return False
    return True
