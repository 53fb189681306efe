"""The geometry of equirectangular maps: the directions and solid angles of their texels, and resampling.

The centre of texel (row i, column j) of an (H, W) map has theta = pi (i + 1/2) / H, measured from +Y, and
phi = 2 pi ((j + 1/2) / W - 1/2) = atan2(z, x).
"""

from __future__ import annotations

import numpy as np


def texel_solid_angles(height: int, width: int) -> np.ndarray:
    """The solid angle of one texel of each row in steradians, (H,) float64. All texels together have 4 pi."""
    edges = np.cos(np.pi * np.arange(height + 1) / height)
    return (edges[:-1] - edges[1:]) * (2 * np.pi / width)


def texel_directions(height: int, width: int, rows: slice = slice(None)) -> np.ndarray:
    """Unit vectors through the texel centres, (H, W, 3) float64; `rows` selects some rows only."""
    theta = (np.pi * (np.arange(height) + 0.5) / height)[rows, None]
    phi = 2 * np.pi * ((np.arange(width) + 0.5) / width - 0.5)
    return np.stack([np.sin(theta) * np.cos(phi), np.cos(theta) + 0 * phi, np.sin(theta) * np.sin(phi)], axis=-1)


def sphere_integral(radiance: np.ndarray) -> np.ndarray:
    """The integral over the sphere of an (H, W, C) map, (C,) float64."""
    height, width = radiance.shape[:2]
    # Row means are computed in float64: a float32 sum over a map with a sun would round dark texels away.
    return width * (texel_solid_angles(height, width) @ radiance.mean(axis=1, dtype=np.float64))


def shrink(radiance: np.ndarray, height: int, width: int) -> np.ndarray:
    """The map reduced by a whole factor to at least (height, width), by means weighted by solid angle.

    If no whole factor divides both sides, the map itself is returned.
    """
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
    """The map at another size. An axis that shrinks is averaged by area; one that grows is interpolated linearly."""
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
    """The edges of the rows as -cos(theta), in which equal steps are equal solid angles, (rows + 1,)."""
    return -np.cos(np.pi * np.arange(rows + 1) / rows)


def _axis_weights(old_edges: np.ndarray, new_edges: np.ndarray, wraps: bool) -> np.ndarray:
    """(new, old) float32: the weights of the old texels in each new one, from the edges of the old and new texels."""
    old, new = len(old_edges) - 1, len(new_edges) - 1
    if new < old:
        overlap = np.minimum(new_edges[1:, None], old_edges[1:]) - np.maximum(new_edges[:-1, None], old_edges[:-1])
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
