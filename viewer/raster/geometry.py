"""Meshes on the GPU: the attributes that some program reads, each uploaded once."""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType

import moderngl
import numpy as np

from ..scene.mesh import Mesh
from ..scene.triangles import triangles_of

_FORMATS = {"a_position": "3f", "a_normal": "3f", "a_tangent": "4f", "a_color": "4f", "a_uv0": "2f", "a_uv1": "2f",
            "a_next": "3f"}
_OF_INSTANCES = {"a_indirect": "4f", "a_interior": "2f", "a_behind": "4f"}
# Values of attributes that a shared program reads and a mesh lacks: they change nothing.
_BLANK = {"a_tangent": (0.577, 0.577, 0.577, 1.0), "a_color": (1.0, 1.0, 1.0, 1.0), "a_uv0": (0.0, 0.0),
          "a_uv1": (0.0, 0.0)}
_PRIMITIVES = {"triangles": moderngl.TRIANGLES, "lines": moderngl.LINES, "points": moderngl.POINTS}


class MeshBuffers:
    """One mesh's buffers and its vertex arrays, one for each program it is drawn with.

    Positions are stored about the middle of the mesh's box, so that a mesh whose numbers are far from its origin keeps
    its digits in float32 arithmetic; `to_mesh` is the translation back.
    """

    def __init__(self, gl: moderngl.Context, mesh: Mesh) -> None:
        self._gl, self._mesh = gl, mesh
        self._buffers: dict[str, moderngl.Buffer] = {}
        self._arrays: dict[tuple[int, ...], moderngl.VertexArray] = {}
        self._sorted: moderngl.Buffer | None = None
        self.to_mesh = _to_mesh(mesh)
        self._next = mesh

    def move(self, mesh: Mesh) -> None:
        """Take the vertices of another mesh of the same layout. Only the arrays that differ are uploaded."""
        before = self._sources(self._mesh)
        self._mesh, self.to_mesh = mesh, _to_mesh(mesh)
        after = self._sources(mesh)
        for name, buffer in self._buffers.items():
            if after[name] is not before[name]:
                buffer.write(self._data(name))

    def follow(self, mesh: Mesh) -> np.ndarray:
        """Let a_next have the positions of a mesh of the same layout, about the middle of its box. Returns the
        translation back, as `to_mesh`."""
        if self._next is not mesh:
            self._next = mesh
            if "a_next" in self._buffers:
                self._buffers["a_next"].write(self._data("a_next"))
        return _to_mesh(mesh)

    def draw(self, program: moderngl.Program, order: np.ndarray | None = None,
             of_instance: Mapping[str, moderngl.Buffer] = MappingProxyType({})) -> None:
        """Draw with `program`. `order`, from `back_to_front`, replaces the mesh's own indices; `of_instance` has the
        attributes that belong to one instance's vertices: a_indirect, a_interior, a_behind."""
        if order is not None:
            data = np.ascontiguousarray(order, np.uint32)
            if self._sorted is None:
                self._sorted = self._gl.buffer(data, dynamic=True)
            else:
                self._sorted.write(data)
        self._array(program, order is not None, of_instance).render()

    def back_to_front(self, model: np.ndarray, forward: np.ndarray) -> np.ndarray | None:
        """Triangle indices, (3 M,), farthest first, for a mesh seen through `model` (eye-relative) along `forward`."""
        if self._mesh.topology != "triangles":
            return None
        triangles = triangles_of(self._mesh)
        along = (forward @ model[:3, :3]).astype(np.float32)
        depth = (self._mesh.positions @ along)[triangles].sum(axis=1)
        return triangles[np.argsort(-depth, kind="stable")].ravel()

    def _array(self, program: moderngl.Program, is_sorted: bool,
               of_instance: Mapping[str, moderngl.Buffer]) -> moderngl.VertexArray:
        key = (program.glo, is_sorted, *(buffer.glo for buffer in of_instance.values()))
        if key not in self._arrays:
            names = [name for name in _FORMATS if name in program]
            content = [(self._buffer(name), _FORMATS[name], name) for name in names]
            content += [(buffer, _OF_INSTANCES[name], name) for name, buffer in of_instance.items() if name in program]
            if is_sorted:
                index = self._sorted
            else:
                index = None if self._mesh.indices is None else self._buffer("indices")
            self._arrays[key] = self._gl.vertex_array(
                program, content, index_buffer=index, mode=_PRIMITIVES[self._mesh.topology]
            )
        return self._arrays[key]

    def _buffer(self, name: str) -> moderngl.Buffer:
        if name not in self._buffers:
            self._buffers[name] = self._gl.buffer(self._data(name))
        return self._buffers[name]

    @staticmethod
    def _sources(mesh: Mesh) -> dict[str, np.ndarray | None]:
        """The mesh's array for each buffer; None for what it lacks."""
        sources = dict.fromkeys(_FORMATS) | {
            "a_position": mesh.positions, "a_normal": mesh.normals, "a_tangent": mesh.tangents, "a_color": mesh.colors,
            "indices": mesh.indices}
        return sources | {f"a_uv{k}": uv for k, uv in enumerate(mesh.uvs)}

    def _data(self, name: str) -> np.ndarray:
        mesh = self._mesh
        if name == "a_position":
            return (mesh.positions - self.to_mesh[:3, 3]).astype(np.float32)
        if name == "a_next":
            return (self._next.positions - _to_mesh(self._next)[:3, 3]).astype(np.float32)
        array = self._sources(mesh)[name]
        if array is None:
            array = np.full((len(mesh.positions), len(_BLANK[name])), _BLANK[name], np.float32)
        return np.ascontiguousarray(array)

    def drop_arrays(self) -> None:
        """Release the vertex arrays, for when the programs have changed."""
        for array in self._arrays.values():
            array.release()
        self._arrays.clear()

    def release(self) -> None:
        self.drop_arrays()
        for buffer in (*self._buffers.values(), self._sorted):
            if buffer is not None:
                buffer.release()


def _to_mesh(mesh: Mesh) -> np.ndarray:
    matrix = np.eye(4)
    matrix[:3, 3] = mesh.bounds.mean(axis=0)
    return matrix
