"""The pass before surfaces are shaded that finds how much of the environment each pixel sees."""

from __future__ import annotations

import math
from collections.abc import Iterator
from contextlib import contextmanager

import moderngl

from .display import fullscreen
from .environment_shadows import UNIT_NORMALS, UNIT_POSITIONS, EnvironmentShadows
from .frame import Frame
from .programs import Programs, set_uniform
from .surfaces import UNIT_BACKGROUND, UNIT_VISIBILITY


class Visibility:
    """The targets of one picture size."""

    def __init__(self, gl: moderngl.Context, size: tuple[int, int]) -> None:
        self._gl, self.size = gl, size
        self._layout = [_texture(gl, size, "f4") for _ in range(2)]
        self._sums = [_texture(gl, size, "f4") for _ in range(2)]
        self._visible = _texture(gl, size, "f2")
        self._depth = gl.depth_renderbuffer(size)
        self.gbuffer = gl.framebuffer(self._layout, self._depth)
        """What `Surfaces.draw_gbuffer` draws into."""
        self._summing = gl.framebuffer(self._sums, self._depth)
        self._summing.depth_mask = False  # nor cleared
        self._result = gl.framebuffer([self._visible], self._depth)
        self._result.depth_mask = False

    def begin(self) -> None:
        self.gbuffer.use()
        self.gbuffer.clear(depth=1.0)

    def find(self, programs: Programs, frame: Frame, shadows: EnvironmentShadows) -> dict[str, object]:
        """By the shadows of many lights. Returns the uniforms of shaders/raster/visibility.glsl.

        From what was drawn into the buffers. Leaves a framebuffer of its own in use.
        """
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
        """As `find`, by what else is in the picture: ambient occlusion."""
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
