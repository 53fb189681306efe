"""The pass that traces reflections of the model: rays from each shaded point, with the path tracer's intersector. The
radiance at their hits is interpolated between values baked at the vertices."""

from __future__ import annotations

from typing import TYPE_CHECKING

import moderngl

from ...base.reusable import Reusable
from ...gpu.context import Context
from ...gpu.fullscreen import fullscreen
from ...gpu.programs import Programs, set_uniform
from ...gpu.ray_textures import WholeTextures
from ...scene.frame import Frame
from ...scene.scene import Scene
from ...settings import Settings
from ..gbuffer import UNIT_NORMALS, GBuffer, nearest_texture
from ..units import UNIT_RAY_POSITIONS, UNIT_REFLECTED

if TYPE_CHECKING:
    from .reflected_surfaces import ReflectedSurfaces

RAYS = 16
"""From each point of a picture that is kept. A frame of a moving camera has one. Those of 16 points share a lobe."""


class TracedReflections:
    """Owns the rays of one picture size, and the surfaces of one scene that they can hit.

    `kind` of intersector as `viewer.trace.rays.intersect.make_intersector` takes it.
    """

    def __init__(self, context: Context, programs: Programs, kind: str = "auto") -> None:
        self._context, self._programs, self._kind = context, programs, kind
        self._surfaces: Reusable[ReflectedSurfaces] = Reusable()
        self._rays: Reusable[_Rays] = Reusable()

    def prepare(self, scene: Scene, settings: Settings) -> None:
        """Prepare the surfaces of `scene`, unless they are ready."""
        from .reflected_surfaces import ReflectedSurfaces

        self._surfaces.get(lambda held: held.holds(scene),
                           lambda: ReflectedSurfaces(self._context, scene, settings, self._kind, self._programs))

    def find(self, frame: Frame, gbuffer: GBuffer, uniforms: dict[str, object], still: bool) -> dict[str, object]:
        """Trace rays from each pixel of the G-buffer and return the uniforms of traced_reflection.glsl; `uniforms`
        has the environment. `still` is for a picture that is kept.

        Leaves a framebuffer of its own in use.
        """
        surfaces = self._surfaces.held
        rays = self._rays.get(lambda held: held.gbuffer is gbuffer, lambda: _Rays(self._context.gl, gbuffer))
        intersector = surfaces.intersector
        count = RAYS if still else 1
        for number in range(count):
            rays.begin(self._programs, frame, number, count)
            intersector.store(rays, intersector.trace(intersector.fetch(rays)))
            rays.shade(self._programs, frame, uniforms, surfaces, number, count)
        rays.average(self._programs, frame)
        rays.reflected.use(UNIT_REFLECTED)
        rays.places.use(UNIT_RAY_POSITIONS)
        return {"u_reflected": UNIT_REFLECTED, "u_ray_positions": UNIT_RAY_POSITIONS}

    def release(self) -> None:
        self._surfaces.release()
        self._rays.release()


class _Rays(WholeTextures):
    """The textures that `viewer.trace.rays.intersect.WavefrontTextures` describes, one path per G-buffer pixel.

    `hit_radiance` and `environment` are the means over a pixel's rays, `reflected` is their filtered mean, and `places`
    are where it was found.
    """

    def __init__(self, gl: moderngl.Context, gbuffer: GBuffer) -> None:
        self._gl, self.gbuffer = gl, gbuffer
        self.origin, self.direction, self.shadow_vector = (nearest_texture(gl, gbuffer.size, "f4") for _ in range(3))
        self.shadow_origin = self.shadow_vector
        self.hit = nearest_texture(gl, gbuffer.size, "u4")
        self.hit_radiance, self.environment, self.reflected = (
            nearest_texture(gl, gbuffer.size, "f2") for _ in range(3))
        self.places = nearest_texture(gl, gbuffer.size, "f4")
        no_shadow = gl.framebuffer([self.shadow_vector])
        no_shadow.clear()
        no_shadow.release()
        targets = (self.origin, self.direction), (self.hit_radiance, self.environment), (self.reflected, self.places)
        self._targets = [gbuffer.target(*textures) for textures in targets]

    def begin(self, programs: Programs, frame: Frame, number: int, count: int) -> None:
        """Write ray `number` of `count` of each of the frame's surfaces."""
        program = programs.get("display/fullscreen.vert", "raster/reflection_rays.frag", {
            "IS_ORTHOGRAPHIC": int(frame.camera.height is not None)})
        eye = (frame.camera.eye - frame.scene.center) / frame.unit
        self._draw(program, 0, self.gbuffer.bind(frame) | {"u_eye": tuple(eye), "u_number": number, "u_count": count})

    def shade(
        self, programs: Programs, frame: Frame, uniforms: dict[str, object], surfaces: ReflectedSurfaces,
        number: int, count: int,
    ) -> None:
        """Add the radiance at each ray's hit, and the environment's light that it occludes."""
        program = programs.get("display/fullscreen.vert", "raster/reflected_light.frag", {
            "REFLECTS": 1, "ENVIRONMENT_ROTATED": 1, **surfaces.defines})
        self.hit.use(UNIT_NORMALS + 1)
        self.direction.use(UNIT_NORMALS + 2)
        rays = {"u_hit": UNIT_NORMALS + 1, "u_direction": UNIT_NORMALS + 2}
        uniforms = uniforms | self.gbuffer.bind(frame) | rays | surfaces.bind(UNIT_NORMALS + 3)
        self._gl.blend_func = moderngl.ONE, moderngl.ONE
        self._draw(program, 1, uniforms | {"u_count": count}, adds=number > 0)

    def average(self, programs: Programs, frame: Frame) -> None:
        """Write the joint bilateral mean over neighbouring rays."""
        program = programs.get("display/fullscreen.vert", "raster/reflected_mean.frag", {})
        self.hit_radiance.use(UNIT_NORMALS + 1)
        self.environment.use(UNIT_NORMALS + 2)
        rays = {"u_hit_radiance": UNIT_NORMALS + 1, "u_environment": UNIT_NORMALS + 2}
        self._draw(program, 2, self.gbuffer.bind(frame) | rays)

    def _draw(self, program: moderngl.Program, target: int, uniforms: dict[str, object], adds: bool = False) -> None:
        for name, value in uniforms.items():
            set_uniform(program, name, value)
        self._targets[target].use()
        if not adds:
            self._targets[target].clear()
        with self.gbuffer.on_surfaces(moderngl.BLEND if adds else moderngl.NOTHING):
            fullscreen(self._gl, program).render(vertices=3)
        self._gl.clear_samplers()

    def release(self) -> None:
        for thing in (*self._targets, self.origin, self.direction, self.shadow_vector, self.hit,
                      self.hit_radiance, self.environment, self.reflected, self.places):
            thing.release()
