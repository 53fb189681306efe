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


def shrink(radiance: np.ndarray, factor: int) -> np.ndarray:
    """Means over blocks of factor x factor texels, weighted by solid angle; both sizes must divide by `factor`."""
    height, width, channels = radiance.shape
    if factor == 1:
        return radiance
    weights = texel_solid_angles(height, 1).reshape(-1, factor)
    weights = (weights / weights.sum(axis=1, keepdims=True)).astype(radiance.dtype)
    blocks = radiance.reshape(height // factor, factor, width // factor, factor, channels)
    return np.einsum("hawbc,ha->hwc", blocks, weights / radiance.dtype.type(factor), optimize=False)


def resample(radiance: np.ndarray, height: int, width: int) -> np.ndarray:
    """The map at another size: areas are averaged where it shrinks, texels interpolated where it grows."""
    if radiance.shape[:2] == (height, width):
        return radiance
    factor = min(radiance.shape[0] // height, radiance.shape[1] // width)
    if factor > 1 and radiance.shape[0] % factor == 0 and radiance.shape[1] % factor == 0:
        radiance = shrink(radiance, factor)
    old_height, old_width = radiance.shape[:2]
    if height != old_height:
        edges = (lambda n: -np.cos(np.pi * np.arange(n + 1) / n))
        rows = _axis_weights(old_height, height, edges, wraps=False)
        radiance = np.tensordot(rows, radiance, axes=(1, 0))
    if width != old_width:
        columns = _axis_weights(old_width, width, lambda n: np.arange(n + 1) / n, wraps=True)
        radiance = np.ascontiguousarray(np.tensordot(columns, radiance, axes=(1, 1)).swapaxes(0, 1))
    return radiance


def _axis_weights(old: int, new: int, edges, wraps: bool) -> np.ndarray:
    """(new, old) float32: each new texel as a mean of old ones. `edges(n)` are the n + 1 borders of n texels."""
    if new < old:
        ours, theirs = edges(new), edges(old)
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
