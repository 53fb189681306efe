"""The geometry of equirectangular maps: which direction a texel looks in, and how much of the sphere it holds.

Texel (row i, column j) of an (H, W) map is centred on theta = pi (i + 1/2) / H from +Y and
phi = 2 pi ((j + 1/2) / W - 1/2) = atan2(z, x); it holds the solid angle between its edges.
"""

from __future__ import annotations

import numpy as np


def texel_solid_angles(height: int, width: int) -> np.ndarray:
    """Steradians of one texel of each row, (H,) float64; they add up to 4 pi over the map."""
    edges = np.cos(np.pi * np.arange(height + 1) / height)
    return (edges[:-1] - edges[1:]) * (2 * np.pi / width)


def texel_directions(height: int, width: int, rows: slice = slice(None)) -> np.ndarray:
    """Unit vectors through the texel centres, (H, W, 3) float64, or of some rows only."""
    theta = (np.pi * (np.arange(height) + 0.5) / height)[rows, None]
    phi = 2 * np.pi * ((np.arange(width) + 0.5) / width - 0.5)
    return np.stack([np.sin(theta) * np.cos(phi), np.cos(theta) + 0 * phi, np.sin(theta) * np.sin(phi)], axis=-1)


def sphere_integral(radiance: np.ndarray) -> np.ndarray:
    """The integral over the sphere of an (H, W, C) map, (C,) float64."""
    height, width = radiance.shape[:2]
    # Rows in float64 by way of their means: a float32 sum over a whole map would lose the dark under a sun.
    return width * (texel_solid_angles(height, width) @ radiance.mean(axis=1, dtype=np.float64))


def shrink(radiance: np.ndarray, height: int, width: int) -> np.ndarray:
    """Means over square blocks of texels, weighted by solid angle, that stay at least (height, width); the map itself
    where no whole factor does that."""
    old_height, old_width, channels = radiance.shape
    factor = min(old_height // height, old_width // width)
    if factor <= 1 or old_height % factor or old_width % factor:
        return radiance
    weights = texel_solid_angles(old_height, 1).reshape(-1, factor)
    weights = (weights / weights.sum(axis=1, keepdims=True)).astype(np.float32)
    blocks = radiance.reshape(old_height // factor, factor, old_width, channels)
    rows = sum(blocks[:, k] * weights[:, k, None, None] for k in range(factor))
    return rows.reshape(len(rows), old_width // factor, factor, channels).mean(axis=2)


def resample(radiance: np.ndarray, height: int, width: int) -> np.ndarray:
    """The map at another size: areas are averaged where it shrinks, texels interpolated where it grows."""
    radiance = shrink(radiance, height, width)
    old_height, old_width = radiance.shape[:2]
    if height != old_height:
        rows = _axis_weights(_colatitude_edges(old_height), _colatitude_edges(height), wraps=False)
        radiance = np.tensordot(rows, radiance, axes=(1, 0))
    if width != old_width:
        columns = _axis_weights(np.linspace(0, 1, old_width + 1), np.linspace(0, 1, width + 1), wraps=True)
        radiance = np.ascontiguousarray(np.tensordot(columns, radiance, axes=(1, 1)).swapaxes(0, 1))
    return radiance


def _colatitude_edges(rows: int) -> np.ndarray:
    """Where rows begin and end, in the measure -cos(theta) in which equal steps are equal solid angles."""
    return -np.cos(np.pi * np.arange(rows + 1) / rows)


def _axis_weights(theirs: np.ndarray, ours: np.ndarray, wraps: bool) -> np.ndarray:
    """(new, old) float32: each new texel as a mean of old ones, given the old and the new texels' edges."""
    old, new = len(theirs) - 1, len(ours) - 1
    if new < old:
        overlap = np.minimum(ours[1:, None], theirs[1:]) - np.maximum(ours[:-1, None], theirs[:-1])
        overlap = np.maximum(overlap, 0)
        return (overlap / overlap.sum(axis=1, keepdims=True)).astype(np.float32)
    position = (np.arange(new) + 0.5) * old / new - 0.5
    low = np.floor(position).astype(int)
    part = position - low
    pair = np.stack([low, low + 1]) % old if wraps else np.clip([low, low + 1], 0, old - 1)
    weights = np.zeros((new, old), np.float32)
    np.add.at(weights, (np.arange(new), pair[0]), 1 - part)
    np.add.at(weights, (np.arange(new), pair[1]), part)
    return weights
