"""The environments that lookups are measured in, and what they hold, in float64."""

from __future__ import annotations

from dataclasses import replace
from functools import lru_cache

import moderngl
import numpy as np

from viewer.bake.sun import extract_sun
from viewer.gpu.context import Context
from viewer.gpu.float_texture import float_texture
from viewer.gpu.mipmaps import mipmapped_texture
from viewer.scene.environment_presets import make_preset
from viewer.scene.equirect import shrink, texel_directions, texel_solid_angles

from .piece import MakeTexture

NAMES = ("studio", "sky")
"""Built in, so that the figures are the same everywhere."""


@lru_cache(maxsize=4)
def radiance(name: str) -> np.ndarray:
    """The map without its sun, as the renderer filters it, (512, 1024, 3) float32."""
    environment = make_preset(name)
    return extract_sun(replace(environment, source=environment.radiance))[0].radiance


@lru_cache(maxsize=4)
def texels(name: str, height: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """A smaller map's directions (N, 3), radiances (N, 3) and solid angles (N,), float64."""
    small = shrink(radiance(name), height, 2 * height).astype(np.float64)
    solid_angles = np.repeat(texel_solid_angles(height, 2 * height), 2 * height)
    return texel_directions(height, 2 * height).reshape(-1, 3), small.reshape(-1, 3), solid_angles


def seen(name: str, directions: np.ndarray) -> np.ndarray:
    """What the map holds in `directions` (..., 3), interpolated between its texels, float64."""
    pixels = radiance(name)
    height, width = pixels.shape[:2]
    x, y, z = np.moveaxis(directions, -1, 0)
    column = (0.5 + np.arctan2(z, x) / (2 * np.pi)) * width - 0.5
    row = np.clip(np.arctan2(np.hypot(x, z), y) / np.pi * height - 0.5, 0, height - 1)
    left, above = np.floor(column).astype(int), np.floor(row).astype(int)
    right, below = (left + 1) % width, np.minimum(above + 1, height - 1)
    across, down = (column - left)[..., None], (row - above)[..., None]
    upper = pixels[above, left % width] * (1 - across) + pixels[above, right] * across
    lower = pixels[below, left % width] * (1 - across) + pixels[below, right] * across
    return upper * (1 - down) + lower * down


def sphere_points(count: int) -> np.ndarray:
    """Unit vectors spread evenly, by a spiral, (count, 3) float64."""
    y = 1 - (2 * np.arange(count) + 1) / count
    phi = np.pi * (1 + np.sqrt(5)) * np.arange(count)
    return np.stack([np.sqrt(1 - y * y) * np.cos(phi), y, np.sqrt(1 - y * y) * np.sin(phi)], axis=-1)


def map_texture(pixels: np.ndarray) -> MakeTexture:
    """One level, that wraps around."""

    def make(context: Context) -> moderngl.Texture:
        texture = float_texture(context.gl, pixels)
        texture.repeat_x = True
        return texture

    return make


def levels_texture(levels: list[np.ndarray]) -> MakeTexture:
    """A chain of levels that wraps around."""

    def make(context: Context) -> moderngl.Texture:
        texture = mipmapped_texture(context, levels)
        texture.repeat_y = False
        return texture

    return make
