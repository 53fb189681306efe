"""How thick solids are behind the vertices of their surfaces, and how their other side is inclined, from chords: rays
through the inside."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace

import moderngl
import numpy as np
from numpy.typing import NDArray

from ..gpu.context import Context
from ..gpu.ray_textures import WholeTextures
from ..scene.scene import Scene
from .layout import IN_FLIGHT, INSTANCE_MASK, MISS
from .rays.intersect import make_intersector
from .scene.geometry import TraceGeometry, trace_geometry
from .surface_points import SurfacePoints, SurfaceTriangles, fit, interpolate, sample_surfaces, surface_triangles, unit
from .vertex_light import VertexLight

_RAYS = 1 << 18
_POINT_RAYS = 16
_WIDTH = 1024
_LEAST_REFRACTED = 0.7
"""Cosine to the normal, inside, of the flattest light that a boundary of index 1.4 lets in."""
_LONGEST = 2.0
"""The diameter of the scene, in tracer units: the length of a chord that meets no surface."""


def thickness_at_vertices(context: Context, scene: Scene, instances: Sequence[int],
                          rays: int = _RAYS) -> dict[int, NDArray[np.float32]]:
    """Thickness and roundness of the solids `instances` behind their vertices, the way straight through them, and how
    their other side turns and its normal, (V, 7) float32 for each.

    The thickness is half of the mean length of chords, with a density of directions in proportion to the cosine, in
    radii of the scene. It is the distance to the other side of a slab, and 2/3 of the radius of a ball; the mean over
    the surface is twice the volume over the area of any body (Cauchy). The roundness is 0 for a slab and 1 for a ball:
    with chords c at cosines mu, mean(c mu) / mean(c) is 1/2 for a slab and 3/4 for a ball.

    The way straight through is the chord that is the nearest to the normal. The normal of the other side is the mean of
    those to which refracted light goes. It points outwards, has the space of the mesh, and is 0 where there is no other
    side. By the turn times the tangential part of a direction, the normal that this direction meets differs from it: 0
    in a slab, 2 in a ball.
    """
    chords = _Chords(context, scene, instances, rays)
    means = np.stack([chords.lengths.mean(axis=1), (chords.lengths * chords.cosines).mean(axis=1)], axis=1)
    values = fit(chords.surfaces, chords.points, np.concatenate([means, np.zeros_like(means)], axis=1))
    length, along = values[:, 0], values[:, 1]
    roundness = np.clip(4.0 * along / np.maximum(length, 1e-30) - 2.0, 0.0, 1.0)
    straight = fit(chords.surfaces, chords.points, chords.lengths[:, :1])
    # Values that are fitted must not be negative, nor differ more than fourfold.
    behind = fit(chords.surfaces, chords.points, 2.0 + _other_side(chords)) - 2.0
    found = chords.of_instances(np.column_stack([0.5 * length, roundness, straight, behind]))
    for number, of_vertices in found.items():
        of_vertices[:, 4:] = unit(of_vertices[:, 4:] @ scene.instances[number].transform[:3, :3])
    return found


def _other_side(chords: _Chords) -> NDArray[np.float64]:
    """Of each point, how the other side turns, by least squares, and its normal: (N, 4)."""
    count = len(chords.points.triangle)
    normals, along = np.zeros((count, 3)), np.zeros(count)
    is_refracted = chords.cosines > _LEAST_REFRACTED
    across = np.zeros(count)
    for number, (rows, corners, weights) in chords.exits.items():
        point, direction = np.divmod(rows, chords.each)
        of_vertices = chords.surfaces.normals[chords.surfaces.first_vertices[number] + corners]
        found = np.einsum("nk,nkc->nc", weights, of_vertices) * is_refracted[direction, None]
        for axis in range(3):
            normals[:, axis] += np.bincount(point, found[:, axis], count)
        tangential = chords.tangential[rows]
        along += np.bincount(point, np.einsum("nc,nc->n", found, tangential), count)
        across += np.bincount(point, np.einsum("nc,nc->n", tangential, tangential) * is_refracted[direction], count)
    turn = np.clip(along / np.maximum(across, 1e-30), -1.0, 2.0)
    return np.column_stack([turn, unit(normals)])


def light_behind(context: Context, scene: Scene, instances: Sequence[int],
                 light: VertexLight) -> dict[int, NDArray[np.float32]]:
    """The mean of `light` where chords from the vertices of `instances` come out again, (V, 4) float32 for each."""
    chords = _Chords(context, scene, instances, _RAYS)
    means = np.zeros((len(chords.points.triangle), 4))
    for number, (rows, corners, weights) in chords.exits.items():
        found = np.einsum("nk,nkc->nc", weights, light.per_instance[number][corners].astype(np.float64))
        for channel in range(4):
            means[:, channel] += np.bincount(rows // chords.each, found[:, channel], len(means))
    return chords.of_instances(fit(chords.surfaces, chords.points, means / chords.each))


class _Chords:
    """`each` chords of the solids `instances` from each of N points: `lengths` (N, each) and `cosines` (each,), the
    greatest first, and the tangential parts (N each, 3) of their directions.

    `exits` has, for each instance on whose surface some end: the number of these chords, the three vertices around each
    end, and their weights.
    """

    def __init__(self, context: Context, scene: Scene, instances: Sequence[int], rays: int) -> None:
        context.make_current()
        self._instances, chosen = instances, set(instances)
        geometry = trace_geometry(scene, scattering=False)
        solids = [replace(i, see_through=False) for i in geometry.instances if i.source in chosen]
        self.surfaces = surface_triangles(scene, instances)
        self.points = sample_surfaces(self.surfaces, rays // _POINT_RAYS)
        count = len(self.points.triangle)
        self.each = max(rays // max(count, 1), 4)
        origins, directions, self.cosines, n = _first_rays(self.surfaces, self.points, self.each)
        self.tangential = directions + (self.cosines[:, None] * n[:, None]).reshape(-1, 3)
        self.exits: dict[int, tuple[NDArray[np.intp], NDArray[np.uint32], NDArray[np.float64]]] = {}
        self.lengths = np.full((count, self.each), _LONGEST)
        if solids and count:
            self._trace(context, replace(geometry, instances=solids), origins, directions)

    def _trace(self, context: Context, geometry: TraceGeometry, origins: NDArray[np.float64],
               directions: NDArray[np.float64]) -> None:
        rays = _Rays(context.gl, origins, directions)
        intersector = make_intersector(context, geometry)
        try:
            intersector.store(rays, intersector.trace(intersector.fetch(rays)))
            hits = rays.read_hits()
        finally:
            intersector.release()
            rays.release()
        lengths = self.lengths.reshape(-1)
        instance = np.where(hits[:, 0] == MISS, -1, (hits[:, 0] & INSTANCE_MASK).astype(np.int64))
        order = np.argsort(instance, kind="stable")
        first = np.searchsorted(instance[order], np.arange(len(geometry.instances) + 1))
        for placed, begin, end in zip(geometry.instances, first[:-1], first[1:], strict=True):
            rows, mesh = order[begin:end], geometry.meshes[placed.mesh]
            corners = mesh.triangles[hits[rows, 1]]
            u, v = np.ascontiguousarray(hits[rows, 2:]).view(np.float32).astype(np.float64).T
            weights = np.stack([1.0 - u - v, u, v], axis=1)
            where = np.einsum("nk,nkc->nc", weights, mesh.positions[corners].astype(np.float64))
            where = where @ placed.transform[:, :3].T + placed.transform[:, 3]
            lengths[rows] = np.minimum(np.linalg.norm(where - origins[rows], axis=1), _LONGEST)
            self.exits[placed.source] = rows, corners, weights

    def of_instances(self, values: NDArray[np.float64]) -> dict[int, NDArray[np.float32]]:
        """The values of all vertices, (V, C), by instance."""
        parts = np.split(values.astype(np.float32), self.surfaces.first_vertices[1:-1])
        return {k: parts[k] for k in self._instances}


def _first_rays(
    surfaces: SurfaceTriangles, points: SurfacePoints, each: int
) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]:
    """Origins and directions of `each` rays into the solid from each of N points, (N each, 3), the cosines of these
    to the normal, (each,), which have a density in proportion to themselves, and the normals, (N, 3)."""
    count = len(points.triangle)
    n = surfaces.geometric_normals[points.triangle]
    shading = unit(interpolate(surfaces, points, surfaces.normals))
    n = np.where(np.einsum("ij,ij->i", n, shading)[:, None] < 0, -n, n)
    # A lattice of directions for each point, each shifted by another amount (Roberts 2018, the sequence R2)
    k, shift = np.arange(each), np.arange(count)[:, None]
    u = (k + 0.5) / each
    phi = 2.0 * math.pi * ((k * 0.6180339887498949 + shift * 0.5698402909980532) % 1.0)
    cosine, sine = np.sqrt(1.0 - u), np.sqrt(u)
    x, y = _tangents(n)
    directions = ((sine * np.cos(phi))[..., None] * x[:, None] + (sine * np.sin(phi))[..., None] * y[:, None]
                  - cosine[..., None] * n[:, None])
    positions = interpolate(surfaces, points, surfaces.positions)
    origins = np.broadcast_to((positions - 1e-5 * n)[:, None], directions.shape)
    return origins.reshape(-1, 3), directions.reshape(-1, 3), cosine, n


def _tangents(n: NDArray[np.float64]) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Two unit vectors perpendicular to each of n and to each other."""
    other = np.where(np.abs(n[:, :1]) > 0.9, [[0.0, 1.0, 0.0]], [[1.0, 0.0, 0.0]])
    x = unit(np.cross(n, other))
    return x, np.cross(n, x)


class _Rays(WholeTextures):
    """The textures that `viewer.trace.rays.intersect.WavefrontTextures` describes, one ray a texel."""

    def __init__(self, gl: moderngl.Context, origins: NDArray[np.float64], directions: NDArray[np.float64]) -> None:
        self._count = len(origins)
        size = _WIDTH, -(-self._count // _WIDTH)
        self.origin = _texture(gl, size, np.column_stack([origins, np.full(self._count, float(IN_FLIGHT))]))
        self.direction = _texture(gl, size, directions)
        self.shadow_origin = self.shadow_vector = self.medium = _texture(gl, size, np.zeros((0, 4)))
        self.hit = gl.texture(size, 4, dtype="u4")
        self.hit.filter = moderngl.NEAREST, moderngl.NEAREST
        self.along = None

    def read_hits(self) -> NDArray[np.uint32]:
        return np.frombuffer(self.hit.read(), np.uint32).reshape(-1, 4)[:self._count]

    def release(self) -> None:
        for texture in (self.origin, self.direction, self.shadow_vector, self.hit):
            texture.release()


def _texture(gl: moderngl.Context, size: tuple[int, int], rows: NDArray[np.float64]) -> moderngl.Texture:
    texels = np.zeros((size[0] * size[1], 4), np.float32)
    texels[:len(rows), :rows.shape[1]] = rows
    texture = gl.texture(size, 4, texels, dtype="f4")
    texture.filter = moderngl.NEAREST, moderngl.NEAREST
    return texture
