"""A texture of single floats to draw into."""

from __future__ import annotations

import moderngl


def float_target(gl: moderngl.Context, size: tuple[int, int]) -> moderngl.Texture:
    """An RGBA32F texture to draw into and to read texel by texel."""
    texture = gl.texture(size, 4, dtype="f4")
    texture.filter = moderngl.NEAREST, moderngl.NEAREST
    return texture
