"""An environment as rough surfaces see it: a mip chain whose level k is the map filtered for one roughness.

The levels are equirectangular, 1024 x 512 down to 32 x 16, with a margin: theta runs from -pi/30 at the top edge to
pi + pi/30 at the bottom, v = 1/32 + (15/16) theta / pi, in every level alike. Rows beyond a pole hold what lies
across it, so that bilinear lookups pass over the poles like anywhere else (row 0 of the last level *is* the pole).
"""

from __future__ import annotations

import numpy as np

from ..scene.equirect import resample, sphere_integral
from .irradiance import HEIGHT as irradiance_rows
from .irradiance import irradiance_filter
from .lobes import lobe_spectrum
from .spherical_convolution import Filter, convolve

WIDTH, HEIGHT = 1024, 512
MARGIN = 1 / 32  # of the height, above and below

# The perceptual roughness each level is filtered for. Level 1 is as sharp as degree 255 can carry (lambda_255 < 0.002
# of GGX); the others are spaced so that blending two neighbours errs about equally everywhere in between.
LEVEL_ROUGHNESS = (0.0, 0.12, 0.22, 0.36, 0.58, 1.0)


def prefilter(
    radiance: np.ndarray, ndf: str = "ggx", height: int = HEIGHT
) -> tuple[list[np.ndarray], np.ndarray]:
    """The levels, (512, 1024, 3) to (16, 32, 3) float32, and irradiance / pi, (64, 128, 3), with the same margin.

    Of another `height`, the first level's rows, all levels are as much larger or smaller.

    `radiance` is (H, W, 3), finite, not negative. Level 0 is the map itself. Every level holds the map's energy: the
    integral over the sphere of what a bilinear lookup sees is the map's, per channel.
    """
    energy = sphere_integral(radiance)
    source = resample(radiance, height, 2 * height)
    filters = [Filter(row_angles(height >> k)[:height >> (k + 1)],
                      lobe_spectrum(ndf, r * r, (height >> k) - 1)[:256])
               for k, r in enumerate(LEVEL_ROUGHNESS) if k]
    *filtered, irradiance = convolve(source, [*filters, irradiance_filter(row_angles(irradiance_rows))])
    levels = [_with_margin(source)] + filtered
    return [_with_energy(level, energy) for level in levels], _with_energy(irradiance, energy)


def irradiance_map(radiance: np.ndarray, rows: int = irradiance_rows) -> np.ndarray:
    """What `prefilter` gives beside the levels, without their cost, or a map of other `rows`."""
    [irradiance] = convolve(resample(radiance, HEIGHT, WIDTH), [irradiance_filter(row_angles(rows))])
    return _with_energy(irradiance, sphere_integral(radiance))


def row_angles(height: int) -> np.ndarray:
    """theta at the centres of a level's rows, (height,) float64, from beyond one pole to beyond the other."""
    return np.pi * ((np.arange(height) + 0.5) / height - MARGIN) / (1 - 2 * MARGIN)


def level_integral(level: np.ndarray) -> np.ndarray:
    """The integral over the sphere of a level as bilinear lookups see it, (3,) float64."""
    return 2 * np.pi * (_row_measures(len(level)) @ level.mean(axis=1, dtype=np.float64))


def _row_measures(height: int) -> np.ndarray:
    """The integral of each row's hat function times sin(theta) over 0..pi, (height,) float64; they add up to 2.

    Hats reach over one row spacing h to both sides; with F = -cos, the integral of a piece (theta - a) sin(theta) is
    [-(theta - a) cos(theta) + sin(theta)], cut off at the poles.
    """
    theta, h = row_angles(height), np.pi / (height * (1 - 2 * MARGIN))

    def ramp(a: np.ndarray, low: np.ndarray, high: np.ndarray) -> np.ndarray:
        low, high = np.clip(low, 0, np.pi), np.clip(high, 0, np.pi)
        return (np.sin(high) - (high - a) * np.cos(high)) - (np.sin(low) - (low - a) * np.cos(low))

    return (ramp(theta - h, theta - h, theta) - ramp(theta + h, theta, theta + h)) / h


def _with_margin(radiance: np.ndarray) -> np.ndarray:
    """The map at a level's latitudes, by linear interpolation of its rows, across the poles where need be."""
    height = len(radiance)
    position = row_angles(height) / np.pi * height - 0.5
    low = np.floor(position).astype(int)
    part = (position - low).astype(np.float32)[:, None, None]
    level = _rows_across_poles(radiance, low)
    level *= 1 - part
    level += part * _rows_across_poles(radiance, low + 1)
    return level


def _rows_across_poles(radiance: np.ndarray, rows: np.ndarray) -> np.ndarray:
    """A copy of the rows of these numbers; those outside 0 .. H-1 are reflected at the pole and turned half around."""
    height, width = radiance.shape[:2]
    beyond = (rows < 0) | (rows >= height)
    taken = radiance[np.where(rows < 0, -1 - rows, np.where(rows >= height, 2 * height - 1 - rows, rows))]
    taken[beyond] = np.roll(taken[beyond], width // 2, axis=1)
    return taken


def _with_energy(level: np.ndarray, energy: np.ndarray) -> np.ndarray:
    """In place: without the small negative values a cut-off spectrum leaves, and scaled to integrate to `energy`."""
    np.maximum(level, 0, out=level)
    found = level_integral(level)
    level *= np.divide(energy, found, out=np.ones(3), where=found > 0).astype(np.float32)
    return level
