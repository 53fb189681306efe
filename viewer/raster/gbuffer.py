"""The G-buffer: the visible surfaces, one sample a pixel, for passes that run before the surfaces are shaded.

shaders/raster/gbuffer.frag writes it: eye-relative position and perceptual roughness (0: an empty pixel; negative: a
metal), and shading and face normal.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager

import moderngl
import numpy as np

from ..scene.frame import Frame
from .depth import Depth

UNIT_POSITIONS, UNIT_NORMALS = range(2)


class GBuffer:
    """The targets of one size, with the surfaces of the last frame.

    They are `count` textures of four floats; `bind` and those who read it want the two above.
    """

    def __init__(self, gl: moderngl.Context, depth: Depth, size: tuple[int, int], count: int = 2) -> None:
        self._gl, self._depth, self.size, self.count = gl, depth, size, count
        self._textures = [nearest_texture(gl, size, "f4") for _ in range(count)]
        self._buffer = depth.renderbuffer(size)
        self._framebuffer = gl.framebuffer(self._textures, self._buffer)

    @property
    def positions(self) -> moderngl.Texture:
        return self._textures[0]

    def draw(self, draw_surfaces: Callable[[], object]) -> None:
        """Store the surfaces that `draw_surfaces()` draws. Leaves a framebuffer of its own in use."""
        self._framebuffer.use()
        self._framebuffer.clear(depth=self._depth.far)
        draw_surfaces()
        self._gl.clear_samplers()

    def read(self, place: int) -> np.ndarray:
        """Texture number `place`, (H, W, 4) float32, row 0 at the top."""
        width, height = self.size
        pixels = np.frombuffer(self._framebuffer.read(components=4, attachment=place, dtype="f4"), np.float32)
        return pixels.reshape(height, width, 4)[::-1]

    def target(self, *textures: moderngl.Texture) -> moderngl.Framebuffer:
        """A framebuffer of textures of this size, with the depth of the surfaces, read-only."""
        framebuffer = self._gl.framebuffer(textures, self._buffer)
        framebuffer.depth_mask = False  # not cleared either
        return framebuffer

    def bind(self, frame: Frame) -> dict[str, object]:
        """The uniforms of a pass that reads it; binds the textures to the units named above."""
        self.positions.use(UNIT_POSITIONS)
        self._textures[1].use(UNIT_NORMALS)
        return {"u_positions": UNIT_POSITIONS, "u_normals": UNIT_NORMALS,
                "u_view_direction": tuple(-frame.camera.forward)}

    @contextmanager
    def on_surfaces(self, also: int = moderngl.NOTHING) -> Iterator[None]:
        """Restrict a full-screen triangle to the pixels that have a surface."""
        self._gl.enable_only(moderngl.DEPTH_TEST | also)
        with self._depth.on_surfaces():
            yield

    def release(self) -> None:
        for thing in (self._framebuffer, *self._textures, self._buffer):
            thing.release()


def nearest_texture(gl: moderngl.Context, size: tuple[int, int], dtype: str) -> moderngl.Texture:
    """A texture of four channels without interpolation."""
    texture = gl.texture(size, 4, dtype=dtype)
    texture.filter = moderngl.NEAREST, moderngl.NEAREST
    return texture
