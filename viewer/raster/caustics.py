"""What lamps throw through smooth glass and off smooth mirrors, by photons, on top of a picture of the raster.

The raster has nothing of this light: glass and mirrors cast full shadows of lamps, and `indirect=baked` asks lamps as
paths do, and so finds none behind a smooth surface. So what photons bring in mode path is added as it is, and what
comes straight through panes, which in mode path shadow rays bring. It is a mean over each pixel's area, as the raster's
antialiasing is.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import fields, replace
from typing import TYPE_CHECKING, Any

import moderngl

from ..gpu.context import Context
from ..gpu.float_target import float_target
from ..gpu.over_picture import draw_over
from ..gpu.programs import Programs
from ..plan.model import Plan
from ..plan.warnings import NO_PHOTONS
from ..scene.camera import Camera
from ..scene.light import Light
from ..scene.scene import Scene
from ..settings import Settings, ignored

if TYPE_CHECKING:
    from ..trace.paths.photon_render import PhotonRender
    from ..trace.tracer import Tracer


def photon_settings(settings: Settings) -> Settings:
    """Those of mode path for what a picture of mode pbr with `settings` has by photons. What changes nothing of that
    has its default, so that photons stay when it changes."""
    others = {*ignored("path"), *ignored("pbr"), "exposure", "tonemap"}
    plain: dict[str, Any] = {f.name: f.default for f in fields(Settings) if f.name in others}
    return replace(settings, **plain, mode="path", background="none")


def why_none(settings: Settings) -> str | None:
    """A reason that lies in the settings why the raster has no photons; None if there is none."""
    if settings.shadows == "off":
        return f"{NO_PHOTONS}with shadows off, lamps shine through glass as if it were not there"
    return None


def plan_lines(scene: Scene, settings: Settings) -> tuple[tuple[str, ...], tuple[str, ...]]:
    """The lines of the plan about photons, what is used and what is left out; it needs no context."""
    from ..trace.scene.traced_scene import plan_without_device

    if reason := why_none(settings):
        return (), (reason,)
    plan = plan_without_device(scene, photon_settings(settings))
    return (tuple(line for line in plan.used if line.startswith("photons from")),
            tuple(line for line in plan.left_out if line.startswith(NO_PHOTONS)))


class Caustics:
    """Holds the photons of one picture. `follow` says which, and `step` adds more."""

    def __init__(self, context: Context, programs: Programs) -> None:
        self._context, self._programs = context, programs
        self._tracer: Tracer | None = None
        self._render: PhotonRender | None = None
        self._key: tuple[object, ...] | None = None
        self._shown: moderngl.Framebuffer | None = None
        self.used: tuple[str, ...] = ()
        self.left_out: tuple[str, ...] = ()
        """Lines of the plan."""

    def follow(self, scene: Scene, camera: Camera, settings: Settings, size: tuple[int, int],
               unshadowed: Sequence[Light] = (), keeps: bool = False) -> None:
        """Begin to trace for this picture, without any photons; with `keeps` an equal one before keeps its own.

        Lights that are `unshadowed` in the raster shine through glass there, and so have no photons. Raises as
        `Tracer.begin`.
        """
        key = (scene, *camera.key, size, photon_settings(settings), tuple(unshadowed), self._programs.generation)
        if keeps and key == self._key:
            return
        from ..trace.tracer import Tracer

        self.drop()
        self._key = key
        if reason := why_none(settings):
            self.left_out = (reason,)
            return
        if self._tracer is None:
            self._tracer = Tracer(self._context, programs=self._programs)
        if unshadowed:
            scene = scene.relit(lights=tuple(light for light in scene.lights if light not in unshadowed))
        self._render = self._tracer.begin_photons(scene, camera, photon_settings(settings), size)
        photons = self._tracer.photons
        assert photons is not None
        self.left_out = tuple(photons.left_out)
        self.used = (photons.description,) if self._render is not None else ()

    @property
    def each(self) -> float:
        """Photons a pixel so far; infinite if there are none to trace."""
        render = self._render
        return math.inf if render is None else render.sums.count / math.prod(render.sums.size)

    def step(self, seconds: float, each: float) -> bool:
        """Trace for about so long, until there are `each` photons a pixel. Returns whether there are new ones."""
        render = self._render
        if render is None:
            return False
        before = render.sums.count
        render.step(seconds, math.ceil(each * math.prod(render.sums.size)))
        return render.sums.count > before

    def over(self, radiance: moderngl.Texture) -> moderngl.Texture:
        """`radiance` with the light of the photons, in single floats."""
        if self._render is None:
            return radiance
        gl, sums = self._context.gl, self._render.sums
        if self._shown is None or self._shown.size != sums.size:
            self._release_shown()
            self._shown = gl.framebuffer([float_target(gl, sums.size)])
        program = self._programs.get("display/fullscreen.vert", "raster/caustics.frag", {})
        draw_over(gl, program, self._shown, {"u_picture": radiance, "u_photon_sum": sums.textures["u_photon_sum"]},
                  uniforms={"u_photons": float(sums.count)})
        return self._shown.color_attachments[0]

    def explained(self, plan: Plan) -> Plan:
        """The plan with the lines about photons."""
        return replace(plan, used=(*plan.used, *self.used), left_out=(*plan.left_out, *self.left_out))

    def stats(self) -> dict[str, object]:
        """As `PhotonRender.stats`; empty without photons."""
        return {} if self._render is None else self._render.stats()

    def drop(self) -> None:
        """Forget the picture and its photons; the scene stays prepared."""
        if self._render is not None:
            self._render.release()
        self._render = self._key = None
        self.used = self.left_out = ()

    def _release_shown(self) -> None:
        if self._shown is not None:
            self._shown.color_attachments[0].release()
            self._shown.release()
            self._shown = None

    def release(self) -> None:
        self.drop()
        self._release_shown()
        if self._tracer is not None:
            self._tracer.release()
