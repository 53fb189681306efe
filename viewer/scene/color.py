"""Luminance of Rec. 709 light and the exact sRGB transfer function (IEC 61966-2-1:1999), in float64."""

from __future__ import annotations

import numpy as np

LUMINANCE = np.array([0.2126, 0.7152, 0.0722])
"""The luminance weights of linear Rec. 709 red, green and blue."""


def srgb_to_linear(encoded: np.ndarray) -> np.ndarray:
    """Displayed values in [0, 1] to linear ones, of any shape."""
    encoded = np.asarray(encoded, np.float64)
    return np.where(encoded <= 0.04045, encoded / 12.92, ((np.maximum(encoded, 0.04045) + 0.055) / 1.055) ** 2.4)


def linear_to_srgb(linear: np.ndarray) -> np.ndarray:
    """Linear values in [0, 1] to displayed ones, of any shape."""
    linear = np.asarray(linear, np.float64)
    return np.where(linear <= 0.0031308, linear * 12.92, 1.055 * np.maximum(linear, 0.0031308) ** (1 / 2.4) - 0.055)
