"""Approximates an environment by directional lights: one in the middle of each of its parts, with all light of that.

As in Agarwal et al. 2003, "Structured Importance Sampling of Environment Maps", each part is what one of the lights is
nearest to. Here importance sampling only says where the lights begin. Each then moves to the middle of its part, a few
times (Lloyd 1982, "Least Squares Quantization in PCM").
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from ..scene.color import LUMINANCE
from .prefilter import MARGIN

UNIFORM_FRACTION = 0.3
"""The fraction of the lights that is spread uniformly over the sphere, for surfaces that see only dark parts of the
map."""
_ROUNDS = 4
"""How often the lights move."""
_GOLDEN = (np.sqrt(5) - 1) / 2


@dataclass(frozen=True, eq=False)
class ManyLights:
    directions: np.ndarray
    """Unit vectors to the lights, (N, 3) float64, without the environment's rotation."""
    irradiance: np.ndarray
    """The irradiance of a surface that faces the light, (N, 3) float64."""
    solid_angles: np.ndarray
    """That of the sphere which each light stands for, (N,) float64; 0 where others are nearer to all of it."""


def uniform_lights(count: int, radiance: ArrayLike) -> ManyLights:
    """`count` lights in place of a constant radiance (3,) from everywhere, on a golden spiral."""
    height = 1 - (2 * np.arange(count) + 1) / count
    turn, width = 2 * np.pi * _GOLDEN * np.arange(count), np.sqrt(1 - height**2)
    directions = np.stack([width * np.cos(turn), height, width * np.sin(turn)], axis=1)
    solid_angles = np.full(count, 4 * np.pi / count)
    return ManyLights(directions, solid_angles[:, None] * np.asarray(radiance, np.float64), solid_angles)


def many_lights(level: np.ndarray, count: int) -> ManyLights:
    """`count` lights for a level of an environment's mip chain (H, W, 3), which has a margin at the poles; H and W are
    multiples of 8.

    They begin where a golden-ratio lattice is warped to by the map's luminance, first over the rows and then within a
    row.
    """
    side = 8 if count <= 16 else 4 if count <= 64 else 2
    # So many texels by as many are one here, which leaves 16 or 64 lights 128 each: they are no nearer to the parts
    # where they have more, and are found in a fifth of the time.
    height, width = level.shape[0] // side, level.shape[1] // side
    edges = np.arange(level.shape[0] + 1) / level.shape[0]
    cosines = np.cos(np.pi * np.clip((edges - MARGIN) / (1 - 2 * MARGIN), 0, 1))
    rows = (cosines[:-1] - cosines[1:]).reshape(height, 1, side)  # 0 beyond the poles
    fluxes = (rows @ level.reshape(height, side, -1)).reshape(height, width, side, 3).sum(axis=2)
    fluxes *= 2 * np.pi / level.shape[1]
    heights, cosines = rows.sum(axis=(1, 2)), cosines[::side]
    solid_angles = np.repeat(heights * (2 * np.pi / width), width).reshape(height, width)
    luminance = fluxes @ LUMINANCE / np.maximum(solid_angles, 1e-300)
    mean = heights @ luminance.mean(axis=1) / heights.sum()
    density = ((1 - UNIFORM_FRACTION) * luminance + UNIFORM_FRACTION * mean) if mean > 0 else np.ones_like(luminance)
    _, row, rest = _warp((heights * density.mean(axis=1))[None], np.zeros(count, int), (np.arange(count) + 0.5) / count)
    x, _, _ = _warp(density, row, (np.arange(count) + 0.5) * _GOLDEN % 1)
    directions = _directions(cosines[row] - rest * heights[row], x / width)

    texels = _directions((0.5 * (cosines[:-1] + cosines[1:]))[:, None], (np.arange(width) + 0.5) / width)
    weighted = (solid_angles * density)[..., None] * texels
    for _ in range(_ROUNDS):
        sums = _sums(weighted, _nearest(texels, directions), count)
        lengths = np.linalg.norm(sums, axis=1, keepdims=True)
        directions = np.where(lengths > 0, sums / np.maximum(lengths, 1e-300), directions)
    nearest = _nearest(texels, directions)
    return ManyLights(directions, _sums(fluxes, nearest, count),
                      _sums(solid_angles[..., None], nearest, count)[:, 0])


def _directions(cosine: np.ndarray, u: np.ndarray) -> np.ndarray:
    """Unit vectors (..., 3) by the cosine of the angle from +Y, and by the column in the map, 0 to 1."""
    sine, phi = np.sqrt(np.maximum(1 - cosine**2, 0)), 2 * np.pi * (u - 0.5)
    return np.stack(np.broadcast_arrays(sine * np.cos(phi), cosine, sine * np.sin(phi)), axis=-1)


def _nearest(texels: np.ndarray, directions: np.ndarray) -> np.ndarray:
    """The number of the light that is nearest to each of the texels, (H, W)."""
    to_lights = directions.T.astype(np.float32)
    return np.stack([np.argmax(row @ to_lights, axis=1) for row in texels.astype(np.float32)])


def _sums(values: np.ndarray, nearest: np.ndarray, count: int) -> np.ndarray:
    """The sums of the values (H, W, K) of each light's texels, (count, K)."""
    return np.stack([np.bincount(nearest.ravel(), channel.ravel(), count) for channel in np.moveaxis(values, -1, 0)],
                    axis=1)


def _warp(weights: np.ndarray, row: np.ndarray, u: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Inverts the cumulative distribution of the weights of `row` (N,) at `u` (N,) in (0, 1).

    Returns the position in cells, the cell, and the position within the cell in [0, 1], each (N,).
    """
    sums = np.cumsum(weights, axis=1)[row]
    target = u * sums[:, -1]
    cell = np.minimum((sums <= target[:, None]).sum(axis=1), weights.shape[1] - 1)
    part = 1 - (sums[np.arange(len(u)), cell] - target) / np.maximum(weights[row, cell], 1e-300)
    part = np.clip(part, 0, 1)
    return cell + part, cell, part
