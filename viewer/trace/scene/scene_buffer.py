"""The scene buffer: all arrays of a scene that the tracer's shaders read, in one buffer texture.

shaders/trace/scene_buffer.glsl reads it.
"""

from __future__ import annotations

import numpy as np

from ...errors import InputError
from ...gpu.buffer_texture import BufferTexture, most_texels
from ...gpu.context import Context


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

    def texture(self, context: Context, scene_name: str = "") -> BufferTexture:
        """All sections. Raises InputError if a buffer texture of this OpenGL cannot hold them."""
        most = most_texels(context)
        if self.count > most:
            raise InputError(scene_name, "", f"too many triangles to trace here: {self.count} texels of data, and a "
                                             f"buffer holds {most}")
        return BufferTexture(context, np.concatenate(self._sections) if self.count else np.zeros((1, 4), np.uint32))
