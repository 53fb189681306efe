"""Uploads arrays of records as textures, for shaders that read them by index."""

from __future__ import annotations

import moderngl
import numpy as np

from ..errors import ViewerError

_WIDTH = 4096
_DTYPES = {"uint8": "f1", "float16": "f2", "float32": "f4", "int32": "i4", "uint32": "u4"}


def row_texture(gl: moderngl.Context, texels: np.ndarray, too_many: ViewerError) -> moderngl.Texture:
    """A texture that holds (N, C) `texels` row by row: texel i is at (i % width, i / width).

    A row has 4096 texels, or more if `texels` need it. Shaders read uint8 as [0, 1]. Raises the exception `too_many` if
    the texels exceed OpenGL's maximum texture size.
    """
    limit = gl.info["GL_MAX_TEXTURE_SIZE"]
    width = min(_WIDTH, limit)
    while len(texels) > width * limit and width < limit:
        width *= 2
    height = max(-(-len(texels) // width), 1)
    if height > limit:
        raise too_many
    texture = gl.texture((width, height), texels.shape[1], dtype=_DTYPES[texels.dtype.name], alignment=1)
    texture.filter = moderngl.NEAREST, moderngl.NEAREST
    whole = len(texels) // width
    for first, rows in ((0, whole), (whole, 1)):  # the last row may not be full
        part = np.ascontiguousarray(texels[first * width:(first + rows) * width])
        if len(part):
            texture.write(part, viewport=(0, first, len(part) // rows, rows), alignment=1)
    return texture
