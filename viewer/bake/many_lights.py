"""Approximates an environment by directional lights, whose directions are importance-sampled from it.

Agarwal et al. 2003, "Structured Importance Sampling of Environment Maps".
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
_GOLDEN = (np.sqrt(5) - 1) / 2


@dataclass(frozen=True, eq=False)
class ManyLights:
    directions: np.ndarray
    """Unit vectors to the lights, (N, 3) float64, without the environment's rotation."""
    irradiance: np.ndarray
    """The irradiance of a surface that faces the light, (N, 3) float64: radiance / (probability density * N)."""
    solid_angles: np.ndarray
    """That of the sphere which each light stands for, (N,) float64: 1 / (probability density * N)."""


def uniform_lights(count: int, radiance: ArrayLike) -> ManyLights:
    """`count` lights in place of a constant radiance (3,) from everywhere, on a golden spiral."""
    height = 1 - (2 * np.arange(count) + 1) / count
    turn, width = 2 * np.pi * _GOLDEN * np.arange(count), np.sqrt(1 - height**2)
    directions = np.stack([width * np.cos(turn), height, width * np.sin(turn)], axis=1)
    solid_angles = np.full(count, 4 * np.pi / count)
    return ManyLights(directions, solid_angles[:, None] * np.asarray(radiance, np.float64), solid_angles)


def many_lights(level: np.ndarray, count: int) -> ManyLights:
    """`count` lights sampled from a level of an environment's mip chain (H, W, 3), which has a margin at the poles.

    The sampling is deterministic: a golden-ratio lattice is warped by the map's luminance, first over the rows and then
    within a row.
    """
    height, width = level.shape[:2]
    radiance = level.astype(np.float64)
    edges = np.pi * np.clip((np.arange(height + 1) / height - MARGIN) / (1 - 2 * MARGIN), 0, 1)
    heights = np.cos(edges[:-1]) - np.cos(edges[1:])  # 0 for rows beyond the poles
    luminance = radiance @ LUMINANCE
    mean = heights @ luminance.mean(axis=1) / heights.sum()
    density = ((1 - UNIFORM_FRACTION) * luminance + UNIFORM_FRACTION * mean) if mean > 0 else np.ones_like(luminance)
    rows = heights * density.mean(axis=1)
    _, row, rest = _warp(rows[None], np.zeros(count, int), (np.arange(count) + 0.5) / count)
    x, column, _ = _warp(density, row, (np.arange(count) + 0.5) * _GOLDEN % 1)
    cos_theta = np.cos(edges[row]) - rest * heights[row]
    sin_theta = np.sqrt(np.maximum(1 - cos_theta**2, 0))
    phi = 2 * np.pi * (x / width - 0.5)
    directions = np.stack([sin_theta * np.cos(phi), cos_theta, sin_theta * np.sin(phi)], axis=1)
    pdf = density[row, column] / (2 * np.pi * rows.sum())
    return ManyLights(directions, radiance[row, column] / (pdf * count)[:, None], 1 / (pdf * count))


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
