"""The target of a frame: multisampled float colour and depth, resolved to one sample a pixel."""

from __future__ import annotations

from typing import Protocol

import moderngl

from ..errors import UsageError
from ..gpu.fullscreen import fullscreen
from ..gpu.programs import Programs, set_uniform
from .depth import Depth

_FULLSCREEN = "display/fullscreen.vert"


class Behind(Protocol):
    """What lies behind the samples of a frame, where they are transparent, with its first surfaces in `radiance`."""

    def resolve(self, programs: Programs, unit: int) -> None:
        """As `Target.resolve`, with the samples' texture in `unit`."""

    def mix(self, programs: Programs, unit: int, framebuffer: moderngl.Framebuffer) -> None:
        """The same in a `framebuffer` with a copy of `radiance`, within `Depth.test()`."""


class Target:
    """Colour (RGBA half or single floats, associated alpha) with depth, at `size` and `samples`.

    The frame is drawn at `drawn_size`, `supersampling` times `size` in each direction, with `samples` a pixel.
    `radiance` is what another target of this size and precision has kept: parts that it has drawn stay.
    """

    def __init__(
        self, gl: moderngl.Context, depth: Depth, size: tuple[int, int], samples: int, half: bool,
        supersampling: int = 1, radiance: moderngl.Texture | None = None,
    ) -> None:
        limit = gl.info["GL_MAX_TEXTURE_SIZE"]
        self.size, self.samples, self.half, self.supersampling = size, samples, half, supersampling
        self.drawn_size = size[0] * supersampling, size[1] * supersampling
        if max(self.drawn_size) > limit or min(size) < 1:
            limit //= supersampling
            raise UsageError(f"a picture of {size[0]}x{size[1]}: this OpenGL draws from 1x1 to {limit}x{limit}")
        self._gl = gl
        self.part: tuple[int, int, int, int] | None = None
        """What is drawn (`set_part`)."""
        self.behind: Behind | None = None
        """What this frame has besides."""
        try:
            self._make(depth, radiance)
        except moderngl.Error as error:
            raise UsageError(f"a picture of {size[0]}x{size[1]} with {samples} samples a pixel is more than this "
                             f"OpenGL can hold ({error})") from error

    def _make(self, depth: Depth, radiance: moderngl.Texture | None) -> None:
        gl, size, drawn, samples = self._gl, self.size, self.drawn_size, self.samples
        dtype = "f2" if self.half else "f4"
        self.radiance = radiance or gl.texture(size, 4, dtype=dtype)
        self.radiance.filter = (moderngl.NEAREST, moderngl.NEAREST)
        self.resolved = gl.framebuffer([self.radiance])
        if samples > 1 or drawn != size:
            self._color = gl.texture(drawn, 4, samples=samples if samples > 1 else 0, dtype=dtype)
            self.depth = depth.renderbuffer(drawn, samples if samples > 1 else 0)
            self.framebuffer = gl.framebuffer([self._color], self.depth)
        else:
            self._color = None
            self.depth = depth.renderbuffer(size)
            self.framebuffer = gl.framebuffer([self.radiance], self.depth)

    def fits(self, size: tuple[int, int], samples: int, half: bool, supersampling: int = 1) -> bool:
        return (self.size, self.samples, self.half, self.supersampling) == (size, samples, half, supersampling)

    def set_part(self, part: tuple[int, int, int, int] | None) -> None:
        """The part (x, y, width, height) that is cleared, drawn and resolved; None is all."""
        self.resolved.scissor = part
        self.part = part
        self.framebuffer.scissor = part and tuple(number * self.supersampling for number in part)

    def resolve(self, programs: Programs, unit: int) -> None:
        """Average the samples into `radiance`; reads them through texture `unit`.

        We use a program of our own: Mesa's software rasteriser compiles the one of glBlitFramebuffer in every process.
        """
        if self._color is None:
            return
        if self.behind is not None:
            self._color.use(unit)
            self.behind.resolve(programs, unit)
            return
        self._average(programs, unit, self.resolved)

    def so_far(self, programs: Programs, unit: int, framebuffer: moderngl.Framebuffer) -> None:
        """Draw what there is of a frame that goes on, averaged as by `resolve`, into a `framebuffer` of one level of a
        texture, within `Depth.test()`."""
        if self._color is None or self.behind is not None or self.part is not None:
            framebuffer.scissor = None
            self._draw(programs.get(_FULLSCREEN, "raster/backdrop.frag", {"LEVEL": 0}), "u_source", self.radiance,
                       unit, framebuffer)
        framebuffer.scissor = self.part
        if self._color is None:
            return
        if self.behind is not None:
            self._color.use(unit)
            self.behind.mix(programs, unit, framebuffer)
            return
        self._average(programs, unit, framebuffer)

    def _average(self, programs: Programs, unit: int, framebuffer: moderngl.Framebuffer) -> None:
        program = programs.get(_FULLSCREEN, "raster/resolve.frag", {
            "SAMPLES": self.samples, "SUPERSAMPLING": self.supersampling})
        self._draw(program, "u_samples", self._color, unit, framebuffer)

    def _draw(self, program: moderngl.Program, name: str, texture: moderngl.Texture, unit: int,
              framebuffer: moderngl.Framebuffer) -> None:
        framebuffer.use()
        self._gl.enable_only(moderngl.NOTHING)
        texture.use(unit)
        set_uniform(program, name, unit)
        fullscreen(self._gl, program).render(vertices=3)

    def read(self) -> bytes:
        """The resolved radiance, rows from the bottom up, RGBA in the target's precision."""
        return self.resolved.read(components=4, dtype="f2" if self.half else "f4")

    def release(self) -> None:
        self.release_samples()
        self.radiance.release()

    def release_samples(self) -> None:
        """Free all but `radiance`, which another target takes over."""
        for thing in (self.framebuffer, self.resolved, self._color, self.depth):
            if thing is not None:
                thing.release()
