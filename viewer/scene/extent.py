"""How far a scene reaches: about its centre, and along a direction."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from .scene import Scene


def enclosing_radius(scene: Scene) -> float:
    """See `Scene.radius`."""
    center = scene.center
    radius = float(np.linalg.norm(scene.volume_corners - center, axis=1).max(initial=0.0))
    radius = max([radius, *(curves.radius_about(center) for curves in scene.curves)])
    distance = np.linalg.norm(scene.corners - center, axis=2).max(axis=1, initial=0.0)
    if scene.instances:
        distance *= scene.has_extent
    for k in np.argsort(-distance):
        if distance[k] <= radius:
            break  # no vertex in this box or in the remaining ones is farther away than `radius`
        linear, offset = scene.instances[k].transform[:3, :3].T, scene.instances[k].transform[:3, 3] - center
        for chunk in scene.meshes[scene.instances[k].mesh].drawn_chunks():
            points = chunk @ linear + offset
            radius = max(radius, float(np.sqrt(np.einsum("ij,ij->i", points, points).max())))
    if not (scene.instances or scene.volumes or scene.curves):
        return float(np.sqrt(0.75))
    return radius or max(1e-6, float(np.abs(center).max()) * 1e-6)


def farthest(scene: Scene, direction: np.ndarray) -> np.ndarray:
    """See `Scene.farthest`."""
    if not (scene.instances or scene.volumes or scene.curves):
        return np.copysign(0.5, direction)
    best, vertex = -np.inf, np.zeros(3)
    points = np.concatenate([scene.volume_corners, *(c.farthest(direction)[None] for c in scene.curves)])
    if len(points):
        points -= scene.center
        vertex = points[(points @ direction).argmax()]
        best = float(vertex @ direction)
    bounds = ((scene.corners - scene.center) @ direction).max(axis=1)
    bounds[~scene.has_extent] = -np.inf
    order = np.argsort(-bounds, kind="stable")
    first = np.unique(scene.alike[order], return_index=True)[1]
    for k in order[np.sort(first)]:  # of boxes that a translation alone tells apart, the first is the farthest
        if bounds[k] <= best:
            break  # no vertex in this box or in the remaining ones is farther
        linear, offset = scene.instances[k].transform[:3, :3], scene.instances[k].transform[:3, 3] - scene.center
        for chunk in scene.meshes[scene.instances[k].mesh].drawn_chunks():
            point = linear @ chunk[(chunk @ (direction @ linear)).argmax()] + offset
            if (along := float(point @ direction)) > best:
                best, vertex = along, point
    return vertex
