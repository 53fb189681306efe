"""The sRGB transfer function, exactly as IEC 61966-2-1 defines it (piecewise, not a 2.2 power)."""

from __future__ import annotations

import numpy as np


def srgb_to_linear(encoded) -> np.ndarray:
    """sRGB-encoded values (0..1, any shape) to linear light, float64."""
    encoded = np.asarray(encoded, np.float64)
    return np.where(encoded <= 0.04045, encoded / 12.92, ((np.maximum(encoded, 0.0) + 0.055) / 1.055) ** 2.4)


def linear_to_srgb(linear) -> np.ndarray:
    """Linear light (any shape) to sRGB-encoded values, float64; nothing is clipped."""
    linear = np.asarray(linear, np.float64)
    return np.where(linear <= 0.0031308, linear * 12.92, 1.055 * np.maximum(linear, 0.0) ** (1 / 2.4) - 0.055)
