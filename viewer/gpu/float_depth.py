"""Depth buffers of floats."""

from __future__ import annotations

import ctypes

import moderngl

from .context import Context

_RENDERBUFFER, _DEPTH_COMPONENT32F = 0x8D41, 0x8CAC


def float_depth_renderbuffer(context: Context, size: tuple[int, int], samples: int = 0) -> moderngl.Renderbuffer:
    """A depth buffer of 32-bit floats; moderngl makes no other kind than 24 bits, but lets it be allocated anew."""
    integer = ctypes.c_int
    buffer = context.gl.depth_renderbuffer(size, samples=samples)
    context.function("glBindRenderbuffer", integer, integer)(_RENDERBUFFER, buffer.glo)
    context.function("glRenderbufferStorageMultisample", *[integer] * 5)(
        _RENDERBUFFER, samples, _DEPTH_COMPONENT32F, *size)
    return buffer
