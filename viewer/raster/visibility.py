"""The pass before surfaces are shaded that finds how much of the environment each pixel sees."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from contextlib import contextmanager

import moderngl

from ..plan import Plan
from ..scene.scene import Scene
from .display import fullscreen
from .environment import EnvironmentLight
from .environment_shadows import UNIT_NORMALS, UNIT_POSITIONS, EnvironmentShadows
from .frame import Frame
from .programs import Programs, set_uniform
from .shadows import DrawDepth
from .surfaces import UNIT_BACKGROUND, UNIT_VISIBILITY


class VisibilityPass:
    """Keeps the targets of one picture size and the shadow maps of one scene's environment."""

    def __init__(self, gl: moderngl.Context, programs: Programs) -> None:
        self._gl, self._programs = gl, programs
        self._targets: _Targets | None = None
        self._shadows: EnvironmentShadows | None = None

    def prepare(self, scene: Scene, plan: Plan, environment: EnvironmentLight, draw_depth: DrawDepth) -> None:
        """Draw what shadow maps `plan` asks for and that are not there yet."""
        if self._shadows is None or not self._shadows.holds(scene.environment, plan):
            self.drop_shadows()
            lights = environment.many_lights(plan.environment_shadows)
            self._shadows = EnvironmentShadows(self._gl, scene, plan, lights, draw_depth)

    def drop_shadows(self) -> None:
        """For when the meshes or the programs are others."""
        if self._shadows is not None:
            self._shadows.release()
            self._shadows = None

    def find(self, frame: Frame, plan: Plan, draw_gbuffer: Callable[[], None]) -> dict[str, object]:
        """Draw the pass; returns the uniforms of shaders/raster/visibility.glsl.

        Leaves a framebuffer of its own in use. `draw_gbuffer()` draws shaders/raster/gbuffer.frag.
        """
        if self._targets is None or self._targets.size != frame.size:
            self._release_targets()
            self._targets = _Targets(self._gl, frame.size)
        self._targets.begin()
        draw_gbuffer()
        self._gl.clear_samplers()
        if plan.ambient_occlusion:
            return self._targets.find_by_picture(self._programs, frame)
        return self._targets.find_by_shadows(self._programs, frame, self._shadows)

    def _release_targets(self) -> None:
        if self._targets is not None:
            self._targets.release()
            self._targets = None  # should the next one fail

    def release(self) -> None:
        self.drop_shadows()
        self._release_targets()


class _Targets:
    """The buffers of one picture size, and the passes over them."""

    def __init__(self, gl: moderngl.Context, size: tuple[int, int]) -> None:
        self._gl, self.size = gl, size
        self._layout = [_texture(gl, size, "f4") for _ in range(2)]
        self._sums = [_texture(gl, size, "f4") for _ in range(2)]
        self._visible = _texture(gl, size, "f2")
        self._depth = gl.depth_renderbuffer(size)
        self.gbuffer = gl.framebuffer(self._layout, self._depth)
        self._summing = gl.framebuffer(self._sums, self._depth)
        self._summing.depth_mask = False  # nor cleared
        self._result = gl.framebuffer([self._visible], self._depth)
        self._result.depth_mask = False

    def begin(self) -> None:
        self.gbuffer.use()
        self.gbuffer.clear(depth=1.0)

    def find_by_shadows(self, programs: Programs, frame: Frame, shadows: EnvironmentShadows) -> dict[str, object]:
        gl = self._gl
        self._summing.use()
        self._summing.clear()
        gl.blend_func = moderngl.ONE, moderngl.ONE
        with self._on_surfaces(moderngl.BLEND):
            shadows.add(programs, frame, self._buffers(frame))
        gl.enable_only(moderngl.NOTHING)
        self._result.use()
        program = programs.get("display/fullscreen.vert", "raster/visibility.frag", {})
        for unit, (name, texture) in enumerate(zip(("u_arriving", "u_sent"), self._sums, strict=True)):
            texture.use(unit)
            set_uniform(program, name, unit)
        fullscreen(gl, program).render(vertices=3)
        return self._found()

    def find_by_picture(self, programs: Programs, frame: Frame) -> dict[str, object]:
        """By what else is in the picture: ambient occlusion."""
        self._result.use()
        program = programs.get("display/fullscreen.vert", "raster/ambient_occlusion.frag", {
            "IS_ORTHOGRAPHIC": int(frame.camera.height is not None)})
        pose, height = frame.camera.pose, frame.camera.height
        extent = 2 * math.tan(frame.camera.fov_y / 2) if height is None else height / frame.unit
        for name, value in (self._buffers(frame) | {
                "u_right": tuple(pose[:3, 0]), "u_up": tuple(pose[:3, 1]), "u_pixels": frame.size[1] / extent}).items():
            set_uniform(program, name, value)
        with self._on_surfaces(moderngl.NOTHING):
            fullscreen(self._gl, program).render(vertices=3)
        return self._found()

    def _buffers(self, frame: Frame) -> dict[str, object]:
        self._layout[0].use(UNIT_POSITIONS)
        self._layout[1].use(UNIT_NORMALS)
        return {"u_positions": UNIT_POSITIONS, "u_normals": UNIT_NORMALS,
                "u_view_direction": tuple(-frame.camera.forward)}

    @contextmanager
    def _on_surfaces(self, also: int) -> Iterator[None]:
        """Where the triangle on the far plane lies behind a surface: elsewhere no program runs."""
        self._gl.enable_only(moderngl.DEPTH_TEST | also)
        self._gl.depth_func = ">"
        yield
        self._gl.depth_func = "<"

    def _found(self) -> dict[str, object]:
        self._visible.use(UNIT_VISIBILITY)
        self._layout[0].use(UNIT_BACKGROUND)
        return {"u_visibility": UNIT_VISIBILITY, "u_positions": UNIT_BACKGROUND}

    def release(self) -> None:
        for thing in (self.gbuffer, self._summing, self._result, *self._layout, *self._sums, self._visible,
                      self._depth):
            thing.release()


def _texture(gl: moderngl.Context, size: tuple[int, int], dtype: str) -> moderngl.Texture:
    texture = gl.texture(size, 4, dtype=dtype)
    texture.filter = (moderngl.NEAREST, moderngl.NEAREST)
    return texture
