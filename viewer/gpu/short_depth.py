"""Depth textures of 16 bits. They take half the memory of moderngl's, whose 24 bits lie in words of 32, and Mesa's
software rasteriser copies them as they are."""

from __future__ import annotations

import ctypes

import moderngl
import numpy as np

from .context import Context

_TEXTURE_2D, _TEXTURE_MAX_LEVEL = 0x0DE1, 0x813D
_DEPTH_COMPONENT16, _DEPTH_COMPONENT, _UNSIGNED_SHORT = 0x81A5, 0x1902, 0x1403
_UNPACK_ALIGNMENT, _PACK_ALIGNMENT = 0x0CF5, 0x0D05


def short_depth_texture(context: Context, size: tuple[int, int]) -> moderngl.Texture:
    """A depth texture of `size`, with any depths in it. moderngl reports its size as 1x1, since the memory is allocated
    without moderngl."""
    texture = context.gl.depth_texture((1, 1))
    texture.use(context.gl.default_texture_unit)
    integer = ctypes.c_int
    context.function("glTexParameteri", integer, integer, integer)(_TEXTURE_2D, _TEXTURE_MAX_LEVEL, 0)
    context.function("glTexImage2D", *[integer] * 8, ctypes.c_void_p)(
        _TEXTURE_2D, 0, _DEPTH_COMPONENT16, *size, 0, _DEPTH_COMPONENT, _UNSIGNED_SHORT, None)
    return texture


def write_depths(context: Context, texture: moderngl.Texture, depths: np.ndarray) -> None:
    """Write all depths of such a texture, (H, W) uint16, row by row from the bottom."""
    height, width = depths.shape
    texture.use(context.gl.default_texture_unit)
    integer = ctypes.c_int
    context.function("glPixelStorei", integer, integer)(_UNPACK_ALIGNMENT, 1)
    context.function("glTexSubImage2D", *[integer] * 8, ctypes.c_void_p)(
        _TEXTURE_2D, 0, 0, 0, width, height, _DEPTH_COMPONENT, _UNSIGNED_SHORT, depths.ctypes.data)


def read_depths(context: Context, texture: moderngl.Texture, size: tuple[int, int]) -> np.ndarray:
    """The depths of such a texture, as `write_depths` takes them."""
    depths = np.empty(size[::-1], np.uint16)
    texture.use(context.gl.default_texture_unit)
    integer = ctypes.c_int
    context.function("glPixelStorei", integer, integer)(_PACK_ALIGNMENT, 1)
    context.function("glGetTexImage", *[integer] * 4, ctypes.c_void_p)(
        _TEXTURE_2D, 0, _DEPTH_COMPONENT, _UNSIGNED_SHORT, depths.ctypes.data)
    return depths
