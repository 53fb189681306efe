"""The pass that traces light through solid glass: two paths from each shaded point of its front, one refracted and one
reflected, followed from surface to surface with the path tracer's intersector."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import TYPE_CHECKING

import moderngl

from ...base.reusable import Reusable
from ...gpu.context import Context
from ...gpu.fullscreen import fullscreen
from ...gpu.programs import Programs, set_uniform
from ...gpu.ray_textures import WholeTextures
from ...plan.model import Plan
from ...scene.frame import Frame
from ...scene.scene import Scene
from ..depth import Depth
from ..gbuffer import nearest_texture
from ..units import UNIT_MIRRORED, UNIT_PATH_POSITIONS, UNIT_REFRACTED

if TYPE_CHECKING:
    from .refracting_surfaces import RefractingSurfaces

STEPS = 8
"""The most surfaces that a path hits after the first one."""

_UNIT_HIT, _UNIT_SURFACES, _UNIT_STATE = 0, 1, 2
_GREEN = 1  # the band of a path that stands for all three
_STATE = ("origin", "direction", "throughput", "light")
_KINDS = {"u_refracted": UNIT_REFRACTED, "u_mirrored": UNIT_MIRRORED}

Uniforms = dict[str, object]


class TracedRefraction:
    """Owns the paths of one picture size, and the surfaces of one scene that they can hit.

    `kind` of intersector as `viewer.trace.rays.intersect.make_intersector` takes it.
    """

    def __init__(self, context: Context, programs: Programs, depth: Depth, kind: str = "auto") -> None:
        self._context, self._programs, self._depth, self._kind = context, programs, depth, kind
        self._surfaces: Reusable[RefractingSurfaces] = Reusable()
        self._paths: Reusable[_Paths] = Reusable()

    def prepare(self, scene: Scene) -> None:
        """Prepare the surfaces of `scene`, unless they are ready."""
        from .refracting_surfaces import RefractingSurfaces

        self._surfaces.get(lambda held: held.holds(scene),
                           lambda: RefractingSurfaces(self._context, scene, self._kind))

    def find(self, frame: Frame, plan: Plan, draw_rays: Callable[[Uniforms], object], uniforms: Uniforms) -> Uniforms:
        """Follow the paths that `draw_rays(uniforms)` begins and return the uniforms of traced_refraction.glsl.

        `uniforms` are those of the frame, the backdrop among them. Leaves a framebuffer of its own in use.
        """
        paths = self._paths.get(lambda held: held.size == frame.size,
                                lambda: _Paths(self._context.gl, self._depth, frame.size))
        environment = frame.scene.environment
        program = self._programs.get("display/fullscreen.vert", "raster/refraction_step.frag", {
            "HAS_ENVIRONMENT": int(plan.reflections), "REFLECTS": 1,
            "ENVIRONMENT_ROTATED": int(environment is not None and environment.rotation != 0),
            "BANDS": int(plan.has_dispersion),
            **self._surfaces.held.defines})
        uniforms = uniforms | {"u_eye": tuple((frame.camera.eye - frame.scene.center) / frame.unit)}
        for name, value in uniforms.items():
            set_uniform(program, name, value)
        for kind in range(len(_KINDS) if plan.reflections else 1):
            bands = range(3) if plan.has_dispersion and kind == 0 else [_GREEN]
            for band in bands:
                set_uniform(program, "u_band", band)
                paths.begin(kind, partial(draw_rays, uniforms | {"u_is_mirrored": kind == 1, "u_band": band}))
                self._follow(paths, program)
                if len(bands) > 1:
                    paths.gather(self._programs, is_first=band == 0)
        return paths.bind()

    def _follow(self, paths: _Paths, program: moderngl.Program) -> None:
        surfaces = self._surfaces.held
        intersector = surfaces.intersector
        for _ in range(STEPS):
            answer = intersector.trace(intersector.fetch(paths))
            if answer.alive == 0:
                break
            intersector.store(paths, answer)
            for name, value in surfaces.bind(_UNIT_SURFACES).items():
                set_uniform(program, name, value)
            paths.advance(program)

    def release(self) -> None:
        self._surfaces.release()
        self._paths.release()


class _Paths(WholeTextures):
    """The textures that `viewer.trace.rays.intersect.WavefrontTextures` describes, a path for each pixel, and the
    state of each path: twice, to be read and written in turn. The light of each kind of path stays."""

    def __init__(self, gl: moderngl.Context, depth: Depth, size: tuple[int, int]) -> None:
        self._gl, self._depth, self.size = gl, depth, size
        self.positions, self.shadow_vector = (nearest_texture(gl, size, "f4") for _ in range(2))
        self.shadow_origin = self.shadow_vector
        self.hit = nearest_texture(gl, size, "u4")
        self._buffer = depth.renderbuffer(size)
        self._rays = [[nearest_texture(gl, size, "f4") for _ in _STATE[:-1]] for _ in range(2)]
        self._lights = [[nearest_texture(gl, size, "f4") for _ in range(2)] for _ in _KINDS]
        self._firsts = [gl.framebuffer([self.positions, *self._rays[0], light[0]], self._buffer)
                        for light in self._lights]
        self._nexts = [[gl.framebuffer([*rays, texture], self._buffer) for rays, texture in zip(self._rays, light)]
                       for light in self._lights]
        for framebuffer in sum(self._nexts, []):
            framebuffer.depth_mask = False
        self._no_shadow = gl.framebuffer([self.shadow_vector])
        self._no_shadow.clear()
        self._kind, self._now = 0, [0] * len(_KINDS)
        self._sum: moderngl.Texture | None = None
        self._has_sum = False

    @property
    def _state(self) -> list[moderngl.Texture]:
        now = self._now[self._kind]
        return [*self._rays[now], self._lights[self._kind][now]]

    @property
    def origin(self) -> moderngl.Texture:
        return self._state[0]

    @property
    def direction(self) -> moderngl.Texture:
        return self._state[1]

    def begin(self, kind: int, draw_rays: Callable[[], object]) -> None:
        """Begin the paths that `draw_rays()` draws."""
        self._kind, self._now[kind] = kind, 0
        self._firsts[kind].use()
        self._firsts[kind].clear(depth=self._depth.far)
        draw_rays()
        self._gl.clear_samplers()
        self._nexts[kind][1].clear()

    def advance(self, program: moderngl.Program) -> None:
        """Take each path from its hit to the next ray."""
        self.hit.use(_UNIT_HIT)
        set_uniform(program, "u_hit", _UNIT_HIT)
        for unit, (name, texture) in enumerate(zip(_STATE, self._state), _UNIT_STATE):
            texture.use(unit)
            set_uniform(program, f"u_{name}", unit)
        self._now[self._kind] ^= 1
        self._nexts[self._kind][self._now[self._kind]].use()
        self._gl.enable_only(moderngl.DEPTH_TEST)
        with self._depth.on_surfaces():  # where a path began
            fullscreen(self._gl, program).render(vertices=3)

    def gather(self, programs: Programs, is_first: bool) -> None:
        """Add the light of the paths to that of other bands, which stays until the first band of another picture."""
        if self._sum is None:
            self._sum = nearest_texture(self._gl, self.size, "f4")
            self._sum_target = self._gl.framebuffer([self._sum])
        self._sum_target.use()
        if is_first:
            self._sum_target.clear()
        program = programs.get("display/fullscreen.vert", "raster/backdrop.frag", {"LEVEL": 0})
        self._lights[self._kind][self._now[self._kind]].use(_UNIT_STATE)
        set_uniform(program, "u_source", _UNIT_STATE)
        self._gl.enable_only(moderngl.BLEND)
        self._gl.blend_func = moderngl.ONE, moderngl.ONE
        fullscreen(self._gl, program).render(vertices=3)
        self._has_sum = True

    def bind(self) -> dict[str, object]:
        """The uniforms of shaders/raster/traced_refraction.glsl."""
        for light, now, unit in zip(self._lights, self._now, _KINDS.values()):
            light[now].use(unit)
        if self._has_sum and self._sum is not None:
            self._sum.use(_KINDS["u_refracted"])
            self._has_sum = False
        self.positions.use(UNIT_PATH_POSITIONS)
        return _KINDS | {"u_path_positions": UNIT_PATH_POSITIONS}

    def release(self) -> None:
        for thing in (*self._firsts, *sum(self._nexts, []), self._no_shadow, self._buffer, self.positions,
                      self.shadow_vector, self.hit, *sum(self._rays, []), *sum(self._lights, [])):
            thing.release()
        if self._sum is not None:
            self._sum_target.release()
            self._sum.release()
