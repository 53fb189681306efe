"""Sums over the neighbourhood of each pixel, of pictures (H, W, C)."""

from __future__ import annotations

from typing import Literal

import numpy as np

from ..scene.color import LUMINANCE

EPSILON = 0.01
"""Of relMSE, added to the squared reference: the darkest pixels count by their absolute error of about a tenth."""
LARGEST = 1e15
"""Of radiance: float32 holds sums of the squares of this, but not of much more."""
_CENTRE = (6 / 16) ** 2
"""The weight of the pixel itself in `smooth`."""
REACH = 2
"""Energies are means over (2 REACH + 1)^2 pixels."""


def smooth(picture: np.ndarray, step: int) -> np.ndarray:
    """(H, W, C) convolved with the cubic B-spline (1 4 6 4 1) / 16, its taps `step` pixels apart, along both axes."""
    for axis in (0, 1):
        taps = _shifted(picture, axis, range(-2 * step, 2 * step + 1, step), "edge")
        picture = (6 * taps[2] + 4 * (taps[1] + taps[3]) + taps[0] + taps[4]) / 16
    return picture


def surroundings(picture: np.ndarray) -> np.ndarray:
    """What `smooth` makes of each pixel's neighbours alone, (H, W, C), without the pixel itself."""
    return (smooth(picture, 1) - _CENTRE * picture) / (1 - _CENTRE)


def box(picture: np.ndarray, reach: int = REACH) -> np.ndarray:
    """The means of (H, W, C) over squares of 2 reach + 1 pixels, of what lies inside of the picture.

    Sums of few terms, and not differences of cumulative sums: beside a sun these would lose what is dark.
    """
    for axis in (0, 1):
        total, *others = _shifted(picture, axis, range(-reach, reach + 1), "constant")
        total = total.copy()
        for other in others:
            total += other
        size = picture.shape[axis]
        place = np.arange(size)
        count = np.minimum(place + reach, size - 1) - np.maximum(place - reach, 0) + 1
        picture = total / count.astype(picture.dtype).reshape([-1 if k == axis else 1 for k in range(picture.ndim)])
    return picture


def _shifted(picture: np.ndarray, axis: int, offsets: range, mode: Literal["edge", "constant"]) -> list[np.ndarray]:
    """Views of the picture, moved along an axis; beyond its edge are its outermost pixels, or zeros."""
    size, most = picture.shape[axis], max(offsets)
    padded = np.pad(picture, [(most, most) if k == axis else (0, 0) for k in range(picture.ndim)], mode=mode)
    return [padded[(slice(None),) * axis + (slice(most + k, most + k + size),)] for k in offsets]


def luminance(picture: np.ndarray) -> np.ndarray:
    """(H, W, 1), of what is not negative."""
    return np.maximum(picture, 0) @ LUMINANCE.astype(picture.dtype)[:, None]
