"""The G-buffer: the visible surfaces, one sample a pixel, for passes that run before the surfaces are shaded.

shaders/raster/gbuffer.frag writes it: eye-relative position and perceptual roughness (0: an empty pixel), and shading
and face normal.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager

import moderngl

from ..scene.frame import Frame
from .depth import Depth

UNIT_POSITIONS, UNIT_NORMALS = range(2)


class GBuffer:
    """The targets of one size, with the surfaces of the last frame."""

    def __init__(self, gl: moderngl.Context, depth: Depth, size: tuple[int, int]) -> None:
        self._gl, self._depth, self.size = gl, depth, size
        self.positions, self._normals = (nearest_texture(gl, size, "f4") for _ in range(2))
        self._buffer = depth.renderbuffer(size)
        self._framebuffer = gl.framebuffer([self.positions, self._normals], self._buffer)

    def draw(self, draw_surfaces: Callable[[], object]) -> None:
        """Store the surfaces that `draw_surfaces()` draws. Leaves a framebuffer of its own in use."""
        self._framebuffer.use()
        self._framebuffer.clear(depth=self._depth.far)
        draw_surfaces()
        self._gl.clear_samplers()

    def target(self, *textures: moderngl.Texture) -> moderngl.Framebuffer:
        """A framebuffer of textures of this size, with the depth of the surfaces, read-only."""
        framebuffer = self._gl.framebuffer(textures, self._buffer)
        framebuffer.depth_mask = False  # not cleared either
        return framebuffer

    def bind(self, frame: Frame) -> dict[str, object]:
        """The uniforms of a pass that reads it; binds the textures to the units named above."""
        self.positions.use(UNIT_POSITIONS)
        self._normals.use(UNIT_NORMALS)
        return {"u_positions": UNIT_POSITIONS, "u_normals": UNIT_NORMALS,
                "u_view_direction": tuple(-frame.camera.forward)}

    @contextmanager
    def on_surfaces(self, also: int = moderngl.NOTHING) -> Iterator[None]:
        """Restrict a full-screen triangle to the pixels that have a surface."""
        self._gl.enable_only(moderngl.DEPTH_TEST | also)
        with self._depth.on_surfaces():
            yield

    def release(self) -> None:
        for thing in (self._framebuffer, self.positions, self._normals, self._buffer):
            thing.release()


def nearest_texture(gl: moderngl.Context, size: tuple[int, int], dtype: str) -> moderngl.Texture:
    """A texture of four channels without interpolation."""
    texture = gl.texture(size, 4, dtype=dtype)
    texture.filter = moderngl.NEAREST, moderngl.NEAREST
    return texture
