"""Interreflection (indirect light) at the vertices of a scene, computed by path tracing."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from ..gpu.context import Context
from ..gpu.programs import Programs
from ..scene.scene import Scene
from ..settings import Settings
from .paths.run import run
from .paths.surface_rays import FROM_SURFACE, TO_SURFACE, SurfaceRays
from .surface_points import SurfacePoints, SurfaceTriangles, fit, interpolate, sample_surfaces, surface_triangles, unit
from .tracer import Tracer

SAMPLES = 1 << 20
"""About the largest number of paths."""
_VERTEX_SAMPLES = 1 << 11
"""Largest number of paths per vertex, which matters in scenes of few vertices."""
_POINT_SAMPLES = 16
_LEAST_COSINE = 0.05
"""Between a shading normal and the geometric normal. Below this cosine the geometric normal takes its place."""


@dataclass(frozen=True, eq=False)
class VertexLight:
    """Light at the vertices of each instance of the scene.

    `per_instance` has (V, 4) float32 for each of `scene.instances`, V vertices of its mesh; 0 for unlit materials.
    """

    per_instance: tuple[NDArray[np.float32], ...]


def bake_incoming(context: Context, scene: Scene, settings: Settings, samples: int = SAMPLES,
                  programs: Programs | None = None) -> VertexLight:
    """Light that arrives at the vertices from other surfaces.

    `programs` keep what is compiled for the next time.

    rgb is irradiance divided by pi. a is the cosine-weighted part of the hemisphere that surfaces cover, 0 to 1.
    Surfaces that blend or transmit light receive light, but they do not cover anything, unless what they bound
    scatters light.
    """
    receivers = _receivers(scene)
    solid = tuple(i for i in scene.instances if _covers(scene, i.mesh))
    return _bake(context, scene, replace(scene, instances=solid), receivers, settings, FROM_SURFACE, samples,
                 programs)


def bake_outgoing(context: Context, scene: Scene, settings: Settings, samples: int = SAMPLES,
                  programs: Programs | None = None) -> VertexLight:
    """Radiance that leaves the vertices along their normals, emission included; a is 1."""
    return _bake(context, scene, scene, _receivers(scene), settings, TO_SURFACE, samples, programs)


def _receivers(scene: Scene) -> list[int]:
    return [k for k, instance in enumerate(scene.instances)
            if not scene.materials[scene.meshes[instance.mesh].material].unlit]


def _covers(scene: Scene, mesh: int) -> bool:
    material = scene.materials[scene.meshes[mesh].material]
    return material.alpha_mode != "blend" and (not material.transmits or material.medium.scatters)


def _bake(context: Context, scene: Scene, traced: Scene, receivers: list[int], settings: Settings, kind: int,
          samples: int, programs: Programs | None) -> VertexLight:
    surfaces = surface_triangles(scene, receivers)
    values = np.zeros((len(surfaces.positions), 4))
    samples = min(samples, _VERTEX_SAMPLES * len(values))
    points = sample_surfaces(surfaces, samples // _POINT_SAMPLES)
    if len(points.triangle) and traced.instances:
        each = max(samples // len(points.triangle), 1)
        values = fit(surfaces, points, _trace(
            context, scene, traced, surfaces, points, settings, kind, each, programs))
        values[:, 3] = np.minimum(values[:, 3], 1.0)
    parts = np.split(values.astype(np.float32), surfaces.first_vertices[1:-1])
    return VertexLight(tuple(parts[: len(scene.instances)]))


def _trace(context: Context, scene: Scene, traced: Scene, surfaces: SurfaceTriangles, points: SurfacePoints,
           settings: Settings, kind: int, each: int, programs: Programs | None) -> NDArray[np.float64]:
    """Trace `each` samples from each point in the scene `traced`: radiance and coverage, (N, 4)."""
    geometric = surfaces.geometric_normals[points.triangle]
    normals = unit(interpolate(surfaces, points, surfaces.normals))
    cosine = np.einsum("ij,ij->i", normals, geometric)[:, None]
    geometric = np.where(cosine < 0, -geometric, geometric)
    normals = np.where(np.abs(cosine) < _LEAST_COSINE, geometric, normals)
    # Tracer space is that of the scene `traced`.
    positions = interpolate(surfaces, points, surfaces.positions) * scene.radius
    positions = (positions + (scene.center - traced.center)) / traced.radius
    default = Settings()
    settings = replace(settings, mode="path", spp=each, time_budget=None, error=None, denoise="off", seed=0,
                       lobes="all", plan="needed", exposure=0.0, bounces=default.bounces, clamp=0.0, fog=0.0)
    rays = SurfaceRays(context.gl, kind, positions, normals, geometric)
    tracer = Tracer(context, programs=programs)
    context.gl.clear_samplers()  # the samplers of the shadow maps would override those of the wavefront's textures
    try:
        path_render = tracer.begin_at(traced, rays, settings)
        try:
            run(path_render, 0.0)
            sums, squares = path_render.film.read_sums()
        finally:
            path_render.release()
    finally:
        rays.release()
        tracer.release()
    sums, squares = rays.rows(sums[::-1]), rays.rows(squares[::-1])
    return np.concatenate([sums[:, :3], squares[:, 3:]], axis=1).astype(np.float64) / np.maximum(sums[:, 3:], 1.0)
