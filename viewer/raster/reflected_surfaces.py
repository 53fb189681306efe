"""What reflections can meet of a scene: its opaque triangles to be traced, and the light that leaves them."""

from __future__ import annotations

from dataclasses import replace

import moderngl
import numpy as np

from ..errors import ViewerError
from ..gpu.context import Context
from ..scene.scene import Scene
from ..settings import Settings
from ..trace.geometry import GLASS, TraceGeometry, trace_geometry
from ..trace.intersect import make_intersector
from ..trace.vertex_light import VertexLight, bake_outgoing

_WIDTH = 4096
_MAX_RADIANCE = 65504.0  # of a half float


class ReflectedSurfaces:
    """The intersector of one scene's triangles, and textures of the light at their corners.

    Glass and what alpha opens are left out: what lies behind is reflected. Raises ViewerError for more triangles than
    textures hold, and as `make_intersector` does.
    """

    def __init__(self, context: Context, scene: Scene, settings: Settings, kind: str) -> None:
        geometry = trace_geometry(scene)
        shown = [i for i in geometry.instances if not i.see_through and i.kind != GLASS]
        self._scene = scene
        self._geometry = replace(geometry, instances=shown)
        self.intersector = make_intersector(context, self._geometry, kind=kind)
        self._textures = _textures(context, scene, self._geometry, bake_outgoing(context, scene, settings))

    def holds(self, scene: Scene) -> bool:
        """Whether these are that scene's triangles, lit as they are."""
        names = ("instances", "meshes", "materials", "lights", "environment")
        return all(getattr(scene, name) is getattr(self._scene, name) for name in names)

    def bind(self, first_unit: int) -> dict[str, object]:
        """The uniforms of shaders/raster/reflected_light.frag, their textures from this unit on."""
        for unit, texture in enumerate(self._textures.values(), first_unit):
            texture.use(unit)
        return {name: unit for unit, name in enumerate(self._textures, first_unit)}

    def release(self) -> None:
        self.intersector.release()
        for texture in self._textures.values():
            texture.release()


def _textures(
    context: Context, scene: Scene, geometry: TraceGeometry, light: VertexLight
) -> dict[str, moderngl.Texture]:
    """Radiance of every triangle's corners, and where those of each instance begin."""
    counts = [3 * len(geometry.meshes[instance.mesh].triangles) for instance in geometry.instances]
    total = sum(counts)
    if -(-total // _WIDTH) > context.gl.info["GL_MAX_TEXTURE_SIZE"]:
        raise ViewerError(f"the scene has too many triangles for traced reflections, {total // 3}")
    corners = np.zeros((-(-max(total, 1) // _WIDTH) * _WIDTH, 4), np.float16)
    firsts = np.zeros(-(-max(len(counts), 1) // _WIDTH) * _WIDTH, np.int32)
    firsts[: len(counts)] = np.cumsum([0, *counts])[:-1]
    for first, count, instance in zip(firsts, counts, geometry.instances):
        mesh = geometry.meshes[instance.mesh]
        part = corners[first : first + count]
        radiance = light.per_instance[instance.source][mesh.triangles.ravel(), :3]
        part[:, :3] = np.minimum(radiance, _MAX_RADIANCE)
        material = scene.materials[scene.meshes[scene.instances[instance.source].mesh].material]
        if not material.double_sided:
            part[:, 3] = _face_normals(mesh.positions[mesh.triangles], instance.transform).ravel()
    return {"u_light": _texture(context.gl, corners.reshape(-1, _WIDTH, 4)),
            "u_first": _texture(context.gl, firsts.reshape(-1, _WIDTH, 1))}


def _face_normals(positions: np.ndarray, transform: np.ndarray) -> np.ndarray:
    """(M, 3), of triangles (M, 3, 3) placed by `transform`, on the side from which they are counter-clockwise in the
    mesh; 0 for triangles without area."""
    edges = (positions[:, 1:] - positions[:, :1]).astype(np.float64) @ transform[:, :3].T
    normals = np.cross(edges[:, 0], edges[:, 1]) * np.sign(np.linalg.det(transform[:, :3]))
    lengths = np.linalg.norm(normals, axis=1, keepdims=True)
    return np.divide(normals, lengths, out=np.zeros_like(normals), where=lengths > 0)


def _texture(gl: moderngl.Context, texels: np.ndarray) -> moderngl.Texture:
    dtype = {"float16": "f2", "int32": "i4"}[texels.dtype.name]
    texture = gl.texture((texels.shape[1], texels.shape[0]), texels.shape[2], np.ascontiguousarray(texels), dtype=dtype)
    texture.filter = moderngl.NEAREST, moderngl.NEAREST
    return texture
