"""Shows a displayed picture with more pixels than it has."""

from __future__ import annotations

from collections.abc import Callable

import moderngl

from ..gpu.over_picture import draw_over
from ..gpu.programs import Programs


class Enlarged:
    def __init__(self, gl: moderngl.Context, programs: Programs) -> None:
        self._gl, self._programs = gl, programs
        self._picture: moderngl.Texture | None = None
        self._small: moderngl.Framebuffer | None = None

    def draw(self, size: tuple[int, int], present: Callable[[moderngl.Framebuffer], None],
             target: moderngl.Framebuffer) -> None:
        """Draw what `present` draws at `size` pixels over all of `target`, interpolated between the pixels."""
        if self._picture is None or self._small is None or self._picture.size != size:
            self.release()
            self._picture = self._gl.texture(size, 4)
            self._picture.filter = moderngl.LINEAR, moderngl.LINEAR
            self._picture.repeat_x = self._picture.repeat_y = False
            self._small = self._gl.framebuffer([self._picture])
        present(self._small)
        program = self._programs.get("display/fullscreen.vert", "display/enlarge.frag", {})
        draw_over(self._gl, program, target, {"u_picture": self._picture})

    def release(self) -> None:
        for thing in (self._small, self._picture):
            if thing is not None:
                thing.release()
        self._small = self._picture = None
