"""Prefilters an environment for rough reflections: each level of a mip chain is the map filtered for one roughness. The
last level is for a lobe that is wider than any of them; it is no part of the chain, which would make it too small.

The levels are equirectangular, 1024 x 512 down to 32 x 16, with a margin at the poles. In every level theta runs from
-pi/30 at the top edge to pi + pi/30 at the bottom: v = 1/32 + (15/16) theta / pi. Rows beyond a pole continue the map
on the other side of the pole, so bilinear lookups need no special case at the poles (row 0 of the smallest level is the
pole itself).
"""

from __future__ import annotations

import numpy as np

from ..scene.equirect import resample, sphere_integral
from .irradiance import HEIGHT as irradiance_rows
from .irradiance import irradiance_filter
from .lobes import grazing_spectrum, lobe_spectrum
from .spherical_convolution import Filter, convolve

WIDTH, HEIGHT = 1024, 512
MARGIN = 1 / 32  # of the height, above and below

# The perceptual roughness that each level is filtered for. Level 1 is as sharp as degree 255 can represent (for GGX
# lambda_255 < 0.002). The others are spaced so that blending two neighbours has about the same error everywhere.
LEVEL_ROUGHNESS = (0.0, 0.12, 0.22, 0.36, 0.58, 1.0)
LEVELS = len(LEVEL_ROUGHNESS) + 1
WIDEST_HEIGHT = irradiance_rows // 2  # rows of the last level, the mip level after the irradiance


def prefilter(
    radiance: np.ndarray, ndf: str = "ggx", height: int = HEIGHT
) -> tuple[list[np.ndarray], np.ndarray]:
    """The levels, (512, 1024, 3) to (16, 32, 3) and the last one, (32, 64, 3), and irradiance / pi, (64, 128, 3), all
    float32 with a margin.

    `height` is the number of rows of the first level; those of the chain scale with it. `radiance` is (H, W, 3), finite
    and not negative. Level 0 is the map itself. Every level conserves energy: the integral over the sphere of its
    bilinear interpolation equals the integral of the map, for each channel.
    """
    energy = sphere_integral(radiance)
    source = resample(radiance, height, 2 * height)
    filters = [Filter(row_angles(rows)[:rows // 2], level_spectrum(ndf, k, rows - 1)[:256])
               for k in range(1, LEVELS) for rows in [height >> k if k < LEVELS - 1 else WIDEST_HEIGHT]]
    *filtered, irradiance = convolve(source, [*filters, irradiance_filter(row_angles(irradiance_rows))])
    levels = [_with_margin(source)] + filtered
    return [_with_energy(level, energy) for level in levels], _with_energy(irradiance, energy)


def irradiance_map(radiance: np.ndarray, rows: int = irradiance_rows) -> np.ndarray:
    """irradiance / pi, (rows, 2 rows, 3) float32, as `prefilter` returns it, without computing the levels."""
    [irradiance] = convolve(resample(radiance, HEIGHT, WIDTH), [irradiance_filter(row_angles(rows))])
    return _with_energy(irradiance, sphere_integral(radiance))


def level_spectrum(ndf: str, level: int, degree: int) -> np.ndarray:
    """lambda_0 .. lambda_degree of the lobe that a level is filtered with, float64."""
    if level == LEVELS - 1:
        return grazing_spectrum(degree)
    return lobe_spectrum(ndf, LEVEL_ROUGHNESS[level] ** 2, degree) if level else np.ones(degree + 1)


def row_angles(height: int) -> np.ndarray:
    """theta in radians at the centres of a level's rows, (height,) float64, with the margins beyond the poles."""
    return np.pi * ((np.arange(height) + 0.5) / height - MARGIN) / (1 - 2 * MARGIN)


def level_integral(level: np.ndarray) -> np.ndarray:
    """The integral over the sphere of a level's bilinear interpolation, (3,) float64."""
    return 2 * np.pi * (_row_measures(len(level)) @ level.mean(axis=1, dtype=np.float64))


def level_of_roughness(perceptual_roughness: np.ndarray) -> np.ndarray:
    """The level of the mip chain to read for a perceptual roughness, as shaders/light/prefiltered.glsl chooses it."""
    alpha = perceptual_roughness**2
    x = alpha / (alpha + 0.4)
    scales = 28.777778, 13.663012, 7.311350, 4.714669, 3.883966
    offsets = 0.0, 0.474776, 0.789182, 1.153741, 1.774262
    return np.clip(np.multiply.outer(x, scales) - offsets, 0, 1).sum(axis=-1)


def _row_measures(height: int) -> np.ndarray:
    """The integral of each row's hat function times sin(theta) over 0..pi, (height,) float64. Their sum is 2.

    A hat function, the weight of a row in linear interpolation, extends by the row spacing h to both sides. The
    antiderivative of a piece (theta - a) sin(theta) is -(theta - a) cos(theta) + sin(theta), evaluated within 0..pi.
    """
    theta, h = row_angles(height), np.pi / (height * (1 - 2 * MARGIN))

    def ramp(a: np.ndarray, low: np.ndarray, high: np.ndarray) -> np.ndarray:
        low, high = np.clip(low, 0, np.pi), np.clip(high, 0, np.pi)
        return (np.sin(high) - (high - a) * np.cos(high)) - (np.sin(low) - (low - a) * np.cos(low))

    return (ramp(theta - h, theta - h, theta) - ramp(theta + h, theta, theta + h)) / h


def _with_margin(radiance: np.ndarray) -> np.ndarray:
    """The map at a level's latitudes, by linear interpolation of its rows, also across the poles."""
    height = len(radiance)
    position = row_angles(height) / np.pi * height - 0.5
    low = np.floor(position).astype(int)
    part = (position - low).astype(np.float32)[:, None, None]
    level = _rows_across_poles(radiance, low)
    level *= 1 - part
    level += part * _rows_across_poles(radiance, low + 1)
    return level


def _rows_across_poles(radiance: np.ndarray, rows: np.ndarray) -> np.ndarray:
    """A copy of the rows with these indices. A row outside 0 .. H-1 is mirrored at the pole and rotated by half a
    turn."""
    height, width = radiance.shape[:2]
    beyond = (rows < 0) | (rows >= height)
    taken = radiance[np.where(rows < 0, -1 - rows, np.where(rows >= height, 2 * height - 1 - rows, rows))]
    taken[beyond] = np.roll(taken[beyond], width // 2, axis=1)
    return taken


def _with_energy(level: np.ndarray, energy: np.ndarray) -> np.ndarray:
    """Removes the small negative values that a truncated spectrum causes, and scales the level to integrate to
    `energy`. Works in place."""
    np.maximum(level, 0, out=level)
    found = level_integral(level)
    level *= np.divide(energy, found, out=np.ones(3), where=found > 0).astype(np.float32)
    return level
