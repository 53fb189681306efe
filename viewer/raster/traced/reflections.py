"""The pass that finds what surfaces mirror of the model itself: a ray from each point that is shaded, through the path
tracer's intersector, lit by what was baked at the vertices."""

from __future__ import annotations

from typing import TYPE_CHECKING

import moderngl

from ...gpu.context import Context
from ...gpu.fullscreen import fullscreen
from ...gpu.programs import Programs, set_uniform
from ...scene.frame import Frame
from ...scene.scene import Scene
from ...settings import Settings
from ..gbuffer import UNIT_NORMALS, GBuffer, nearest_texture
from ..surfaces import UNIT_RAY_POSITIONS, UNIT_REFLECTED

if TYPE_CHECKING:
    from .reflected_surfaces import ReflectedSurfaces


class TracedReflections:
    """Keeps the rays of one picture size and what they can meet of one scene.

    `kind` of intersector as `viewer.trace.intersect.make_intersector` takes it.
    """

    def __init__(self, context: Context, programs: Programs, kind: str = "auto") -> None:
        self._context, self._programs, self._kind = context, programs, kind
        self._surfaces: ReflectedSurfaces | None = None
        self._rays: _Rays | None = None

    def prepare(self, scene: Scene, settings: Settings) -> None:
        """Make ready what rays can meet of `scene`, if it is not."""
        if self._surfaces is None or not self._surfaces.holds(scene):
            from .reflected_surfaces import ReflectedSurfaces

            self.drop_scene()
            self._surfaces = ReflectedSurfaces(self._context, scene, settings, self._kind)

    def find(self, frame: Frame, gbuffer: GBuffer, uniforms: dict[str, object]) -> dict[str, object]:
        """Trace the G-buffer's rays under the environment of `uniforms`; returns the uniforms of
        shaders/raster/traced_reflection.glsl.

        Leaves a framebuffer of its own in use.
        """
        if self._rays is None or self._rays.gbuffer is not gbuffer:
            self._release_rays()
            self._rays = _Rays(self._context.gl, gbuffer)
        rays = self._rays
        rays.begin(self._programs, frame)
        intersector = self._surfaces.intersector
        intersector.store(rays, intersector.trace(intersector.fetch(rays)))
        rays.shade(self._programs, frame, uniforms, self._surfaces)
        rays.average(self._programs, frame)
        rays.reflected.use(UNIT_REFLECTED)
        gbuffer.positions.use(UNIT_RAY_POSITIONS)
        return {"u_reflected": UNIT_REFLECTED, "u_ray_positions": UNIT_RAY_POSITIONS}

    def drop_scene(self) -> None:
        """For when the scene is another."""
        if self._surfaces is not None:
            self._surfaces.release()
            self._surfaces = None

    def _release_rays(self) -> None:
        if self._rays is not None:
            self._rays.release()
            self._rays = None  # should the next one fail

    def release(self) -> None:
        self.drop_scene()
        self._release_rays()


class _Rays:
    """The textures that `viewer.trace.intersect.WaveTextures` describes, a slot for each pixel of the G-buffer.

    And what the rays met: each by itself, `met`, and together with its neighbours, `reflected`.
    """

    def __init__(self, gl: moderngl.Context, gbuffer: GBuffer) -> None:
        self._gl, self.gbuffer = gl, gbuffer
        self.origin, self.direction, self.shadow_vector = (nearest_texture(gl, gbuffer.size, "f4") for _ in range(3))
        self.shadow_origin = self.shadow_vector
        self.hit = nearest_texture(gl, gbuffer.size, "u4")
        self.met, self.sent, self.reflected = (nearest_texture(gl, gbuffer.size, "f2") for _ in range(3))
        no_shadow = gl.framebuffer([self.shadow_vector])
        no_shadow.clear()
        no_shadow.release()
        targets = (self.origin, self.direction), (self.met, self.sent), (self.reflected,)
        self._targets = [gbuffer.target(*textures) for textures in targets]

    def begin(self, programs: Programs, frame: Frame) -> None:
        """Write the rays of the frame's surfaces."""
        program = programs.get("display/fullscreen.vert", "raster/reflection_rays.frag", {
            "IS_ORTHOGRAPHIC": int(frame.camera.height is not None)})
        eye = (frame.camera.eye - frame.scene.center) / frame.unit
        self._draw(program, 0, self.gbuffer.bind(frame) | {"u_eye": tuple(eye)})

    def shade(
        self, programs: Programs, frame: Frame, uniforms: dict[str, object], surfaces: ReflectedSurfaces
    ) -> None:
        """Write what light each ray met, and what it hides of the environment's."""
        program = programs.get("display/fullscreen.vert", "raster/reflected_light.frag", {
            "REFLECTS": 1, "ENVIRONMENT_ROTATED": 1})
        self.hit.use(UNIT_NORMALS + 1)
        self.direction.use(UNIT_NORMALS + 2)
        rays = {"u_hit": UNIT_NORMALS + 1, "u_direction": UNIT_NORMALS + 2}
        self._draw(program, 1, uniforms | self.gbuffer.bind(frame) | rays | surfaces.bind(UNIT_NORMALS + 3))

    def average(self, programs: Programs, frame: Frame) -> None:
        """Write the mean over neighbours that lie alike."""
        program = programs.get("display/fullscreen.vert", "raster/reflected_mean.frag", {})
        self.met.use(UNIT_NORMALS + 1)
        self.sent.use(UNIT_NORMALS + 2)
        self._draw(program, 2, self.gbuffer.bind(frame) | {"u_met": UNIT_NORMALS + 1, "u_sent": UNIT_NORMALS + 2})

    def _draw(self, program: moderngl.Program, target: int, uniforms: dict[str, object]) -> None:
        for name, value in uniforms.items():
            set_uniform(program, name, value)
        self._targets[target].use()
        self._targets[target].clear()
        with self.gbuffer.on_surfaces():
            fullscreen(self._gl, program).render(vertices=3)
        self._gl.clear_samplers()

    def release(self) -> None:
        for thing in (*self._targets, self.origin, self.direction, self.shadow_vector, self.hit, self.met,
                      self.sent, self.reflected):
            thing.release()
