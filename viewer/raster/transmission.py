"""The picture behind transmissive surfaces, in screen space: it has what was drawn before them (walls.py)."""

from __future__ import annotations

import ctypes

import moderngl
import numpy as np

from ..gpu.context import Context
from ..gpu.fullscreen import fullscreen
from ..gpu.mipmaps import mipmapped_texture
from ..gpu.programs import Programs, set_uniform
from .target import Target

_TEXTURE_2D, _TEXTURE_BASE_LEVEL, _TEXTURE_MAX_LEVEL = 0x0DE1, 0x813C, 0x813D
_FRAMEBUFFER, _COLOR_ATTACHMENT = 0x8D40, 0x8CE0


class Backdrop:
    """A copy of a target's radiance with mip levels for rough surfaces, filtered by a binomial, close to a Gaussian."""

    def __init__(self, context: Context, target: Target) -> None:
        self._gl, self._size, self._half = context.gl, target.size, target.half
        width, height = target.size
        count = max(width, height).bit_length()
        self._sizes = [(max(width >> k, 1), max(height >> k, 1)) for k in range(count)]
        dtype = np.float16 if target.half else np.float32
        self._texture = mipmapped_texture(context, [np.zeros((h, w, 4), dtype) for w, h in self._sizes])
        self._texture.repeat_x = self._texture.repeat_y = False
        self._framebuffer = context.gl.framebuffer([self._texture])
        self._framebuffer.viewport = 0, 0, *target.size
        integer = ctypes.c_int
        self._set_parameter = context.function("glTexParameteri", integer, integer, integer)
        self._attach = context.function("glFramebufferTexture2D", *[integer] * 5)

    def fits(self, target: Target) -> bool:
        return (self._size, self._half) == (target.size, target.half)

    def take(self, programs: Programs, target: Target, unit: int) -> dict[str, object]:
        """Copy what `target` has so far and filter it, within `Depth.test()`; uses texture `unit`. Returns the uniforms
        of shaders/raster/transmission.glsl.

        Leaves a framebuffer of its own in use.
        """
        target.so_far(programs, unit, self._framebuffer)
        self._framebuffer.scissor = None
        self._framebuffer.use()
        self._gl.enable_only(moderngl.NOTHING)
        # We draw into level k and read level k - 1: allowed if k - 1 is the only level that can be read.
        self._texture.filter = moderngl.LINEAR, moderngl.LINEAR
        self._texture.use(unit)
        program = programs.get("display/fullscreen.vert", "raster/backdrop.frag", {"LEVEL": 1})
        set_uniform(program, "u_source", unit)
        for level, size in enumerate(self._sizes[1:], 1):
            self._show_levels(level - 1, level)
            self._attach(_FRAMEBUFFER, _COLOR_ATTACHMENT, _TEXTURE_2D, self._texture.glo, level)
            self._gl.viewport = 0, 0, *size
            fullscreen(self._gl, program).render(vertices=3)
        self._attach(_FRAMEBUFFER, _COLOR_ATTACHMENT, _TEXTURE_2D, self._texture.glo, 0)
        self._gl.viewport = 0, 0, *self._size
        self._show_levels(0, len(self._sizes) - 1)
        self._texture.filter = moderngl.LINEAR_MIPMAP_LINEAR, moderngl.LINEAR
        return {"u_backdrop": unit}

    def _show_levels(self, first: int, last: int) -> None:
        """Set the readable levels of the texture, which is bound to the active unit."""
        self._set_parameter(_TEXTURE_2D, _TEXTURE_BASE_LEVEL, first)
        self._set_parameter(_TEXTURE_2D, _TEXTURE_MAX_LEVEL, last)

    def release(self) -> None:
        self._framebuffer.release()
        self._texture.release()
