"""The surfaces that paths through solid glass can hit: solid glass and opaque surfaces.

Texels of shaders/raster/refraction_step.frag, in tracer space (viewer/trace/scene/geometry.py):
    instance  3: absorption and the index of its first triangle, which a float holds exactly; the square root of its
                 base colour and its index of refraction (0: opaque); its dispersion. Triangles follow all instances.
    triangle  4: the normal at each vertex, with one component of the face normal in each w; then the distance of its
                 plane from the origin along the face normal, and the mean curvature of the surface, 1 / r on a sphere
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from ...errors import ViewerError
from ...gpu.context import Context
from ...gpu.row_texture import row_texture
from ...scene.scene import Scene
from ...scene.schema import PARAMETERS
from ...scene.transform import normal_matrix
from ...scene.unit_vectors import unit_vectors
from ...trace.defines import shader_defines
from ...trace.rays.intersect import make_intersector
from ...trace.scene.geometry import TraceGeometry, TraceInstance, trace_geometry

_INSTANCE, _TRIANGLE = 3, 4


class RefractingSurfaces:
    """The intersector of one scene's triangles, and the texture that describes them.

    Blended and thin-walled surfaces are left out, as they are not in the picture that is seen through glass. Raises
    ViewerError for more triangles than a texture holds, and as `make_intersector` does.
    """

    def __init__(self, context: Context, scene: Scene, kind: str) -> None:
        geometry = trace_geometry(scene, scattering=False)
        self._scene = scene
        self.defines = shader_defines()
        # Holes of a mask are traced as solid: the picture is empty there, and the ray goes on.
        shown = [replace(i, see_through=False) for i in geometry.instances if _is_shown(scene, geometry, i)]
        self._geometry = replace(geometry, instances=shown)
        self.intersector = make_intersector(context, self._geometry, kind=kind)
        texels = _texels(scene, self._geometry)
        too_many = f"the scene has too many triangles for traced refraction, {len(texels) // _TRIANGLE}"
        self._texture = row_texture(context.gl, texels, ViewerError(too_many))

    def holds(self, scene: Scene) -> bool:
        """Whether these are the triangles and materials of `scene`."""
        return all(getattr(scene, name) is getattr(self._scene, name) for name in ("instances", "meshes", "materials"))

    def bind(self, unit: int) -> dict[str, int]:
        """The uniforms of shaders/raster/refraction_step.frag."""
        self._texture.use(unit)
        return {"u_surfaces": unit, "u_triangles": _INSTANCE * len(self._geometry.instances)}

    def release(self) -> None:
        self.intersector.release()
        self._texture.release()


def _is_shown(scene: Scene, geometry: TraceGeometry, instance: TraceInstance) -> bool:
    material = scene.materials[scene.meshes[scene.instances[instance.source].mesh].material]
    is_thin_walled = geometry.materials[instance.material].transmits and material.thickness == 0
    return material.alpha_mode != "blend" and not is_thin_walled


def _texels(scene: Scene, geometry: TraceGeometry) -> NDArray[np.float32]:
    """All texels, (N, 4)."""
    heads = np.zeros((len(geometry.instances), _INSTANCE, 4), np.float32)
    parts, first = [], 0
    for head, instance in zip(heads, geometry.instances):
        traced = geometry.materials[instance.material]
        head[0] = *np.multiply(geometry.media[instance.medium].sigma_t, scene.radius), first
        if traced.transmits:
            head[1] = *np.sqrt(np.maximum(traced.material.base_color[:3], 0)), max(traced.material.ior, 1.0)
            head[2, 0] = PARAMETERS["dispersion"].value(traced.material)
        parts.append(_triangles(scene, geometry, instance))
        first += len(parts[-1]) // _TRIANGLE
    return np.concatenate([heads.reshape(-1, 4), *parts])


def _triangles(scene: Scene, geometry: TraceGeometry, instance: TraceInstance) -> NDArray[np.float32]:
    """The texels of an instance's triangles, (4 M, 4)."""
    mesh = geometry.meshes[instance.mesh]
    points = mesh.positions.astype(np.float64) @ instance.transform[:, :3].T + instance.transform[:, 3]
    points = points[mesh.triangles]
    faces = unit_vectors(np.cross(points[:, 1] - points[:, 0], points[:, 2] - points[:, 0]))
    faces *= -1 if instance.is_mirrored else 1
    normals = scene.meshes[mesh.source].normals
    if normals is None:
        normals = np.repeat(faces[:, None], 3, axis=1)
    else:
        normals = unit_vectors(normals.astype(np.float64) @ normal_matrix(scene.instances[instance.source].transform).T)
        normals = normals[mesh.triangles]
    dp, dn = points - np.roll(points, 1, axis=1), normals - np.roll(normals, 1, axis=1)
    curvature = (dp * dn).sum(axis=(1, 2)) / np.maximum((dp * dp).sum(axis=(1, 2)), 1e-18)
    texels = np.zeros((len(points), _TRIANGLE, 4), np.float32)
    texels[:, :3, :3] = normals
    texels[:, :3, 3] = faces
    texels[:, 3, 0] = (faces * points[:, 0]).sum(axis=1)
    texels[:, 3, 1] = curvature
    return texels.reshape(-1, 4)
