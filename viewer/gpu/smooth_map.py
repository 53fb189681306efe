"""Maps that shaders look up by B-splines (shaders/light/bspline.glsl).

A lookup takes 4 x 4 texels. Mesa's software rasteriser fetches an element of a buffer in a quarter of the time of a
filtered lookup of a texture, so a map is a buffer of pairs of neighbours, and a lookup eight of its elements. Paths,
whose pictures are what others are compared with, have a buffer of texels as they are, and a lookup is sixteen of them.
"""

from __future__ import annotations

import moderngl
import numpy as np

from .buffer_texture import BufferTexture, most_texels
from .context import Context
from .programs import set_uniform

_MARGIN = 2
"""Texels beyond each side that a lookup may reach."""
_BAND = 16  # rows per step, so that intermediate arrays stay in the processor's cache
_HALF = 0x1000  # of the last bit that is kept of a float32


class SmoothMap:
    """(H, W, 3) float `pixels`, none below 0, which go on across the left and the right side; beyond the first and the
    last row these are repeated. Their relative error is at most 2^-11, and what is less than 2^-62 of the largest is 0,
    unless the map `is_exact`: it is for shaders with EXACT_TEXELS then.
    """

    def __init__(self, context: Context, pixels: np.ndarray, is_exact: bool = False) -> None:
        texels, unit = (exact_texels(pixels), 1.0) if is_exact else texel_pairs(pixels)
        self._shape = pixels.shape[1], pixels.shape[0], unit
        self._texels = BufferTexture(context, texels.reshape(-1, 4))

    def bind(self, program: moderngl.Program, name: str, unit: int) -> None:
        """Bind it to a texture unit, from which `program` reads it by this name."""
        self._texels.bind(program, name, unit)
        set_uniform(program, f"{name}_shape", self._shape)

    def use(self, unit: int) -> None:
        """Bind it to a texture unit."""
        self._texels.use(unit)

    def release(self) -> None:
        self._texels.release()


def can_be_smooth(context: Context, pixels: np.ndarray) -> bool:
    """Whether a buffer can have the texels of this map."""
    return _fits(context, *pixels.shape[:2])


def most_smooth_rows(context: Context) -> int:
    """The most rows, a power of two, of a map twice as wide as high whose texels a buffer can have."""
    rows = 1
    while _fits(context, 2 * rows, 4 * rows):
        rows *= 2
    return rows


def _fits(context: Context, height: int, width: int) -> bool:
    return (height + 2 * _MARGIN) * (width + 2 * _MARGIN) <= most_texels(context)


def exact_texels(pixels: np.ndarray) -> np.ndarray:
    """The texels of (H, W, 3) and _MARGIN beyond each side, (H + 4, W + 4, 4) float32."""
    margin = _MARGIN, _MARGIN
    rows = np.pad(np.asarray(pixels, np.float32), (margin, (0, 0), (0, 1)), mode="edge")
    return np.pad(rows, ((0, 0), margin, (0, 0)), mode="wrap")


def texel_pairs(pixels: np.ndarray) -> tuple[np.ndarray, float]:
    """Each texel of (H, W, 3) with its right neighbour, (H + 4, W + 3, 4) uint32, and their unit.

    Red is 0, green 1, blue 2, the neighbour in the upper half. The first pair is that of row -2 and column -2.

    A number has 6 bits of exponent, 10 of mantissa and no sign: the bits 13 to 28 of a float32, in a unit, a power of
    two, in which the exponent of the largest number has 6 bits. So a shift decodes it.
    """
    height, width = pixels.shape[:2]
    peak = int(np.float32(pixels.max()).view(np.int32)) + _HALF
    exponent = max((peak >> 23) - 63, 0)
    columns = np.arange(-_MARGIN, width + _MARGIN) % width
    pairs = np.zeros((height + 2 * _MARGIN, width + 2 * _MARGIN - 1, 4), np.uint32)
    for row in range(0, height, _BAND):
        codes = np.abs(pixels[row:row + _BAND], dtype=np.float32).view(np.int32)  # without the sign of -0
        codes -= (exponent << 23) - _HALF
        codes = np.maximum(codes, 0, out=codes).take(columns, axis=1) >> 13
        pairs[row + _MARGIN:row + _MARGIN + len(codes), :, :3] = codes[:, 1:] << 16 | codes[:, :-1]
    pairs[:_MARGIN], pairs[-_MARGIN:] = pairs[_MARGIN], pairs[-_MARGIN - 1]
    return pairs, 2.0**exponent
