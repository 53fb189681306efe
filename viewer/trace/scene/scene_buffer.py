"""The scene buffer: all arrays of a scene that the tracer's shaders read, in one texture.

shaders/trace/scene_buffer.glsl reads it.
"""

from __future__ import annotations

import moderngl
import numpy as np

from ...errors import InputError
from ...gpu.row_texture import row_texture
from ..layout import SCENE_WIDTH


class SceneBufferBuilder:
    """Collects sections of texels, one after the other. `offsets` has the first texel of each section by its name."""

    def __init__(self) -> None:
        self.offsets: dict[str, int] = {}
        self.count = 0
        self._sections: list[np.ndarray] = []

    def add(self, name: str, texels: np.ndarray) -> int:
        """Append a section, (n, 4) uint32, or float32 whose bits are stored; returns its first texel.

        Shaders get that number as the uniform `u_<name>`.
        """
        if texels.dtype.itemsize != 4 or texels.ndim != 2 or texels.shape[1] != 4:
            raise ValueError(f"{name}: texels are (n, 4) of 32 bits, not {texels.shape} {texels.dtype}")
        if name in self.offsets:
            raise ValueError(f"there is a section {name} already")
        self.offsets[name] = self.count
        self._sections.append(np.ascontiguousarray(texels).view(np.uint32))
        self.count += len(texels)
        return self.offsets[name]

    def copy(self) -> SceneBufferBuilder:
        """Another builder with the same sections, to which more can be added."""
        copy = SceneBufferBuilder()
        copy.offsets, copy.count, copy._sections = dict(self.offsets), self.count, list(self._sections)
        return copy

    def uniforms(self) -> dict[str, int]:
        """The first texel of each section, by the name of its uniform."""
        return {f"u_{name}": offset for name, offset in self.offsets.items()}

    def texture(self, gl: moderngl.Context, scene_name: str = "") -> moderngl.Texture:
        """All sections as an RGBA32UI texture. Raises InputError if a texture of this OpenGL cannot hold them."""
        texels = np.concatenate([np.zeros((0, 4), np.uint32), *self._sections])
        most = SCENE_WIDTH * gl.info["GL_MAX_TEXTURE_SIZE"]
        return row_texture(gl, texels, InputError(
            scene_name, "", f"too many triangles to trace here: {self.count} texels of data, and a texture holds {most}"
        ), SCENE_WIDTH)
