"""An environment as directional lights: directions drawn from it by importance, which add up to it.

Agarwal et al. 2003, "Structured Importance Sampling of Environment Maps".
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..scene.color import LUMINANCE
from .prefilter import MARGIN

EVEN = 0.3
"""Share of the lights spread evenly over the sphere: surfaces that see only the map's dark side need some, too."""
_GOLDEN = (np.sqrt(5) - 1) / 2


@dataclass(frozen=True, eq=False)
class ManyLights:
    directions: np.ndarray
    """To the lights, (N, 3) float64, unit length, before the environment's rotation."""
    irradiance: np.ndarray
    """Of a surface facing each, (N, 3) float64: the radiance over its density, over N."""


def many_lights(level: np.ndarray, count: int) -> ManyLights:
    """`count` lights from a level of an environment's mip chain (H, W, 3), with its margin.

    They are the same wherever they are asked for: a golden-ratio lattice warped by the map's luminance, first over its
    rows, then along each.
    """
    height, width = level.shape[:2]
    radiance = level.astype(np.float64)
    edges = np.pi * np.clip((np.arange(height + 1) / height - MARGIN) / (1 - 2 * MARGIN), 0, 1)
    heights = np.cos(edges[:-1]) - np.cos(edges[1:])  # none beyond the poles
    luminance = radiance @ LUMINANCE
    mean = heights @ luminance.mean(axis=1) / heights.sum()
    density = (1 - EVEN) * luminance + EVEN * mean if mean > 0 else np.ones_like(luminance)
    rows = heights * density.mean(axis=1)
    _, row, rest = _warp(rows[None], np.zeros(count, int), (np.arange(count) + 0.5) / count)
    x, column, _ = _warp(density, row, (np.arange(count) + 0.5) * _GOLDEN % 1)
    cos_theta = np.cos(edges[row]) - rest * heights[row]
    sin_theta = np.sqrt(np.maximum(1 - cos_theta**2, 0))
    phi = 2 * np.pi * (x / width - 0.5)
    directions = np.stack([sin_theta * np.cos(phi), cos_theta, sin_theta * np.sin(phi)], axis=1)
    pdf = density[row, column] / (2 * np.pi * rows.sum())
    return ManyLights(directions, radiance[row, column] / (pdf * count)[:, None])


def _warp(weights: np.ndarray, row: np.ndarray, u: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Where u in (0, 1) falls by the weights of `row`: the place in cells, the cell, and how far into it."""
    sums = np.cumsum(weights, axis=1)[row]
    target = u * sums[:, -1]
    cell = np.minimum((sums <= target[:, None]).sum(axis=1), weights.shape[1] - 1)
    part = 1 - (sums[np.arange(len(u)), cell] - target) / np.maximum(weights[row, cell], 1e-300)
    part = np.clip(part, 0, 1)
    return cell + part, cell, part
