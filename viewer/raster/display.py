"""The display pass: radiance to what a screen shows."""

from __future__ import annotations

import moderngl

from ..settings import Settings
from .programs import Programs, set_uniform

_TONEMAPS = ("none", "neutral", "agx", "aces")


class DisplayPass:
    def __init__(self, gl: moderngl.Context, programs: Programs) -> None:
        self._gl, self._programs = gl, programs
        self._target: moderngl.Framebuffer | None = None
        self._unfiltered: moderngl.Framebuffer | None = None

    def draw(
        self, radiance: moderngl.Texture, settings: Settings, target: moderngl.Framebuffer, unit: int, fxaa: bool
    ) -> None:
        """Draw `radiance` (associated alpha) into `target` as sRGB with straight alpha, through texture `unit`.

        `fxaa` smooths edges in the displayed picture, for want of samples in the radiance.
        """
        tonemap = _TONEMAPS.index(settings.tonemap)
        program = self._programs.get(
            "display/fullscreen.vert", "display/display.frag", {"TONEMAP": tonemap, "ASSOCIATED": int(fxaa)}
        )
        (self._intermediate(radiance.size) if fxaa else target).use()
        self._gl.enable_only(moderngl.NOTHING)
        radiance.use(unit)
        set_uniform(program, "u_radiance", unit)
        set_uniform(program, "u_exposure", 2.0**settings.exposure)
        fullscreen(self._gl, program).render(vertices=3)
        if fxaa:
            program = self._programs.get("display/fullscreen.vert", "display/fxaa.frag", {})
            target.use()
            self._unfiltered.color_attachments[0].use(unit)
            set_uniform(program, "u_displayed", unit)
            fullscreen(self._gl, program).render(vertices=3)

    def target(self, size: tuple[int, int]) -> moderngl.Framebuffer:
        """An 8-bit target of our own, for reading back."""
        if self._target is None or self._target.size != size:
            _release(self._target)
            self._target = self._gl.framebuffer([self._gl.renderbuffer(size, 4)])
        return self._target

    def _intermediate(self, size: tuple[int, int]) -> moderngl.Framebuffer:
        if self._unfiltered is None or self._unfiltered.size != size:
            _release(self._unfiltered)
            texture = self._gl.texture(size, 4)
            texture.repeat_x = texture.repeat_y = False
            self._unfiltered = self._gl.framebuffer([texture])
        return self._unfiltered

    def release(self) -> None:
        _release(self._target)
        _release(self._unfiltered)
        self._target = self._unfiltered = None


def _release(framebuffer: moderngl.Framebuffer | None) -> None:
    if framebuffer is not None:
        framebuffer.color_attachments[0].release()
        framebuffer.release()


def fullscreen(gl: moderngl.Context, program: moderngl.Program) -> moderngl.VertexArray:
    """The vertex array, without attributes, that display/fullscreen.vert wants."""
    if program.extra is None:
        program.extra = gl.vertex_array(program, [])
    return program.extra
