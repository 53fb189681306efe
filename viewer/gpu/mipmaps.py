"""Uploads textures with all their mip levels. moderngl can only let OpenGL generate the levels.

Mesa's software rasteriser compiles a program to generate them, for each format and again in each process (50 to
100 ms). OpenGL also does not define how levels of odd sizes are filtered, so drivers differ.
"""

from __future__ import annotations

import ctypes
from collections.abc import Sequence

import moderngl
import numpy as np

from .context import Context

_TEXTURE_2D, _UNPACK_ALIGNMENT, _TEXTURE_MAX_LEVEL = 0x0DE1, 0x0CF5, 0x813D
_FORMATS = (0x1903, 0x8227, 0x1907, 0x1908)  # RED, RG, RGB, RGBA
# For each numpy type: moderngl's name, OpenGL's type, and the internal formats of one to four components.
_TYPES = {
    "uint8": ("f1", 0x1401, (0x8229, 0x822B, 0x8051, 0x8058)),
    "uint16": ("nu2", 0x1403, (0x822A, 0x822C, 0x8054, 0x805B)),
    "float16": ("f2", 0x140B, (0x822D, 0x822F, 0x881B, 0x881A)),
    "float32": ("f4", 0x1406, (0x822E, 0x8230, 0x8815, 0x8814)),
}
_SRGB_FORMATS = {3: 0x8C41, 4: 0x8C43}


def mipmapped_texture(context: Context, levels: Sequence[np.ndarray], srgb: bool = False) -> moderngl.Texture:
    """A texture of `levels`, (H, W, C) arrays of one type, each half the size (rounded down) of the one before.

    Shaders read uint8 and uint16 as [0, 1]; with `srgb` they read uint8 of 3 or 4 components as sRGB colours, decoded.
    They read float16 and float32 unchanged. Levels larger than the driver's largest texture are left out. Row 0 is at
    v = 0. The texture is trilinear and repeats, until the caller changes that. moderngl reports its size as 1x1, since
    the levels are uploaded without moderngl.
    """
    limit = context.gl.info["GL_MAX_TEXTURE_SIZE"]
    levels = [level for level in levels if max(level.shape[:2]) <= limit] or levels[-1:]
    components = levels[0].shape[2]
    dtype, type_, internal_formats = _TYPES[levels[0].dtype.name]
    internal_format = _SRGB_FORMATS[components] if srgb else internal_formats[components - 1]
    texture = context.gl.texture((1, 1), components, dtype=dtype, internal_format=internal_format)
    # Set the filter before the first level: otherwise Mesa allocates only that level and has to copy it later.
    texture.filter = (moderngl.LINEAR_MIPMAP_LINEAR, moderngl.LINEAR)
    texture.use(context.gl.default_texture_unit)
    integer, pointer = ctypes.c_int, ctypes.c_void_p
    set_parameter = context.function("glTexParameteri", integer, integer, integer)
    set_image = context.function("glTexImage2D", *[integer] * 8, pointer)
    set_parameter(_TEXTURE_2D, _TEXTURE_MAX_LEVEL, len(levels) - 1)
    context.function("glPixelStorei", integer, integer)(_UNPACK_ALIGNMENT, 1)
    for number, level in enumerate(levels):
        height, width = level.shape[:2]
        pixels = np.ascontiguousarray(level)
        set_image(_TEXTURE_2D, number, internal_format, width, height, 0, _FORMATS[components - 1], type_,
                  pixels.ctypes.data)
    return texture
