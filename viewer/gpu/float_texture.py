"""Tables of floats as textures."""

from __future__ import annotations

import moderngl
import numpy as np


def float_texture(gl: moderngl.Context, pixels: np.ndarray) -> moderngl.Texture:
    """(H, W, C) float16 or float32 `pixels` as a texture: bilinear, clamped, row 0 at v = 0."""
    height, width, components = pixels.shape
    data, dtype = np.ascontiguousarray(pixels), f"f{pixels.itemsize}"
    texture = gl.texture((width, height), components, data, dtype=dtype, alignment=1)
    texture.filter = (moderngl.LINEAR, moderngl.LINEAR)
    texture.repeat_x = texture.repeat_y = False
    return texture
