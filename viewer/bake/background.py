"""The environment as the background shows it: the map itself, or the map blurred."""

from __future__ import annotations

import math

import numpy as np

from ..scene.equirect import resample
from .prefilter import HEIGHT
from .spherical_convolution import Filter, convolve

LEAST_BLUR = 0.5
"""In degrees. A narrower kernel is not resolved by HEIGHT rows."""
_TAIL = 11.5
"""Harmonics that the kernel scales by less than exp(-11.5) = 1e-5 are left out."""
PIXELS_OF_A_TEXEL = 2.0
"""From this many on, a map is looked up by B-splines. With fewer, nobody sees texels, and B-splines only blur."""


def background_map(radiance: np.ndarray) -> np.ndarray:
    """The map as float16, or as float32 if its values (a sun's) exceed the range of float16."""
    return radiance.astype(np.float16) if radiance.max() < 65504 else radiance


def blurred(radiance: np.ndarray, degrees: float, most_rows: int = HEIGHT) -> np.ndarray:
    """The map blurred by a Gaussian of that standard deviation, (h, 2h, 3) float32, with as many rows as it needs, but
    at most `most_rows`, a power of two.

    The Gaussian of the sphere is the heat kernel, which scales harmonics of degree l by exp(-l (l + 1) s^2 / 2); where
    s is small it is the plane's. It is positive and conserves energy. A blur below LEAST_BLUR is one of LEAST_BLUR, and
    with fewer rows than HEIGHT one of as many more degrees.
    """
    most_rows = min(most_rows, HEIGHT)
    variance = math.radians(max(degrees, LEAST_BLUR * HEIGHT / most_rows)) ** 2
    degree = min(math.ceil(math.sqrt(2 * _TAIL / variance)), HEIGHT - 1)
    height = min(1 << (2 * degree).bit_length(), most_rows)  # a texel is then at most a third of s, but for the least s
    orders = np.arange(degree + 1)
    theta = np.pi * (np.arange(height // 2) + 0.5) / height
    source = resample(radiance, HEIGHT, 2 * HEIGHT)
    [out] = convolve(source, [Filter(theta, np.exp(-orders * (orders + 1) * variance / 2))])
    return np.maximum(out, 0)


def is_magnified(height: int, pixel_angle: float) -> bool:
    """Whether a texel of a map with `height` rows covers PIXELS_OF_A_TEXEL of `pixel_angle` radians."""
    return bool(pixel_angle * height * PIXELS_OF_A_TEXEL <= math.pi)
