"""What a frame is drawn into: a multisampled target of floats, resolved to one sample a pixel."""

from __future__ import annotations

import moderngl

from ..errors import UsageError
from .display import fullscreen
from .programs import Programs, set_uniform

MAX_SIDE_FALLBACK = 16384


class Target:
    """Colour (RGBA half or single floats, associated alpha) with depth, at `size` and `samples`."""

    def __init__(self, gl: moderngl.Context, size: tuple[int, int], samples: int, half: bool) -> None:
        limit = gl.info.get("GL_MAX_TEXTURE_SIZE", MAX_SIDE_FALLBACK)
        if max(size) > limit or min(size) < 1:
            raise UsageError(f"a picture of {size[0]}x{size[1]}: this OpenGL draws from 1x1 to {limit}x{limit}")
        self.size, self.samples, self.half = size, samples, half
        self._gl = gl
        try:
            self._make()
        except moderngl.Error as error:
            raise UsageError(f"a picture of {size[0]}x{size[1]} with {samples} samples a pixel is more than this "
                             f"OpenGL can hold ({error})") from error

    def _make(self) -> None:
        gl, size, samples = self._gl, self.size, self.samples
        dtype = "f2" if self.half else "f4"
        self.radiance = gl.texture(size, 4, dtype=dtype)
        self.radiance.filter = (moderngl.NEAREST, moderngl.NEAREST)
        self._resolved = gl.framebuffer([self.radiance])
        if samples > 1:
            self._color = gl.texture(size, 4, samples=samples, dtype=dtype)
            self._depth = gl.depth_renderbuffer(size, samples=samples)
            self.framebuffer = gl.framebuffer([self._color], self._depth)
        else:
            self._color = None
            self._depth = gl.depth_renderbuffer(size)
            self.framebuffer = gl.framebuffer([self.radiance], self._depth)

    def fits(self, size: tuple[int, int], samples: int, half: bool) -> bool:
        return (self.size, self.samples, self.half) == (size, samples, half)

    @property
    def scissor(self) -> tuple[int, int, int, int] | None:
        """The part (x, y, width, height) that is cleared, drawn and resolved; None is all."""
        return self.framebuffer.scissor

    @scissor.setter
    def scissor(self, part: tuple[int, int, int, int] | None) -> None:
        self.framebuffer.scissor = self._resolved.scissor = part

    def resolve(self, programs: Programs, unit: int) -> None:
        """Average the samples into `radiance`; reads them through texture `unit`.

        By a program of our own: that of glBlitFramebuffer Mesa's software rasteriser compiles in every process anew.
        """
        if self.samples == 1:
            return
        program = programs.get("display/fullscreen.vert", "raster/resolve.frag", {"SAMPLES": self.samples})
        self._resolved.use()
        self._gl.enable_only(moderngl.NOTHING)
        self._color.use(unit)
        set_uniform(program, "u_samples", unit)
        fullscreen(self._gl, program).render(vertices=3)

    def read(self) -> bytes:
        """The resolved radiance, rows from the bottom up, RGBA in the target's precision."""
        return self._resolved.read(components=4, dtype="f2" if self.half else "f4")

    def release(self) -> None:
        for thing in (self.framebuffer, self._resolved, self._color, self._depth, self.radiance):
            if thing is not None:
                thing.release()
