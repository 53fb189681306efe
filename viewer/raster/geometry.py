"""Meshes on the GPU: the attributes that some program reads, each uploaded once."""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType

import moderngl
import numpy as np

from ..gpu.buffer_texture import BufferTexture
from ..gpu.context import Context
from ..scene.mesh import Mesh
from ..scene.scene import Instance, Scene
from ..scene.triangles import triangles_of
from .instances import Content, InstanceBuffers, parts_of

_FORMATS = {"a_position": "3f", "a_normal": "3f", "a_tangent": "4f", "a_color": "4f", "a_uv0": "2f", "a_uv1": "2f",
            "a_next": "3f"}
_OF_INSTANCES = {"a_indirect": {"a_indirect": 4}, "a_interior": {"a_interior": 4, "a_other_side": 3},
                 "a_behind": {"a_behind": 4}}
"""The attributes in each buffer, and their numbers of floats."""
# Values of attributes that a shared program reads and a mesh lacks: they change nothing.
_BLANK = {"a_tangent": (0.577, 0.577, 0.577, 1.0), "a_color": (1.0, 1.0, 1.0, 1.0), "a_uv0": (0.0, 0.0),
          "a_uv1": (0.0, 0.0)}
_PRIMITIVES = {"triangles": moderngl.TRIANGLES, "lines": moderngl.LINES, "points": moderngl.POINTS}


class MeshBuffers:
    """One mesh's buffers and its vertex arrays, one for each program it is drawn with.

    Positions are stored about the middle of the mesh's box, so that a mesh whose numbers are far from its origin keeps
    its digits in float32 arithmetic; `to_mesh` is the translation back.
    """

    def __init__(self, context: Context, mesh: Mesh) -> None:
        self._context, self._gl, self._mesh = context, context.gl, mesh
        self._buffers: dict[str, moderngl.Buffer] = {}
        self._arrays: dict[tuple[int, ...], moderngl.VertexArray] = {}
        self._sorted: moderngl.Buffer | None = None
        self._texels: BufferTexture | None = None
        self.to_mesh = _to_mesh(mesh)
        self._next = mesh
        self._parts: list[InstanceBuffers] = []
        self._placed: tuple[tuple[Instance, ...], float, tuple[int, ...]] | None = None

    def move(self, mesh: Mesh) -> None:
        """Take the vertices of another mesh of the same layout. Only the arrays that differ are uploaded."""
        before = self._sources(self._mesh)
        self._mesh, self.to_mesh, self._placed = mesh, _to_mesh(mesh), None
        after = self._sources(mesh)
        for name, buffer in self._buffers.items():
            if after[name] is not before[name]:
                buffer.write(self._data(name))
        self._drop_texels()

    def follow(self, mesh: Mesh) -> np.ndarray:
        """Let a_next have the positions of a mesh of the same layout, about the middle of its box. Returns the
        translation back, as `to_mesh`."""
        if self._next is not mesh:
            self._next = mesh
            if "a_next" in self._buffers:
                self._buffers["a_next"].write(self._data("a_next"))
        return _to_mesh(mesh)

    def instances(self, scene: Scene, numbers: tuple[int, ...]) -> list[InstanceBuffers]:
        """The mesh's instances `numbers` in a scene, in parts that `draw_instances` can draw."""
        held = self._placed
        if held is None or held[0] is not scene.instances or held[1:] != (scene.radius, numbers):
            self._place(scene, numbers)
            self._placed = scene.instances, scene.radius, numbers
        return self._parts

    def _place(self, scene: Scene, numbers: tuple[int, ...]) -> None:
        found = parts_of(scene, numbers, len(self._mesh.positions))
        if [(part.hand, part.count) for part in self._parts] != [(hand, len(which)) for hand, which, _ in found]:
            self.drop_arrays()
            for part in self._parts:
                part.release()
            size = len(self._mesh.positions)
            self._parts = [InstanceBuffers(self._gl, hand, len(which), size) for hand, which, _ in found]
        for part, (_, which, normals) in zip(self._parts, found, strict=True):
            part.place(scene, which, self.to_mesh, normals)

    def draw_instances(self, program: moderngl.Program, part: InstanceBuffers, count: int) -> None:
        """Draw `count` instances, those that `part` shows, with `program`."""
        key = (program.glo, *part.key)
        if key not in self._arrays:
            self._arrays[key] = self._new_array(program, part.content(program), self._own_indices())
        if count:
            self._arrays[key].render(instances=count)
        if self._context.is_software and part.is_large:  # it would hold the vertices of all parts until the frame ends
            self._gl.finish()

    @property
    def triangles_and_vertices(self) -> BufferTexture:
        """A texel for each triangle, with the numbers of its vertices, and four for each vertex: position about the
        middle, normal, tangent, and the second texture coordinates. The first are in w of position and normal."""
        if self._texels is None:
            triangles, count = triangles_of(self._mesh), len(self._mesh.positions)
            texels = np.zeros((len(triangles) + 4 * count, 4), np.float32)
            texels[:len(triangles), :3] = triangles
            vertices = texels[len(triangles):].reshape(count, 4, 4)
            vertices[:, 0, :3] = self._data("a_position")
            if self._mesh.normals is not None:
                vertices[:, 1, :3] = self._mesh.normals
            vertices[:, 2] = self._data("a_tangent")
            vertices[:, :2, 3] = self._data("a_uv0")
            vertices[:, 3, :2] = self._data("a_uv1")
            self._texels = BufferTexture(self._context, texels)
        return self._texels

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
            content: list[Content] = [_of_buffer(program, buffer, _OF_INSTANCES[name])
                                      for name, buffer in of_instance.items() if name in program]
            self._arrays[key] = self._new_array(program, content, self._sorted if is_sorted else self._own_indices())
        return self._arrays[key]

    def _own_indices(self) -> moderngl.Buffer | None:
        return None if self._mesh.indices is None else self._buffer("indices")

    def _new_array(self, program: moderngl.Program, content: list[Content],
                   indices: moderngl.Buffer | None) -> moderngl.VertexArray:
        """A vertex array of the mesh's attributes that `program` reads, and of `content`."""
        own: list[Content] = [(self._buffer(name), form, name) for name, form in _FORMATS.items() if name in program]
        return self._gl.vertex_array(program, own + content, index_buffer=indices,
                                     mode=_PRIMITIVES[self._mesh.topology])

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

    def _drop_texels(self) -> None:
        if self._texels is not None:
            self._texels.release()
            self._texels = None

    def drop_arrays(self) -> None:
        """Release the vertex arrays, for when the programs have changed."""
        for array in self._arrays.values():
            array.release()
        self._arrays.clear()

    def release(self) -> None:
        self.drop_arrays()
        self._drop_texels()
        for thing in (*self._buffers.values(), self._sorted, *self._parts):
            if thing is not None:
                thing.release()


def _of_buffer(program: moderngl.Program, buffer: moderngl.Buffer, floats: Mapping[str, int]) -> Content:
    """What `program` reads of a buffer with these attributes of so many floats."""
    forms = " ".join(f"{count}f" if name in program else f"{4 * count}x" for name, count in floats.items())
    return buffer, forms, *(name for name in floats if name in program)


def _to_mesh(mesh: Mesh) -> np.ndarray:
    matrix = np.eye(4)
    matrix[:3, 3] = mesh.bounds.mean(axis=0)
    return matrix
