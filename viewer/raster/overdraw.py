"""How many fragments are drawn in each pixel."""

from __future__ import annotations

from collections.abc import Callable

import moderngl

from ..gpu.context import Context
from ..gpu.fullscreen import fullscreen
from ..gpu.programs import Programs, set_uniform
from ..plan.legend import overdraw_colors
from .depth import Depth
from .target import Target

_UNIT = 0


class Overdraw:
    """Counts fragments in a target of its own, with the depth of that of the frame."""

    def __init__(self, context: Context, programs: Programs, depth: Depth) -> None:
        self._gl, self._programs, self._depth = context.gl, programs, depth
        self._framebuffer: moderngl.Framebuffer | None = None

    def draw(self, target: Target, draw_all: Callable[[], object]) -> None:
        """Draw what `draw_all()` draws, within `Depth.test()`, and its counts as colours into `target`, which has one
        sample a pixel. Each fragment that passes adds 1."""
        gl, framebuffer = self._gl, self._sized(target.size)
        framebuffer.use()
        framebuffer.clear(depth=self._depth.far)
        gl.blend_func = moderngl.ONE, moderngl.ONE
        draw_all()
        program = self._programs.get("display/fullscreen.vert", "raster/overdraw.frag", {
            "SHOW": -1, "COLORS": len(overdraw_colors())})
        target.framebuffer.use()
        gl.enable_only(moderngl.NOTHING)
        gl.clear_samplers()  # those of maps read mip levels, which the counts have none of
        framebuffer.color_attachments[0].use(_UNIT)
        set_uniform(program, "u_counts", _UNIT)
        set_uniform(program, "u_colors", [tuple(color) for color in (overdraw_colors() / 255.0).tolist()])
        fullscreen(gl, program).render(vertices=3)

    def _sized(self, size: tuple[int, int]) -> moderngl.Framebuffer:
        if self._framebuffer is None or self._framebuffer.size != size:
            self.release()
            counts = self._gl.texture(size, 1, dtype="f4")
            counts.filter = moderngl.NEAREST, moderngl.NEAREST
            self._framebuffer = self._gl.framebuffer([counts], self._depth.renderbuffer(size))
        return self._framebuffer

    def release(self) -> None:
        if self._framebuffer is not None:
            self._gl.screen.use()
            for thing in (self._framebuffer, *self._framebuffer.color_attachments, self._framebuffer.depth_attachment):
                thing.release()
            self._framebuffer = None
