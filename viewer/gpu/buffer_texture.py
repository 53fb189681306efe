"""Buffers that shaders read as an array of texels, by samplerBuffer or usamplerBuffer. They are read faster than
textures of rows are."""

from __future__ import annotations

import ctypes
from typing import Any

import moderngl
import numpy as np

from .context import Context

_TEXTURE_BUFFER, _TEXTURE0, _MAX_TEXELS = 0x8C2A, 0x84C0, 0x8C2B
_FORMATS = {"float32": 0x8814, "uint32": 0x8D70}  # GL_RGBA32F, GL_RGBA32UI


def most_texels(context: Context) -> int:
    """How many texels a buffer may have."""
    found = ctypes.c_int()
    context.function("glGetIntegerv", ctypes.c_uint, ctypes.c_void_p)(_MAX_TEXELS, ctypes.byref(found))
    return found.value


class BufferTexture:
    """(N, 4) float32 or uint32 `texels` in a buffer of their own; N > 0."""

    def __init__(self, context: Context, texels: np.ndarray) -> None:
        integer, pointer = ctypes.c_uint, ctypes.c_void_p
        self._active = context.function("glActiveTexture", integer)
        self._bind = context.function("glBindTexture", integer, integer)
        self._delete = context.function("glDeleteTextures", integer, pointer)
        self._buffer: moderngl.Buffer = context.gl.buffer(np.ascontiguousarray(texels))
        self._name = ctypes.c_uint()
        context.function("glGenTextures", integer, pointer)(1, ctypes.byref(self._name))
        self._use_program = context.function("glUseProgram", integer)
        self._set_uniform = context.function("glUniform1i", ctypes.c_int, ctypes.c_int)
        self.use(0)
        texel_format = _FORMATS[texels.dtype.name]
        context.function("glTexBuffer", integer, integer, integer)(_TEXTURE_BUFFER, texel_format, self._buffer.glo)

    def bind(self, program: moderngl.Program, sampler: str, unit: int) -> None:
        """Bind it to a texture unit, from which `program` reads it by this name."""
        self.use(unit)
        self.set_sampler(program, sampler, unit)

    def set_sampler(self, program: moderngl.Program, sampler: str, unit: int) -> None:
        """Let `program` read it from a texture unit by this name; moderngl (5.13) cannot set that."""
        if sampler in program:
            member: Any = program[sampler]
            self._use_program(program.glo)
            self._set_uniform(member.location, unit)

    def use(self, unit: int) -> None:
        """Bind it to a texture unit."""
        self._active(_TEXTURE0 + unit)
        self._bind(_TEXTURE_BUFFER, self._name)

    def release(self) -> None:
        self._delete(1, ctypes.byref(self._name))
        self._buffer.release()
