"""The float64 twin of shaders/light/bspline.glsl."""

from __future__ import annotations

import numpy as np


def bspline(texels: np.ndarray, uv: np.ndarray) -> np.ndarray:
    """The uniform cubic B-spline through `texels` (H, W, C) at `uv` (N, 2), (N, C): the sum of 4 x 4 texels by de
    Boor's weights. It repeats in u, and its border continues in v."""
    height, width = texels.shape[:2]
    x, y = uv[:, 0] * width - 0.5, uv[:, 1] * height - 0.5
    out = np.zeros((len(uv), texels.shape[2]))
    for j in range(-1, 3):
        for i in range(-1, 3):
            columns, rows = np.floor(x).astype(int) + i, np.floor(y).astype(int) + j
            weight = _hat(x - columns) * _hat(y - rows)
            out += weight[:, None] * texels[np.clip(rows, 0, height - 1), columns % width]
    return out


def _hat(t: np.ndarray) -> np.ndarray:
    """The cubic B-spline about 0, which is 0 from -2 and 2 on."""
    t = np.abs(t)
    return np.where(t < 1, 2 / 3 - t**2 + t**3 / 2, np.maximum(2 - t, 0) ** 3 / 6)
