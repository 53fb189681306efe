"""Rows of numbers about curves as a texture of floats."""

from __future__ import annotations

import moderngl
import numpy as np

from ..plan.curves import POINTS_WIDTH


def curve_texture(gl: moderngl.Context, rows: np.ndarray) -> moderngl.Texture:
    """`rows` (n, 4) as a texture that is POINTS_WIDTH wide."""
    height = max(-(-len(rows) // POINTS_WIDTH), 1)
    padded = np.zeros((height * POINTS_WIDTH, 4), np.float32)
    padded[:len(rows)] = rows
    texture = gl.texture((POINTS_WIDTH, height), 4, padded, dtype="f4")
    texture.filter = moderngl.NEAREST, moderngl.NEAREST
    return texture
