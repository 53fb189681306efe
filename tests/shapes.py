"""Scenes whose pictures can be worked out on paper: spheres and plates, seen by an orthographic camera."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from viewer.scene.camera import Camera
from viewer.scene.environment import Environment
from viewer.scene.equirect import texel_directions
from viewer.scene.light import Light
from viewer.scene.material import Material
from viewer.scene.mesh import Mesh
from viewer.scene.scene import Instance, Scene

WHITE = Material(metallic=0.0, perceptual_roughness=1.0, specular=0.0)
"""Lambertian: with specular 0 nothing reflects at the interface."""


def sphere(material: int = 0, segments: int = 96) -> Mesh:
    """Radius 1 about the origin, with smooth normals."""
    theta, phi = np.linspace(0, np.pi, segments // 2 + 1), np.linspace(0, 2 * np.pi, segments + 1)
    theta, phi = np.meshgrid(theta, phi, indexing="ij")
    points = np.stack([np.sin(theta) * np.sin(phi), np.cos(theta), np.sin(theta) * np.cos(phi)], axis=-1)
    rows, columns = points.shape[:2]
    corner = (np.arange(rows - 1)[:, None] * columns + np.arange(columns - 1)).ravel()
    down, right = corner + columns, corner + 1
    quads = np.stack([corner, down, right, right, down, down + 1], axis=1)
    positions = points.reshape(-1, 3).astype(np.float32)
    return Mesh("sphere", positions, material, indices=quads.astype(np.uint32).ravel(), normals=positions)


def plate(material: int = 0, half: float = 1.0) -> Mesh:
    """A square that faces +Z, with texture coordinates from the upper left."""
    positions = np.float32([[-half, -half, 0], [half, -half, 0], [half, half, 0], [-half, half, 0]])
    uv = np.float32([[0, 1], [1, 1], [1, 0], [0, 0]])
    return Mesh("plate", positions, material, indices=np.uint32([0, 1, 2, 0, 2, 3]),
                normals=np.float32([[0, 0, 1]] * 4), tangents=np.float32([[1, 0, 0, 1]] * 4), uvs=(uv,))


def scene(*meshes: Mesh | tuple[Mesh, np.ndarray], materials=(WHITE,), lights: tuple[Light, ...] = (),
          environment: Environment | None = None) -> Scene:
    """Each mesh once, placed by its matrix where there is one."""
    placed = [entry if isinstance(entry, tuple) else (entry, np.eye(4)) for entry in meshes]
    return Scene("test", tuple(mesh for mesh, _ in placed), tuple(materials),
                 tuple(Instance(k, matrix) for k, (_, matrix) in enumerate(placed)), lights=lights,
                 environment=environment)


def moved(offset, scale: float | tuple[float, float, float] = 1.0) -> np.ndarray:
    matrix = np.diag([*np.broadcast_to(np.asarray(scale, float), 3), 1.0])
    matrix[:3, 3] = offset
    return matrix


def facing_floor(scale: float = 1.0, y: float = 0.0) -> np.ndarray:
    """Lays a plate on the floor, facing +Y."""
    matrix = np.eye(4)
    matrix[:3, :3] = scale * np.array([[1, 0, 0], [0, 0, 1], [0, -1, 0]], float)
    matrix[1, 3] = y
    return matrix


def orthographic(azimuth: float = 0.0, elevation: float = 0.0, height: float = 2.0, distance: float = 5.0) -> Camera:
    return replace(Camera.orbit((0, 0, 0), distance, azimuth, elevation), height=height)


def pixel_points(camera: Camera, size: tuple[int, int]) -> np.ndarray:
    """Where the rays through the pixel centres of an orthographic camera start, (H, W, 3)."""
    width, height = size
    y = (0.5 - (np.arange(height) + 0.5) / height) * camera.height
    x = ((np.arange(width) + 0.5) / width - 0.5) * camera.height * width / height
    return camera.eye + x[None, :, None] * camera.pose[:3, 0] + y[:, None, None] * camera.pose[:3, 1]


def seen_plane(camera: Camera, size: tuple[int, int], normal=(0, 0, 1)) -> np.ndarray:
    """The points of the plane through the origin that the pixels see, (H, W, 3)."""
    start, normal = pixel_points(camera, size), np.asarray(normal, float)
    return start - (start @ normal / (camera.forward @ normal))[..., None] * camera.forward


def lopsided(height: int = 64) -> Environment:
    """Red grows towards +X, green upwards, blue towards +Z, and there is a bright spot between them."""
    d = texel_directions(height, 2 * height)
    spot = np.exp(40 * (d @ (np.array([0.5, 0.4, 0.77]) / np.linalg.norm([0.5, 0.4, 0.77])) - 1))
    return Environment("lopsided", (0.6 + 0.5 * d + 4 * spot[..., None]).astype(np.float32))


def constant(radiance: float = 1.0) -> Environment:
    return Environment("constant", np.full((32, 64, 3), radiance, np.float32))
