"""The display pass: exposure, tone map and sRGB encoding of a picture of radiance."""

from __future__ import annotations

import moderngl

from ..gpu.fullscreen import fullscreen
from ..gpu.programs import Programs, set_uniform
from ..settings import Settings

_TONEMAPS = ("none", "neutral", "agx", "aces")


class DisplayPass:
    def __init__(self, gl: moderngl.Context, programs: Programs) -> None:
        self._gl, self._programs = gl, programs
        self._target: moderngl.Framebuffer | None = None

    def draw(self, radiance: moderngl.Texture, settings: Settings, target: moderngl.Framebuffer, unit: int) -> None:
        """Draw `radiance` (associated alpha) into `target` as sRGB with straight alpha, using texture unit `unit`.

        A background colour shall be displayed unchanged, so it is composited after exposure and tone map. A view of
        values has neither, and its nearest codes are shown.
        """
        of_values = settings.shows_values
        tonemap, exposure = ("none", 0.0) if of_values else (settings.tonemap, settings.exposure)
        is_color = isinstance(settings.background, tuple)
        program = self._programs.get(
            "display/fullscreen.vert", "display/display.frag",
            {"TONEMAP": _TONEMAPS.index(tonemap), "DITHER": int(not of_values), "BACKDROP": int(is_color)})
        target.use()
        self._gl.enable_only(moderngl.NOTHING)
        radiance.use(unit)
        set_uniform(program, "u_radiance", unit)
        set_uniform(program, "u_exposure", 2.0**exposure)
        if is_color:
            set_uniform(program, "u_backdrop", settings.background)
        fullscreen(self._gl, program).render(vertices=3)

    def target(self, size: tuple[int, int]) -> moderngl.Framebuffer:
        """An 8-bit framebuffer of `size`, for reading back."""
        if self._target is None or self._target.size != size:
            if self._target is not None:
                self.release()
            self._target = self._gl.framebuffer([self._gl.renderbuffer(size, 4)])
        return self._target

    def release(self) -> None:
        if self._target is not None:
            self._target.color_attachments[0].release()
            self._target.release()
            self._target = None
