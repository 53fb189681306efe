"""Small maps and direct quadrature, to hold the bakes against."""

from __future__ import annotations

import numpy as np

from viewer.bake.lobes import lobe
from viewer.scene.equirect import texel_directions, texel_solid_angles


def noise_with_sun(height: int = 32, sun: float = 1e5) -> np.ndarray:
    """(H, 2H, 3) float32: noise around 1 and one texel of a sun."""
    radiance = 0.5 + np.random.default_rng(4).random((height, 2 * height, 3)).astype(np.float32)
    radiance[height // 4, height // 3] = [sun, 0.8 * sun, 0.5 * sun]
    return radiance


def convolved(radiance: np.ndarray, ndf: str, alpha: float, directions: np.ndarray) -> np.ndarray:
    """The map filtered for a lobe, by summing over its texels in float64; directions (N, 3), result (N, 3)."""
    theta = (np.arange(100000) + 0.5) * (np.pi / 2e5)
    norm = 2 * np.pi * (lobe(ndf, alpha, theta) * np.sin(theta)).sum() * (np.pi / 2e5)
    height, width = radiance.shape[:2]
    energy = (radiance * texel_solid_angles(height, width)[:, None, None]).reshape(-1, 3)
    cosine = directions @ texel_directions(height, width).reshape(-1, 3).T
    return lobe(ndf, alpha, np.arccos(np.clip(cosine, -1, 1))) @ energy / norm


def irradiance_of(radiance: np.ndarray, normals: np.ndarray) -> np.ndarray:
    """The integral of radiance times cosine, by summing over texels in float64; normals (N, 3), result (N, 3)."""
    height, width = radiance.shape[:2]
    energy = (radiance * texel_solid_angles(height, width)[:, None, None]).reshape(-1, 3)
    return np.maximum(normals @ texel_directions(height, width).reshape(-1, 3).T, 0) @ energy


def bilinear(level: np.ndarray, directions: np.ndarray, margin: float) -> np.ndarray:
    """A level looked up as the shader does: repeat in u, clamp in v, rows squeezed by the margin at the poles."""
    height, width = level.shape[:2]
    level = level.astype(np.float64)
    u = (0.5 + np.arctan2(directions[..., 2], directions[..., 0]) / (2 * np.pi)) * width - 0.5
    v = margin + (1 - 2 * margin) * np.arccos(np.clip(directions[..., 1], -1, 1)) / np.pi
    v = np.clip(v * height - 0.5, 0, height - 1)
    x, y = np.floor(u).astype(int), np.minimum(np.floor(v).astype(int), height - 2)
    s, t = (u - x)[..., None], (v - y)[..., None]
    left, right = x % width, (x + 1) % width
    top = level[y, left] * (1 - s) + level[y, right] * s
    return top * (1 - t) + (level[y + 1, left] * (1 - s) + level[y + 1, right] * s) * t


def random_directions(count: int) -> np.ndarray:
    directions = np.random.default_rng(5).normal(size=(count, 3))
    return directions / np.linalg.norm(directions, axis=1, keepdims=True)
