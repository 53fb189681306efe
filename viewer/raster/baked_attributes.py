"""What was baked for the vertices of each instance, as attributes on the GPU: light, and how thick solids are."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING

import moderngl
import numpy as np

from ..plan.model import Draw

if TYPE_CHECKING:
    from ..trace.vertex_light import VertexLight


class BakedAttributes:
    """The buffers of a scene. `drop_arrays` releases the vertex arrays that read them."""

    def __init__(self, gl: moderngl.Context, drop_arrays: Callable[[], None]) -> None:
        self._gl, self._drop_arrays = gl, drop_arrays
        self._indirect: list[moderngl.Buffer] = []
        self._interiors: dict[int, moderngl.Buffer] = {}
        self._behind: dict[int, moderngl.Buffer] = {}

    @property
    def has_indirect(self) -> bool:
        """Whether the vertices have indirect light."""
        return bool(self._indirect)

    def light_vertices(self, light: VertexLight, behind: Mapping[int, np.ndarray]) -> None:
        """Upload the indirect light of all vertices, and that behind the vertices of solids that scatter light."""
        if not self._indirect:
            self._indirect = [self._gl.buffer(reserve=max(values.nbytes, 16)) for values in light.per_instance]
        for buffer, values in zip(self._indirect, light.per_instance, strict=True):
            buffer.write(np.ascontiguousarray(values))
        for number, values in behind.items():
            if number not in self._behind:
                self._behind[number] = self._gl.buffer(reserve=max(values.nbytes, 16))
            self._behind[number].write(np.ascontiguousarray(values))

    def set_interiors(self, thickness: Mapping[int, np.ndarray]) -> None:
        """Upload what `viewer.trace.chords.thickness_at_vertices` has found of instances, (V, 7) float32 each.

        They take the place of those before.
        """
        self._drop_arrays()
        for buffer in self._interiors.values():
            buffer.release()
        self._interiors = {number: self._gl.buffer(np.ascontiguousarray(values))
                           for number, values in thickness.items()}

    def of(self, draw: Draw) -> dict[str, moderngl.Buffer]:
        """The attributes of the draw's program that belong to one instance's vertices."""
        found = {"a_indirect": self._indirect[draw.instance]} if draw.program.get("INDIRECT") else {}
        if draw.has_subsurface:
            found["a_interior"] = self._interiors[draw.instance]
            if draw.program["INDIRECT"]:
                found["a_behind"] = self._behind[draw.instance]
        return found

    def forget_light(self) -> None:
        """Release the light, for another scene."""
        if self._indirect:
            self._drop_arrays()
            for buffer in (*self._indirect, *self._behind.values()):
                buffer.release()
            self._indirect, self._behind = [], {}

    def release(self) -> None:
        self.forget_light()
        self.set_interiors({})
