"""The target of a frame: multisampled float colour and depth, resolved to one sample a pixel."""

from __future__ import annotations

import moderngl

from ..errors import UsageError
from ..gpu.fullscreen import fullscreen
from ..gpu.programs import Programs, set_uniform
from .depth import Depth


class Target:
    """Colour (RGBA half or single floats, associated alpha) with depth, at `size` and `samples`.

    The frame is drawn at `drawn_size`, `supersampling` times `size` in each direction, with `samples` a pixel.
    """

    def __init__(
        self, gl: moderngl.Context, depth: Depth, size: tuple[int, int], samples: int, half: bool,
        supersampling: int = 1,
    ) -> None:
        limit = gl.info["GL_MAX_TEXTURE_SIZE"]
        self.size, self.samples, self.half, self.supersampling = size, samples, half, supersampling
        self.drawn_size = size[0] * supersampling, size[1] * supersampling
        if max(self.drawn_size) > limit or min(size) < 1:
            limit //= supersampling
            raise UsageError(f"a picture of {size[0]}x{size[1]}: this OpenGL draws from 1x1 to {limit}x{limit}")
        self._gl = gl
        try:
            self._make(depth)
        except moderngl.Error as error:
            raise UsageError(f"a picture of {size[0]}x{size[1]} with {samples} samples a pixel is more than this "
                             f"OpenGL can hold ({error})") from error

    def _make(self, depth: Depth) -> None:
        gl, size, drawn, samples = self._gl, self.size, self.drawn_size, self.samples
        dtype = "f2" if self.half else "f4"
        self.radiance = gl.texture(size, 4, dtype=dtype)
        self.radiance.filter = (moderngl.NEAREST, moderngl.NEAREST)
        self._resolved = gl.framebuffer([self.radiance])
        if samples > 1 or drawn != size:
            self._color = gl.texture(drawn, 4, samples=samples if samples > 1 else 0, dtype=dtype)
            self._depth = depth.renderbuffer(drawn, samples if samples > 1 else 0)
            self.framebuffer = gl.framebuffer([self._color], self._depth)
        else:
            self._color = None
            self._depth = depth.renderbuffer(size)
            self.framebuffer = gl.framebuffer([self.radiance], self._depth)

    def fits(self, size: tuple[int, int], samples: int, half: bool, supersampling: int = 1) -> bool:
        return (self.size, self.samples, self.half, self.supersampling) == (size, samples, half, supersampling)

    def set_part(self, part: tuple[int, int, int, int] | None) -> None:
        """The part (x, y, width, height) that is cleared, drawn and resolved; None is all."""
        self._resolved.scissor = part
        self.framebuffer.scissor = part and tuple(number * self.supersampling for number in part)

    def resolve(self, programs: Programs, unit: int) -> None:
        """Average the samples into `radiance`; reads them through texture `unit`.

        We use a program of our own: Mesa's software rasteriser compiles the one of glBlitFramebuffer in every process.
        """
        if self._color is None:
            return
        program = programs.get("display/fullscreen.vert", "raster/resolve.frag", {
            "SAMPLES": self.samples, "SUPERSAMPLING": self.supersampling})
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
