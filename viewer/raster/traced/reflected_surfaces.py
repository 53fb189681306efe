"""The surfaces that reflection rays can hit: an intersector of their triangles, and their vertices in textures."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import moderngl
import numpy as np

from ...errors import ViewerError
from ...gpu.context import Context
from ...gpu.programs import Programs
from ...gpu.row_texture import row_texture
from ...scene.scene import Scene
from ...scene.unit_vectors import octahedron, unit_vectors
from ...settings import Settings
from ...trace.defines import shader_defines
from ...trace.kinds import SURFACE
from ...trace.rays.intersect import make_intersector
from ...trace.scene.geometry import TraceGeometry, TraceInstance, trace_geometry
from ...trace.vertex_light import VertexLight, bake_outgoing
from .vertex_metal import vertex_metal

_MAX_RADIANCE = 65504.0  # of a half float


class ReflectedSurfaces:
    """The intersector of one scene's triangles, and textures of radiance and surface at their vertices.

    Instances with alpha are left out, so that reflections show what is behind them. Glass has its radiance along the
    normal from every side. Raises ViewerError for more triangles than a texture holds, and as `make_intersector` does.
    """

    def __init__(self, context: Context, scene: Scene, settings: Settings, kind: str,
                 programs: Programs) -> None:
        geometry = trace_geometry(scene, scattering=False)
        shown = [instance for instance in geometry.instances if not instance.see_through]
        geometry = replace(geometry, instances=shown)
        self._scene = scene
        self.defines = shader_defines()
        self.intersector = make_intersector(context, geometry, kind=kind)
        light = bake_outgoing(context, _matte(scene), settings, programs=programs)
        self._textures = _textures(context, [_vertices(scene, geometry, i, light) for i in shown])

    def holds(self, scene: Scene) -> bool:
        """Whether these are the triangles of `scene` under its lights."""
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


def _matte(scene: Scene) -> Scene:
    """The scene with Lambertian surfaces: radiance is baked along the normal, and reflection rays see it from other
    directions. The shader corrects it for metals."""
    return replace(scene, materials=[
        replace(material, metallic=0.0, specular=0.0, metallic_roughness_texture=None) for material in scene.materials])


def _vertices(
    scene: Scene, geometry: TraceGeometry, instance: TraceInstance, light: VertexLight
) -> tuple[np.ndarray, np.ndarray]:
    """The vertices of an instance's triangles, in order: radiance and a component of the face normal, (3 M, 4) float16;
    and octahedral normal, roughness and metallic, (3 M, 4) uint8."""
    placed = geometry.meshes[instance.mesh]
    mesh = scene.meshes[placed.source]
    material = scene.materials[mesh.material]
    indices = placed.triangles.ravel()
    radiance = np.zeros((len(indices), 4), np.float16)
    radiance[:, :3] = np.minimum(light.per_instance[instance.source][indices, :3], _MAX_RADIANCE)
    faces = unit_vectors(_face_normals(placed.positions[placed.triangles], instance.transform))
    if not material.double_sided and instance.kind == SURFACE:
        radiance[:, 3] = faces.ravel()
    normals = np.repeat(faces, 3, axis=0)
    if mesh.normals is not None:
        normals = unit_vectors(mesh.normals @ np.linalg.pinv(instance.transform[:, :3]))[indices]
    surface = np.concatenate([octahedron(normals) / 2 + 0.5, vertex_metal(material, mesh)[indices]], axis=1)
    return radiance, np.rint(255 * surface).astype(np.uint8)


def _face_normals(positions: np.ndarray, transform: np.ndarray) -> np.ndarray:
    """(M, 3), of triangles (M, 3, 3) placed by `transform`, on the side from which they are counter-clockwise in the
    mesh; 0 for triangles without area."""
    edges = (positions[:, 1:] - positions[:, :1]).astype(np.float64) @ transform[:, :3].T
    return np.cross(edges[:, 0], edges[:, 1]) * np.sign(np.linalg.det(transform[:, :3]))


def _textures(context: Context, vertices: Sequence[tuple[np.ndarray, np.ndarray]]) -> dict[str, moderngl.Texture]:
    """The vertices of all instances, and the index of each one's first."""
    firsts = np.cumsum([0, *(len(radiance) for radiance, _ in vertices)])
    nothing = np.zeros((0, 4), np.float16), np.zeros((0, 4), np.uint8)
    radiance, surface = (np.concatenate(parts) for parts in zip(nothing, *vertices))
    records = {"u_vertex_radiance": radiance, "u_vertex_surface": surface,
               "u_first_vertex": firsts[: max(len(vertices), 1), None].astype(np.int32)}
    too_many = ViewerError(f"the scene has too many triangles for traced reflections, {len(radiance) // 3}")
    return {name: row_texture(context.gl, texels, too_many) for name, texels in records.items()}
