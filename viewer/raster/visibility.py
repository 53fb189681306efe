"""The pass that finds the visibility of the environment at each pixel, before the surfaces are shaded."""

from __future__ import annotations

import math
from collections.abc import Callable

import moderngl
import numpy as np

from ..base.reusable import Reusable
from ..gpu.context import Context
from ..gpu.free import free
from ..gpu.fullscreen import fullscreen
from ..gpu.llvmpipe import let_others_run
from ..gpu.programs import Programs, set_uniform
from ..plan.model import Draw, Plan
from ..scene.frame import Frame
from .environment import EnvironmentLight
from .environment_shadows import SMALL, EnvironmentShadows
from .gbuffer import UNIT_NORMALS, GBuffer, nearest_texture
from .kept_maps import KeptMaps
from .media_light import MediaLight
from .shadows import Casters
from .units import UNIT_SEEN_POSITIONS, UNIT_VISIBILITY

MOST_POINTS = 1 << 17
"""Shadows of the environment are found at so many points of a picture, each of which takes as many lookups as there are
lights. In a larger picture they are interpolated: they are softer than a pixel, and their maps coarser."""


class VisibilityPass:
    """Owns the targets of one picture size and the shadow maps of one scene's environment."""

    def __init__(self, context: Context, programs: Programs, use_cache: bool) -> None:
        self._context, self._gl, self._programs = context, context.gl, programs
        self._targets: Reusable[_Targets] = Reusable()
        self._shadows: EnvironmentShadows | None = None
        self._kept = KeptMaps(context, use_cache)

    def prepare(self, pixels: Frame, plan: Plan, environment: EnvironmentLight, fog: MediaLight | None,
                casters: Casters, mean: Callable[[Draw, str], np.ndarray]) -> None:
        """Draw the shadow maps that `plan` needs, unless they are there. `fog` is the light in it, and `mean` gives
        that of a material's map."""
        is_small = pixels.pixels_across <= SMALL
        if self._shadows is None or not self._shadows.holds(environment, plan, is_small):
            self._shadows = EnvironmentShadows(
                self._context, environment, plan, casters, is_small, before=self._shadows)
        self._shadows.show(pixels.scene, plan, fog, mean, self._kept)

    def forget_scene(self, plan: Plan) -> None:
        """Let the shadow maps be drawn again, for meshes or programs that have changed. Their memory is kept if the
        next frames, by `plan`, have such maps."""
        if self._shadows is not None:
            self._shadows.forget_scene()
            if not plan.environment_shadows:
                self._release_shadows()

    def find(self, frame: Frame, plan: Plan, gbuffer: GBuffer) -> dict[str, object]:
        """Draw the pass over the frame's G-buffer and return the uniforms of shaders/raster/visibility.glsl.

        Leaves a framebuffer of its own in use.
        """
        targets = self._targets.get(lambda held: held.gbuffer is gbuffer, lambda: _Targets(self._gl, gbuffer))
        if plan.ambient_occlusion:
            return targets.draw_ambient_occlusion(self._programs, frame)
        return targets.draw_environment_shadows(self._programs, frame, self._shadows)

    def release(self) -> None:
        self._release_shadows()
        self._targets.release()

    def _release_shadows(self) -> None:
        free(self._gl, self._shadows)
        self._shadows = None


class _Targets:
    """The buffers of one picture size, and the passes that fill them."""

    def __init__(self, gl: moderngl.Context, gbuffer: GBuffer) -> None:
        self._gl, self.gbuffer = gl, gbuffer
        self._sums = [nearest_texture(gl, gbuffer.size, "f4") for _ in range(2)]
        self._visibility = nearest_texture(gl, gbuffer.size, "f2")
        self._summing = gbuffer.target(*self._sums)
        self._places = nearest_texture(gl, gbuffer.size, "f4")
        self._result = gbuffer.target(self._visibility)
        self._result_and_places = gbuffer.target(self._visibility, self._places)

    def draw_environment_shadows(
        self, programs: Programs, frame: Frame, shadows: EnvironmentShadows
    ) -> dict[str, object]:
        gl = self._gl
        self._summing.use()
        self._summing.clear()
        gl.blend_func = moderngl.ONE, moderngl.ONE
        uniforms = self.gbuffer.bind(frame)
        let_others_run(gl)
        with self.gbuffer.on_surfaces(moderngl.BLEND):
            shadows.add(programs, frame, uniforms)
        gl.enable_only(moderngl.NOTHING)
        let_others_run(gl)
        self._result_and_places.use()
        program = programs.get("display/fullscreen.vert", "raster/visibility.frag", {})
        for unit, (name, texture) in enumerate(zip(("u_shadowed", "u_unshadowed"), self._sums), UNIT_NORMALS + 1):
            texture.use(unit)
            uniforms[name] = unit
        for name, value in uniforms.items():
            set_uniform(program, name, value)
        fullscreen(gl, program).render(vertices=3)
        return self._uniforms(self._places)

    def draw_ambient_occlusion(self, programs: Programs, frame: Frame) -> dict[str, object]:
        self._result.use()
        program = programs.get("display/fullscreen.vert", "raster/ambient_occlusion.frag", {
            "IS_ORTHOGRAPHIC": int(frame.camera.height is not None)})
        pose, height = frame.camera.pose, frame.camera.height
        extent = 2 * math.tan(frame.camera.fov_y / 2) if height is None else height / frame.unit
        for name, value in (self.gbuffer.bind(frame) | {
                "u_right": tuple(pose[:3, 0]), "u_up": tuple(pose[:3, 1]), "u_pixels": frame.size[1] / extent,
                "u_narrowness": 1 / frame.camera.pixel_aspect}).items():
            set_uniform(program, name, value)
        with self.gbuffer.on_surfaces():
            fullscreen(self._gl, program).render(vertices=3)
        return self._uniforms(self.gbuffer.positions)

    def _uniforms(self, places: moderngl.Texture) -> dict[str, object]:
        self._visibility.use(UNIT_VISIBILITY)
        places.use(UNIT_SEEN_POSITIONS)
        return {"u_visibility": UNIT_VISIBILITY, "u_positions": UNIT_SEEN_POSITIONS}

    def release(self) -> None:
        for thing in (self._summing, self._result, self._result_and_places, *self._sums, self._visibility,
                      self._places):
            thing.release()
