"""What the tracer's shaders read of a scene as one texture of 32-bit words (shaders/trace/words.glsl)."""

from __future__ import annotations

import moderngl
import numpy as np

from ...errors import InputError
from ..layout import SCENE_WIDTH


class WordsBuilder:
    """Sections of words, one behind the other; `offsets` has each one's first word by its name."""

    def __init__(self) -> None:
        self.offsets: dict[str, int] = {}
        self.count = 0
        self._sections: list[np.ndarray] = []

    def add(self, name: str, words: np.ndarray) -> int:
        """Append a section of words, (n, 4) uint32, or float32 whose bits are kept; returns its first word.

        Shaders have that as the uniform `u_<name>`.
        """
        if words.dtype.itemsize != 4 or words.ndim != 2 or words.shape[1] != 4:
            raise ValueError(f"{name}: words are (n, 4) of 32 bits, not {words.shape} {words.dtype}")
        if name in self.offsets:
            raise ValueError(f"there is a section {name} already")
        self.offsets[name] = self.count
        self._sections.append(np.ascontiguousarray(words).view(np.uint32))
        self.count += len(words)
        return self.offsets[name]

    def copy(self) -> WordsBuilder:
        """Another with the same sections, to which more can be added."""
        copy = WordsBuilder()
        copy.offsets, copy.count, copy._sections = dict(self.offsets), self.count, list(self._sections)
        return copy

    def uniforms(self) -> dict[str, int]:
        """Where each section begins, by the name that shaders have for it."""
        return {f"u_{name}": offset for name, offset in self.offsets.items()}

    def texture(self, gl: moderngl.Context, scene_name: str = "") -> moderngl.Texture:
        """All sections as an RGBA32UI texture. Raises InputError for more than a texture of this OpenGL holds."""
        height = max(-(-self.count // SCENE_WIDTH), 1)
        limit = gl.info["GL_MAX_TEXTURE_SIZE"]
        if height > limit:
            raise InputError(scene_name, "", f"too many triangles to trace here: {self.count} words of data, "
                                             f"and a texture holds {SCENE_WIDTH * limit}")
        texture = gl.texture((SCENE_WIDTH, height), 4, dtype="u4")
        texture.filter = moderngl.NEAREST, moderngl.NEAREST
        words = np.zeros((height * SCENE_WIDTH, 4), np.uint32)
        if self._sections:
            np.concatenate(self._sections, out=words[: self.count])
        texture.write(words)
        return texture
