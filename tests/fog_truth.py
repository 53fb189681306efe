"""Fog by quadrature in float64: optical depths, and light scattered once. `fog` is a `viewer.scene.fog.Fog`."""

from __future__ import annotations

import numpy as np
from shapes import pixel_points

from viewer.scene.camera import Camera
from viewer.scene.light import Light


def rays(camera: Camera, size: tuple[int, int] = (16, 16)) -> tuple[np.ndarray, np.ndarray]:
    """Origins and directions through the centres of the pixels, (H, W, 3)."""
    if camera.height is not None:
        start = pixel_points(camera, size) - 20 * camera.forward  # what lies behind the camera is seen, too
        return start, np.broadcast_to(camera.forward, start.shape)
    y, x = ((np.arange(n) + 0.5) / n * 2 - 1 for n in size)
    t = np.tan(camera.fov_y / 2)
    direction = camera.forward + t * (x[None, :, None] * camera.pose[:3, 0] - y[:, None, None] * camera.pose[:3, 1])
    direction /= np.linalg.norm(direction, axis=-1, keepdims=True)
    return np.broadcast_to(camera.eye, direction.shape), direction


def density(fog, points: np.ndarray) -> np.ndarray:
    thin = np.exp(-np.maximum(points[..., 1] - fog.base, 0) / fog.scale_height)
    inside = np.linalg.norm(points - fog.center, axis=-1) < fog.radius
    return fog.medium.sigma_t[0] * thin * inside


def optical_depth(fog, start: np.ndarray, direction: np.ndarray, distance, count: int = 4000) -> np.ndarray:
    """By the midpoint rule, over the way in the ball."""
    t = (np.arange(count) + 0.5) / count * np.asarray(distance)[..., None]
    points = start[..., None, :] + t[..., None] * direction[..., None, :]
    return density(fog, points).mean(axis=-1) * distance


def single_scattering(fog, light: Light, start: np.ndarray, direction: np.ndarray, reach: float,
                      blocked=lambda points: np.zeros(points.shape[:-1], bool)) -> np.ndarray:
    """Radiance that fog scatters once from a light, by quadrature; `blocked(points)` are in shadow."""
    count = 400
    t = (np.arange(count) + 0.5) / count * reach
    points = start[..., None, :] + t[:, None] * direction[..., None, :]
    extinction = density(fog, points)
    before = (np.cumsum(extinction, axis=-1) - 0.5 * extinction) * (reach / count)
    if light.kind == "directional":
        to_light, falls = -np.broadcast_to(light.direction, points.shape), 1.0
        b = ((points - fog.center) * to_light).sum(-1)
        c = ((points - fog.center) ** 2).sum(-1) - fog.radius**2
        distance = -b + np.sqrt(np.maximum(b * b - c, 0))
    else:
        to_light = np.asarray(light.position) - points
        distance = np.linalg.norm(to_light, axis=-1)
        to_light, falls = to_light / distance[..., None], 1 / distance**2
    arriving = light.intensity * falls * np.exp(-optical_depth(fog, points, to_light, distance, 50))
    g, mu = fog.medium.g, (to_light * direction[..., None, :]).sum(-1)
    phase = (1 - g * g) / (4 * np.pi * (1 + g * g - 2 * g * mu) ** 1.5)
    added = np.exp(-before) * extinction * fog.medium.albedo[0] * phase * arriving * ~blocked(points)
    return added.sum(-1) * (reach / count)
