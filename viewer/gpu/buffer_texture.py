"""Buffers that shaders read as an array of texels, by samplerBuffer. They are read faster than textures of rows are."""

from __future__ import annotations

import ctypes
from typing import Any

import moderngl
import numpy as np

from .context import Context

_TEXTURE_BUFFER, _RGBA32F, _TEXTURE0 = 0x8C2A, 0x8814, 0x84C0


class BufferTexture:
    """(N, 4) float32 `texels` in a buffer of their own."""

    def __init__(self, context: Context, texels: np.ndarray) -> None:
        integer, pointer = ctypes.c_uint, ctypes.c_void_p
        self._active = context.function("glActiveTexture", integer)
        self._bind = context.function("glBindTexture", integer, integer)
        self._delete = context.function("glDeleteTextures", integer, pointer)
        self._buffer: moderngl.Buffer = context.gl.buffer(np.ascontiguousarray(texels, np.float32))
        self._name = ctypes.c_uint()
        context.function("glGenTextures", integer, pointer)(1, ctypes.byref(self._name))
        self._use_program = context.function("glUseProgram", integer)
        self._set_uniform = context.function("glUniform1i", ctypes.c_int, ctypes.c_int)
        self._use(0)
        context.function("glTexBuffer", integer, integer, integer)(_TEXTURE_BUFFER, _RGBA32F, self._buffer.glo)

    def bind(self, program: moderngl.Program, sampler: str, unit: int) -> None:
        """Bind it to a texture unit, from which `program` reads it by this name; moderngl (5.13) cannot set that."""
        self._use(unit)
        if sampler in program:
            member: Any = program[sampler]
            self._use_program(program.glo)
            self._set_uniform(member.location, unit)

    def _use(self, unit: int) -> None:
        self._active(_TEXTURE0 + unit)
        self._bind(_TEXTURE_BUFFER, self._name)

    def release(self) -> None:
        self._delete(1, ctypes.byref(self._name))
        self._buffer.release()
