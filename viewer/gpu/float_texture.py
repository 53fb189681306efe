"""Tables of floats as textures, and textures as arrays of floats."""

from __future__ import annotations

import moderngl
import numpy as np


def float_texture(gl: moderngl.Context, pixels: np.ndarray, *levels: np.ndarray) -> moderngl.Texture:
    """(H, W, C) float16 or float32 `pixels` as a texture: bilinear, clamped, row 0 at v = 0. `levels` are its mip
    levels from 1 on, each half as large as the one before; there may be anything in them."""
    height, width, components = pixels.shape
    data, dtype = np.ascontiguousarray(pixels), f"f{pixels.itemsize}"
    texture = gl.texture((width, height), components, data, dtype=dtype, alignment=1)
    if levels:
        texture.build_mipmaps(0, len(levels))
        for level, of_level in enumerate(levels, 1):
            texture.write(np.ascontiguousarray(of_level, pixels.dtype), level=level, alignment=1)
    texture.filter = (moderngl.LINEAR_MIPMAP_NEAREST if levels else moderngl.LINEAR, moderngl.LINEAR)
    texture.repeat_x = texture.repeat_y = False
    return texture


def read_texels(texture: moderngl.Texture) -> np.ndarray:
    """Those of a texture of four floats, (H, W, 4) float32, the lowest row first."""
    width, height = texture.size
    return np.frombuffer(texture.read(), np.float32).reshape(height, width, 4)
