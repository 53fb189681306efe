"""The few shapes that checks are made on, built without a file."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from functools import lru_cache

import numpy as np

from ...scene.camera import Camera
from ...scene.environment import Environment
from ...scene.light import Light
from ...scene.material import Material
from ...scene.mesh import Mesh
from ...scene.scene import Instance, Scene


@lru_cache(maxsize=4)
def sphere(material: int = 0, segments: int = 128) -> Mesh:
    """Radius 1 about the origin, with its own positions as normals, tangents along the equator and a map's UVs."""
    v, u = np.meshgrid(np.linspace(0, 1, segments // 2 + 1), np.linspace(0, 1, segments + 1), indexing="ij")
    theta, phi = np.pi * v, 2 * np.pi * u
    points = np.stack([np.sin(theta) * np.sin(phi), np.cos(theta), np.sin(theta) * np.cos(phi)], axis=-1)
    tangents = np.stack([np.cos(phi), 0 * phi, -np.sin(phi), 1 + 0 * phi], axis=-1)
    corner = (np.arange(segments // 2)[:, None] * (segments + 1) + np.arange(segments)).ravel()
    down, right = corner + segments + 1, corner + 1
    triangles = np.stack([corner, down, right, right, down, down + 1], axis=1)
    positions = points.reshape(-1, 3).astype(np.float32)
    return Mesh("sphere", positions, material, indices=triangles.ravel().astype(np.uint32), normals=positions,
                tangents=tangents.reshape(-1, 4).astype(np.float32),
                uvs=(np.stack([u, v], axis=-1).reshape(-1, 2).astype(np.float32),))


def plate(material: int = 0, half: float = 1.0) -> Mesh:
    """A square of the plane z = 0, `half` its half side, that faces +Z."""
    corners = np.array([[-1, -1, 0], [1, -1, 0], [1, 1, 0], [-1, 1, 0]], np.float32)
    return Mesh("plate", corners * np.float32(half), material, indices=np.array([0, 1, 2, 0, 2, 3], np.uint32),
                normals=np.tile(np.array([0, 0, 1], np.float32), (4, 1)),
                tangents=np.tile(np.array([1, 0, 0, 1], np.float32), (4, 1)),
                uvs=(corners[:, :2] * np.array([0.5, -0.5], np.float32) + np.float32(0.5),))


def scene(meshes: Sequence[Mesh], materials: Sequence[Material], *, transforms: Sequence[np.ndarray] | None = None,
          lights: Sequence[Light] = (), environment: Environment | None = None) -> Scene:
    """Every mesh once, where its transform puts it."""
    transforms = transforms or [np.eye(4)] * len(meshes)
    instances = tuple(Instance(k, transform) for k, transform in enumerate(transforms))
    return Scene("check", tuple(meshes), tuple(materials), instances, lights=tuple(lights), environment=environment)


def placed(offset: Sequence[float] | np.ndarray = (0, 0, 0), scale: float = 1.0) -> np.ndarray:
    """Scaled about the origin, then moved; (4, 4)."""
    matrix = np.diag([scale, scale, scale, 1.0])
    matrix[:3, 3] = offset
    return matrix


def orthographic(height: float = 2.1, azimuth: float = 0.4, elevation: float = 0.3) -> Camera:
    """Parallel rays at the origin, which see `height` from bottom to top."""
    return replace(Camera.orbit((0, 0, 0), 5.0, azimuth, elevation), height=height)


def ball_cosines(camera: Camera, size: int) -> np.ndarray:
    """NoV of the unit sphere at the pixels' centres of an orthographic square picture, (size, size); 0 beside it."""
    offset = ((np.arange(size) + 0.5) / size - 0.5) * (camera.height or 0.0)
    return np.sqrt(np.maximum(1 - offset[:, None] ** 2 - offset[None, :] ** 2, 0))


@lru_cache(maxsize=4)
def constant(radiance: float = 1.0) -> Environment:
    """The same radiance from everywhere."""
    return Environment("constant", np.full((32, 64, 3), radiance, np.float32))
