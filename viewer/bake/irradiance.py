"""The environment as a Lambertian surface sees it: convolved with the clamped cosine.

A small map holds it to 0.4 % of the mean (0.08 % RMS). Spherical harmonics of degree 4 in its place are up to 8 % of
the mean off in a room lit by soft boxes, and their 18 coefficients cost a shader more than a lookup does.
"""

from __future__ import annotations

from math import comb

import numpy as np

from .spherical_convolution import Filter

HEIGHT = 64  # rows of the map, a margin of two beyond each pole among them


def cosine_spectrum(degree: int) -> np.ndarray:
    """lambda_0 .. lambda_degree of max(cos theta, 0) / pi (Ramamoorthi & Hanrahan 2001, eq. 8), float64.

    1, 2/3, and for even l = 2k: (-1)^(k-1) 2 C(2k, k) / (4^k (l + 2)(l - 1)); 0 for the other odd ones.
    """
    spectrum = np.zeros(degree + 1)
    spectrum[: min(2, degree + 1)] = (1.0, 2 / 3)[: degree + 1]
    for k in range(1, degree // 2 + 1):
        spectrum[2 * k] = (-1) ** (k - 1) * 2 * comb(2 * k, k) / 4**k / ((2 * k + 2) * (2 * k - 1))
    return spectrum


def irradiance_filter(theta: np.ndarray) -> Filter:
    """The filter whose map, at rows `theta` (both halves), is irradiance / pi."""
    return Filter(theta[: len(theta) // 2], cosine_spectrum(len(theta) - 1))
