"""Light that surfaces throw on one another, found at the vertices of a scene by path tracing."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from ..gpu.context import Context
from ..scene.scene import Scene
from ..settings import Settings
from .paths.run import run
from .paths.surface_rays import GATHERS, LOOKS, SurfaceRays
from .surface_points import Points, Surfaces, at, fit, spread, surfaces_of, unit
from .tracer import Tracer

SAMPLES = 1 << 20
"""About how many paths there are at most."""
_VERTEX_SAMPLES = 1 << 11
"""For each vertex, in scenes of few."""
_POINT_SAMPLES = 16
_LEAST_COSINE = 0.05
"""Between a shading normal and the geometric one; those farther apart are taken for the geometric one."""


@dataclass(frozen=True, eq=False)
class VertexLight:
    """For each instance of the scene, of the vertices of its mesh.

    `per_instance` has (V, 4) float32 each, in the order of `scene.instances`; 0 where light makes no difference.
    """

    per_instance: tuple[NDArray[np.float32], ...]


def bake_incoming(context: Context, scene: Scene, settings: Settings, samples: int = SAMPLES) -> VertexLight:
    """What comes from other surfaces to the vertices, whose hemispheres are weighted by the cosine.

    rgb is irradiance over pi, a the part of the hemisphere that is covered, 0 to 1. Surfaces that blend or transmit
    light receive it and cover nothing.
    """
    receivers = _receivers(scene)
    solid = tuple(i for i in scene.instances if _covers(scene, i.mesh))
    return _bake(context, scene, replace(scene, instances=solid), receivers, settings, GATHERS, samples)


def bake_outgoing(context: Context, scene: Scene, settings: Settings, samples: int = SAMPLES) -> VertexLight:
    """Radiance that leaves the vertices along their normals: all there is, emission too; a is 1."""
    return _bake(context, scene, scene, _receivers(scene), settings, LOOKS, samples)


def _receivers(scene: Scene) -> list[int]:
    return [k for k, instance in enumerate(scene.instances)
            if not scene.materials[scene.meshes[instance.mesh].material].unlit]


def _covers(scene: Scene, mesh: int) -> bool:
    material = scene.materials[scene.meshes[mesh].material]
    return material.alpha_mode != "blend" and not material.transmits


def _bake(context: Context, scene: Scene, traced: Scene, receivers: list[int], settings: Settings, kind: int,
          samples: int) -> VertexLight:
    surfaces = surfaces_of(scene, receivers)
    values = np.zeros((len(surfaces.places), 4))
    samples = min(samples, _VERTEX_SAMPLES * len(values))
    points = spread(surfaces, samples // _POINT_SAMPLES)
    if len(points.triangle) and traced.instances:
        each = max(samples // len(points.triangle), 1)
        values = fit(surfaces, points, _trace(context, scene, traced, surfaces, points, settings, kind, each))
        values[:, 3] = np.minimum(values[:, 3], 1.0)
    parts = np.split(values.astype(np.float32), surfaces.firsts[1:-1])
    return VertexLight(tuple(parts[: len(scene.instances)]))


def _trace(context: Context, scene: Scene, traced: Scene, surfaces: Surfaces, points: Points, settings: Settings,
           kind: int, each: int) -> NDArray[np.float64]:
    """What the points see of the scene `traced`, (N, 4), by `each` samples."""
    outsides = surfaces.outsides[points.triangle]
    normals = unit(at(surfaces, points, surfaces.normals))
    cosine = np.einsum("ij,ij->i", normals, outsides)[:, None]
    outsides = np.where(cosine < 0, -outsides, outsides)
    normals = np.where(np.abs(cosine) < _LEAST_COSINE, outsides, normals)
    # The tracer's space is that of the scene it traces.
    places = (at(surfaces, points, surfaces.places) * scene.radius + (scene.center - traced.center)) / traced.radius
    default = Settings()
    settings = replace(settings, mode="path", spp=each, time_budget=None, error=None, denoise="off", seed=0,
                       lobes="all", plan="needed", exposure=0.0, bounces=default.bounces, clamp=0.0)
    rays = SurfaceRays(context.gl, kind, places, normals, outsides)
    tracer = Tracer(context)
    context.gl.clear_samplers()  # those of a shadow map's masks would hide a wave's textures
    try:
        exposure = tracer.begin_at(traced, rays, settings)
        try:
            run(exposure, 0.0)
            sums, squares = exposure.film.read_sums()
        finally:
            exposure.release()
    finally:
        rays.release()
        tracer.release()
    sums, squares = rays.rows(sums[::-1]), rays.rows(squares[::-1])
    return np.concatenate([sums[:, :3], squares[:, 3:]], axis=1).astype(np.float64) / np.maximum(sums[:, 3:], 1.0)
