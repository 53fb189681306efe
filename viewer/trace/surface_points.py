"""Sample points on the surfaces of a scene, and a fit of values at the points by values at the vertices.

The values of the vertices are interpolated linearly over triangles. So they are fitted to values all over the triangles
(Kavan, Bargteil & Sloan 2011, "Least Squares Vertex Baking") instead of being computed at the vertices: many vertices
lie in corners and contacts, where light is least typical of their triangles. The fit is regularised towards the mean
around each vertex, which has less noise.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..scene.scene import Scene
from ..scene.transform import handedness, normal_matrix
from ..scene.triangles import triangles_of

MOST_POINTS = 1 << 21
"""Largest number of points. Each needs about 300 bytes during the fit."""
_SAME_NORMAL = 0.9
"""Vertices at one position share a value if the cosine between their normals is above this."""
_SAME_POSITION = 2.0**-20
"""Vertices this near to one another, in tracer units, are at one position."""
_DAMPING = 0.25
"""Weight of the mean around a vertex, relative to the fit.

It more than halves values that alternate between vertices.
"""
_STEPS = 12
"""Steps of conjugate gradients."""
_LIMIT = 4.0
"""A point may be at most this many times brighter than the other points around its vertices."""


@dataclass(frozen=True, eq=False)
class SurfaceTriangles:
    """T triangles with V vertices of some instances in tracer space, instance after instance.

    `corners` (T, 3) are numbers of vertices; `positions` and `normals` are (V, 3) float64; `areas` is (T,);
    `geometric_normals` (T, 3) are unit vectors to the side from which corners are counter-clockwise; `first_vertices`
    has the first vertex of each of the scene's instances, and V at the end.
    """

    corners: NDArray[np.int64]
    positions: NDArray[np.float64]
    normals: NDArray[np.float64]
    areas: NDArray[np.float64]
    geometric_normals: NDArray[np.float64]
    first_vertices: NDArray[np.int64]


@dataclass(frozen=True, eq=False)
class SurfacePoints:
    """N points:

    `triangle` (N,), `barycentric` coordinates in it (N, 3), and `weight` (N,), the area that each represents.
    """

    triangle: NDArray[np.int64]
    barycentric: NDArray[np.float64]
    weight: NDArray[np.float64]


def surface_triangles(scene: Scene, instances: Sequence[int]) -> SurfaceTriangles:
    """The triangles of those `instances` that have normals. All other instances have vertices but no triangles here."""
    chosen = set(instances)
    positions, normals = [np.zeros((0, 3))], [np.zeros((0, 3))]
    corners, hands, firsts = [np.zeros((0, 3), np.int64)], [np.zeros(0)], [0]
    for number, instance in enumerate(scene.instances):
        mesh = scene.meshes[instance.mesh]
        transform = instance.transform
        positions.append((mesh.positions @ transform[:3, :3].T + (transform[:3, 3] - scene.center)) / scene.radius)
        has = number in chosen and mesh.topology == "triangles" and mesh.normals is not None
        normals.append(unit(mesh.normals @ normal_matrix(transform).T) if has else np.zeros_like(positions[-1]))
        if has:
            corners.append(triangles_of(mesh).astype(np.int64) + firsts[-1])
            hands.append(np.full(len(corners[-1]), handedness(transform)))
        firsts.append(firsts[-1] + len(mesh.positions))
    where, index = np.concatenate(positions), np.concatenate(corners)
    a, b, c = (where[index[:, k]] for k in range(3))
    cross = np.cross(b - a, c - a) * np.concatenate(hands)[:, None]
    areas = np.linalg.norm(cross, axis=1) / 2
    return SurfaceTriangles(index, where, np.concatenate(normals), areas, unit(cross), np.array(firsts))


def unit(vectors: NDArray[np.float64]) -> NDArray[np.float64]:
    """The vectors (N, 3) at length 1; zero vectors stay zero."""
    largest = np.abs(vectors).max(axis=1, initial=0.0, keepdims=True)
    vectors = vectors / np.where(largest > 0, largest, 1.0)
    length = np.linalg.norm(vectors, axis=1, keepdims=True)
    return vectors / np.where(length > 0, length, 1.0)


def sample_surfaces(surfaces: SurfaceTriangles, count: int, most: int = MOST_POINTS) -> SurfacePoints:
    """About `count` points, the same ones in each call. Every triangle with an area gets at least one, if `most`
    allows.

    The number of a triangle's points is in proportion to the square root of its area. A large triangle needs more
    points than a small one for the same quality at its vertices, but not in proportion to its area.
    """
    size = np.sqrt(surfaces.areas)
    wanted = size * (count / max(size.sum(), 1e-300))
    fraction = (np.arange(len(size)) * 0.6180339887498949) % 1.0
    least = min(most / max(len(size), 1), 1.0)
    each = np.where(size > 0, np.floor(np.maximum(wanted, least) + fraction), 0).astype(np.int64)
    triangle = np.repeat(np.arange(len(each)), each)
    k = np.arange(len(triangle)) - np.repeat(np.cumsum(each) - each, each)
    # The sequence R2 of Roberts 2018, "The Unreasonable Effectiveness of Quasirandom Sequences", with an offset per
    # triangle
    offset = triangle[:, None] * np.array([0.6180339887498949, 0.4142135623730951]) + 0.5
    u, v = ((offset + k[:, None] * np.array([0.7548776662466927, 0.5698402909980532])) % 1.0).T
    over = u + v > 1
    u, v = np.where(over, 1 - u, u), np.where(over, 1 - v, v)
    barycentric = np.stack([1 - u - v, u, v], axis=1)
    return SurfacePoints(triangle, barycentric, (surfaces.areas / np.maximum(each, 1))[triangle])


def interpolate(surfaces: SurfaceTriangles, points: SurfacePoints, values: NDArray[np.float64]) -> NDArray[np.float64]:
    """Values of vertices, (V, C), interpolated at the points, (N, C)."""
    return np.einsum("nk,nkc->nc", points.barycentric, values[surfaces.corners[points.triangle]])


def vertex_groups(surfaces: SurfaceTriangles) -> NDArray[np.int64]:
    """The number of each vertex's group, (V,). A group has one instance, one position and similar normals."""
    owner = np.repeat(np.arange(len(surfaces.first_vertices) - 1), np.diff(surfaces.first_vertices)).astype(np.uint64)
    bits = np.rint(surfaces.positions / _SAME_POSITION).astype(np.int64).view(np.uint64)
    factors = np.array([0x9E3779B97F4A7C15, 0xC2B2AE3D27D4EB4F, 0x165667B19E3779F9], np.uint64)
    key = owner * np.uint64(0xD6E8FEB86659FD93)
    for k in range(3):
        key = (key ^ (bits[:, k] * factors[k])) * np.uint64(0xFF51AFD7ED558CCD)
        key ^= key >> np.uint64(32)
    group, left, count = np.zeros(len(key), np.int64), np.arange(len(key)), 0
    while len(left):
        _, first, place = np.unique(key[left], return_index=True, return_inverse=True)
        chosen = left[first][place]
        same = np.einsum("ij,ij->i", surfaces.normals[left], surfaces.normals[chosen]) > _SAME_NORMAL
        same |= chosen == left
        group[left[same]] = count + place[same]
        count, left = count + len(first), left[~same]
    return np.unique(group, return_inverse=True)[1]


def fit(surfaces: SurfaceTriangles, points: SurfacePoints, found: NDArray[np.float64]) -> NDArray[np.float64]:
    """Values of the vertices, (V, C), whose interpolation fits the values `found` at the points, (N, C) >= 0.

    Vertices of no triangle get 0. Conjugate gradients with the diagonal as preconditioner (Shewchuk 1994).
    """
    group = vertex_groups(surfaces)
    corners, size = group[surfaces.corners], int(group.max(initial=-1)) + 1
    at_points = corners[points.triangle]

    def gathered(index: NDArray[np.int64], values: NDArray[np.float64]) -> NDArray[np.float64]:
        return np.stack([np.bincount(index.ravel(), values[..., c].ravel(), size) for c in range(values.shape[-1])], 1)

    share = points.barycentric * (points.weight / max(points.weight.max(initial=0.0), 1e-300))[:, None]
    mass = gathered(at_points, share[..., None])
    for _ in range(2):  # the second time without the outliers that hid others
        total = gathered(at_points, share[..., None] * found[:, None])
        found = _without_outliers(found, share, mass[at_points, 0], total[at_points])
    mean = gathered(at_points, share[..., None] * found[:, None]) / np.where(mass > 0, mass, 1.0)
    products = np.einsum("ni,nj->nij", share, points.barycentric).reshape(-1, 9)
    matrices = np.stack([np.bincount(points.triangle, products[:, k], len(corners)) for k in range(9)], axis=1)
    matrices = matrices.reshape(-1, 3, 3)

    def times(x: NDArray[np.float64]) -> NDArray[np.float64]:
        return gathered(corners, matrices @ x[corners]) + _DAMPING * mass * x

    scale = np.where(mass > 0, mass, 1.0)
    x = mean.copy()
    residual = (1 + _DAMPING) * mass * mean - times(x)
    direction = preconditioned = residual / scale
    energy = (residual * preconditioned).sum(axis=0)
    for _ in range(_STEPS):
        moved = times(direction)
        step = energy / np.maximum((direction * moved).sum(axis=0), 1e-300)
        x += step * direction
        residual = residual - step * moved
        preconditioned = residual / scale
        before, energy = energy, (residual * preconditioned).sum(axis=0)
        direction = preconditioned + energy / np.maximum(before, 1e-300) * direction
    return np.maximum(x, 0.0)[group]


def _without_outliers(found: NDArray[np.float64], share: NDArray[np.float64], mass: NDArray[np.float64],
              total: NDArray[np.float64]) -> NDArray[np.float64]:
    """`found`, with rgb limited to `_LIMIT` times the mean at all other points around the triangle's vertices.

    Brighter points are outliers: rare light that a single path has found. `mass` (N, 3) and `total` (N, 3, C) are those
    of the vertices.
    """
    others = (total - share[..., None] * found[:, None])[..., :3].sum(axis=1).max(axis=1)
    most = _LIMIT * others / np.maximum((mass - share).sum(axis=1), 1e-300)
    brightest = found[:, :3].max(axis=1)
    factor = np.where(brightest > most, most / np.maximum(brightest, 1e-300), 1.0)
    return np.concatenate([found[:, :3] * np.maximum(factor, 0.0)[:, None], found[:, 3:]], axis=1)
