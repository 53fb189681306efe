"""How the depth of what the camera sees is stored and compared.

A perspective depth is near / z up to scale and offset. Stored in 24 bits from 0 to 1, neighbouring values at a distance
z are z^2 / (near 2^24) apart. A float has its finest steps about 0: with 0 at the far plane and 1 at the near one they
shrink as near / z does, and neighbours are about z 2^-24 apart, wherever near is (Reed 2015, "Depth Precision
Visualized"). This takes glClipControl, because OpenGL's usual map from [-1, 1] to [0, 1] would round these steps away.
"""

from __future__ import annotations

import ctypes
from collections.abc import Iterator
from contextlib import contextmanager

import moderngl

from ..gpu.context import Context
from ..gpu.float_depth import float_depth_renderbuffer

_DEPTH_CLAMP = 0x864F
_LOWER_LEFT, _NEGATIVE_ONE_TO_ONE, _ZERO_TO_ONE = 0x8CA1, 0x935E, 0x935F


def can_reverse(gl: moderngl.Context) -> bool:
    """Whether glClipControl is there, from OpenGL 4.5 or from the extension."""
    return gl.version_code >= 450 or "GL_ARB_clip_control" in gl.extensions


class Depth:
    """The depth test of one context: reversed and in floats where OpenGL 4.5 or GL_ARB_clip_control allows it."""

    def __init__(self, context: Context) -> None:
        self._context, self._gl = context, context.gl
        self.is_reversed = can_reverse(context.gl)
        self.far = 0.0 if self.is_reversed else 1.0
        """The depth of the far plane, to which buffers are cleared."""
        self._nearer = ">" if self.is_reversed else "<"
        integer, double = ctypes.c_int, ctypes.c_double
        self._set_range = context.function("glDepthRange", double, double)
        if self.is_reversed:
            self._clip_control = context.function("glClipControl", integer, integer)

    def renderbuffer(self, size: tuple[int, int], samples: int = 0) -> moderngl.Renderbuffer:
        """A depth buffer, of 32-bit floats where depth is reversed and of 24 bits elsewhere."""
        if self.is_reversed:
            return float_depth_renderbuffer(self._context, size, samples)
        return self._gl.depth_renderbuffer(size, samples=samples)

    @contextmanager
    def test(self) -> Iterator[None]:
        """Let what is drawn within be clipped and compared so; shadow maps and the path tracer draw outside."""
        if self.is_reversed:
            self._clip_control(_LOWER_LEFT, _ZERO_TO_ONE)
        self._gl.depth_func = self._nearer
        try:
            yield
        finally:
            if self.is_reversed:
                self._clip_control(_LOWER_LEFT, _NEGATIVE_ONE_TO_ONE)
            self._gl.depth_func = "<"

    @contextmanager
    def equal(self) -> Iterator[None]:
        """Draw what lies exactly as deep as what was drawn before, within `test()`."""
        with self._compared("=="):
            yield

    @contextmanager
    def only_at(self, depth: float) -> Iterator[None]:
        """Restrict a full-screen triangle to the pixels in which this depth is stored, within `test()`."""
        with self._at(depth, "=="):
            yield

    @contextmanager
    def except_at(self, depth: float) -> Iterator[None]:
        """Restrict a full-screen triangle to the pixels in which another depth is stored."""
        with self._at(depth, "!="):
            yield

    @contextmanager
    def all(self) -> Iterator[None]:
        """Let all pixels store their depth, within `test()`."""
        with self._compared("1"):
            yield

    @contextmanager
    def as_far(self) -> Iterator[None]:
        """Let all pixels that a full-screen triangle covers store the far plane, within `test()`."""
        with self._at(self.far, "1"):
            yield

    @contextmanager
    def on_surfaces(self) -> Iterator[None]:
        """Restrict a full-screen triangle to the pixels that have a surface, within `test()`."""
        with self._at(self.far, "<" if self.is_reversed else ">"):
            yield

    @contextmanager
    def behind_surfaces(self) -> Iterator[None]:
        """Restrict a full-screen triangle to the pixels that have none, within `test()`."""
        with self._at(self.far, ">=" if self.is_reversed else "<="):
            yield

    @contextmanager
    def beyond_planes(self) -> Iterator[None]:
        """Draw also what is nearer than the near plane, before all, and farther than the far one, behind all that is
        there, within `test()`."""
        self._gl.enable_direct(_DEPTH_CLAMP)
        try:
            with self._compared(self._nearer + "="):
                yield
        finally:
            self._gl.disable_direct(_DEPTH_CLAMP)

    @contextmanager
    def _at(self, depth: float, compare: str) -> Iterator[None]:
        self._set_range(depth, depth)
        try:
            with self._compared(compare):
                yield
        finally:
            self._set_range(0.0, 1.0)

    @contextmanager
    def _compared(self, compare: str) -> Iterator[None]:
        self._gl.depth_func = compare
        try:
            yield
        finally:
            self._gl.depth_func = self._nearer
