"""The numbers by which deferred triangles are told apart, and the planes they lie in (shaders/raster/planes.glsl)."""

from __future__ import annotations

import numpy as np

from ..gpu.buffer_texture import BufferTexture
from ..gpu.context import Context
from ..plan.deferral import TRIANGLE_BITS
from ..plan.model import Draw
from ..scene.scene import Scene
from ..scene.triangles import triangles_of
from ..scene.unit_vectors import unit_vectors
from .pixel_boxes import cell_corners


class NumberedTriangles:
    """The numbers of all triangles of a scene that are deferred, and their planes."""

    def __init__(self, context: Context, scene: Scene, draws: list[Draw]) -> None:
        self._key = _key(scene, draws)
        self.first: dict[int, int] = {}
        """The number of the first triangle of each instance (shaders/raster/planes.glsl)."""
        self.objects = {draw.instance: k for k, draw in enumerate(draws)}
        """The number of each instance, from 0."""
        planes, corners, count = [], [], 0
        for draw in draws:
            mesh = scene.meshes[draw.mesh]
            matrix = scene.instances[draw.instance].transform
            self.first[draw.instance] = self.objects[draw.instance] << TRIANGLE_BITS | (count + 1)
            count += mesh.triangle_count
            planes.append(triangle_planes(mesh.positions, triangles_of(mesh), matrix, scene))
            corners.append(cell_corners(mesh.positions) @ matrix[:3, :3].T + matrix[:3, 3])
        self.corners = np.concatenate(corners)
        """Points (N, 3) in world axes, whose convex hull has all triangles in it."""
        self.planes = BufferTexture(context, np.concatenate(planes))

    def fits(self, scene: Scene, draws: list[Draw]) -> bool:
        return self._key == _key(scene, draws)

    def release(self) -> None:
        self.planes.release()


def _key(scene: Scene, draws: list[Draw]) -> tuple[object, ...]:
    """What the planes follow from. Meshes are compared by identity."""
    placed = [(draw.instance, scene.meshes[draw.mesh], scene.instances[draw.instance].transform.tobytes())
              for draw in draws]
    return *placed, *scene.center.tolist(), scene.radius


def triangle_planes(positions: np.ndarray, triangles: np.ndarray, matrix: np.ndarray, scene: Scene) -> np.ndarray:
    """n and d of n p + d = 0 for each triangle, (T, 4) float32, with |n| = 1. p is about the scene's centre, in its
    radius. Those of a mirrored mesh have their normals turned, which are only compared with one another.
    """
    to_scene = (matrix[:3, :3] / scene.radius).T
    middle = (matrix[:3, 3] - scene.center) / scene.radius
    corners = positions.astype(np.float64)[triangles] @ to_scene + middle
    normals = unit_vectors(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]))
    return np.concatenate([normals, -(normals * corners[:, 0]).sum(axis=1, keepdims=True)], axis=1).astype(np.float32)
