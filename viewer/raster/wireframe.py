"""The edges of triangles, as thin lines over the picture."""

from __future__ import annotations

import moderngl
import numpy as np

from ..gpu.context import Context
from ..gpu.programs import Programs, matrix_uniform, set_uniform
from ..scene.frame import Frame
from ..scene.mesh import Mesh
from ..scene.triangles import triangles_of
from .target import Target

VERTEX, FRAGMENT = "raster/line.vert", "raster/line.frag"
WIDTH = 1.0
"""Of a line, in pixels of the picture."""
COLOR = (0.0, 0.0, 0.0, 0.8)
"""Black is black under every exposure and tone map."""
FULL_LENGTH = 8.0
"""In pixels of the picture: edges that look shorter are fainter."""
NEARER = 1.5
"""In pixels: by so much lines are nearer than their triangles."""


class Wireframe:
    """The edges of the meshes of the last frame on the GPU, each once."""

    def __init__(self, context: Context, programs: Programs) -> None:
        self._gl, self._programs = context.gl, programs
        self._edges: dict[Mesh, _Edges] = {}
        self._generation = programs.generation

    def draw(self, frame: Frame, target: Target) -> None:
        """Draw the edges of all triangles into the framebuffer in use, within `Depth.test()`. They hide nothing."""
        if self._generation != self._programs.generation:  # vertex arrays belong to programs
            self.release()
            self._generation = self._programs.generation
        program = self._programs.get(VERTEX, FRAGMENT, {})
        gl, scene, scale = self._gl, frame.scene, float(target.supersampling)
        width, height = frame.size
        pixel = frame.pixel_angle if frame.camera.height is None else frame.camera.height / frame.unit / height
        values = {
            "u_view_projection": matrix_uniform(frame.view_projection), "u_size": (width, height),
            "u_view_direction": tuple(-frame.camera.forward), "u_color": COLOR, "u_width": WIDTH * scale,
            "u_full_length": FULL_LENGTH * scale,
            "u_nearer": (NEARER * scale * pixel, 0.0) if frame.camera.height is None else (0.0, NEARER * scale * pixel)}
        for name, value in values.items():
            set_uniform(program, name, value)
        gl.enable_only(moderngl.DEPTH_TEST | moderngl.BLEND)
        gl.blend_func = moderngl.ONE, moderngl.ONE_MINUS_SRC_ALPHA
        target.framebuffer.depth_mask = False
        target.framebuffer.use()
        for mesh in self._edges.keys() - set(scene.meshes):
            self._edges.pop(mesh).release()
        for number, instance in enumerate(scene.instances):
            mesh = scene.meshes[instance.mesh]
            if mesh.topology == "triangles" and frame.visible[number]:
                edges = self._edges.get(mesh) or self._edges.setdefault(mesh, _Edges(gl, program, mesh))
                set_uniform(program, "u_model", matrix_uniform(frame.model(instance.transform @ edges.to_mesh)))
                edges.array.render(moderngl.TRIANGLE_STRIP, vertices=4, instances=edges.count)
        target.framebuffer.depth_mask = True
        target.framebuffer.use()

    def release(self) -> None:
        for edges in self._edges.values():
            edges.release()
        self._edges = {}


class _Edges:
    """Those of one mesh, about the middle of its box as in `viewer.raster.geometry`."""

    def __init__(self, gl: moderngl.Context, program: moderngl.Program, mesh: Mesh) -> None:
        middle = mesh.bounds.mean(axis=0)
        self.to_mesh = np.eye(4)
        self.to_mesh[:3, 3] = middle
        ends = (mesh.positions - middle)[edges_of(triangles_of(mesh))].astype(np.float32)
        self.count = len(ends)
        self._buffer = gl.buffer(np.ascontiguousarray(ends)) if self.count else gl.buffer(reserve=24)
        self.array = gl.vertex_array(program, [(self._buffer, "3f 3f/i", "a_from", "a_to")])

    def release(self) -> None:
        self.array.release()
        self._buffer.release()


def edges_of(triangles: np.ndarray) -> np.ndarray:
    """The edges (E, 2) of `triangles` (T, 3), each once, as numbers of vertices, the lesser one first."""
    pairs = np.sort(triangles[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2).astype(np.int64), axis=1)
    keys = np.unique(pairs[:, 0] << 32 | pairs[:, 1])
    return np.stack([keys >> 32, keys & 0xFFFFFFFF], axis=1)
