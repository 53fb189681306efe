"""Points spread over a scene's surfaces, and what is found at them as values of the vertices.

Values are to be interpolated linearly over triangles, so they are fitted to what was found all over them (Kavan,
Bargteil & Sloan 2011, "Least Squares Vertex Baking"), not taken at the vertices: there, in corners and where bodies
meet, is where surfaces are least like themselves. The fit is drawn towards the mean about each vertex, which has less
noise.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..scene.scene import Scene
from ..scene.transform import handedness, normal_matrix
from .scene.geometry import triangles_of

MOST_POINTS = 1 << 21
"""Some 300 bytes each while values are fitted to them."""
_ALIKE = 0.9
"""Cosine between normals of vertices at one place that have one value."""
_PLACE = 2.0**-20
"""In tracer units: vertices this near to one another are at one place."""
_DAMPING = 0.25
"""Weight of the mean about a vertex beside the fit: of what alternates from vertex to vertex less than half is left."""
_STEPS = 12
_LIMIT = 4.0
"""How many times brighter a point may be than those about it."""


@dataclass(frozen=True, eq=False)
class Surfaces:
    """Triangles of some instances in tracer space: T of them with V vertices, the instances' one after the other.

    corners (T, 3) numbers of vertices; places and normals (V, 3) float64; areas (T,); outsides (T, 3) unit normals, to
    the side that counter-clockwise triangles face; `firsts` the first vertex of each of the scene's instances, and V.
    """

    corners: NDArray[np.int64]
    places: NDArray[np.float64]
    normals: NDArray[np.float64]
    areas: NDArray[np.float64]
    outsides: NDArray[np.float64]
    firsts: NDArray[np.int64]


@dataclass(frozen=True, eq=False)
class Points:
    """N points: of which triangle (N,), where in it, barycentric (N, 3), and how much area each stands for (N,)."""

    triangle: NDArray[np.int64]
    barycentric: NDArray[np.float64]
    weight: NDArray[np.float64]


def surfaces_of(scene: Scene, instances: Sequence[int]) -> Surfaces:
    """Those instances of `scene` that are triangles with normals; the others have vertices and no triangle."""
    chosen = set(instances)
    places, normals = [np.zeros((0, 3))], [np.zeros((0, 3))]
    corners, hands, firsts = [np.zeros((0, 3), np.int64)], [np.zeros(0)], [0]
    for number, instance in enumerate(scene.instances):
        mesh = scene.meshes[instance.mesh]
        transform = instance.transform
        places.append((mesh.positions @ transform[:3, :3].T + (transform[:3, 3] - scene.center)) / scene.radius)
        has = number in chosen and mesh.topology == "triangles" and mesh.normals is not None
        normals.append(unit(mesh.normals @ normal_matrix(transform).T) if has else np.zeros_like(places[-1]))
        if has:
            corners.append(triangles_of(mesh).astype(np.int64) + firsts[-1])
            hands.append(np.full(len(corners[-1]), handedness(transform)))
        firsts.append(firsts[-1] + len(mesh.positions))
    where, index = np.concatenate(places), np.concatenate(corners)
    a, b, c = (where[index[:, k]] for k in range(3))
    cross = np.cross(b - a, c - a) * np.concatenate(hands)[:, None]
    areas = np.linalg.norm(cross, axis=1) / 2
    return Surfaces(index, where, np.concatenate(normals), areas, unit(cross), np.array(firsts))


def unit(vectors: NDArray[np.float64]) -> NDArray[np.float64]:
    """(N, 3) of length 1, or 0 as they are."""
    largest = np.abs(vectors).max(axis=1, initial=0.0, keepdims=True)
    vectors = vectors / np.where(largest > 0, largest, 1.0)
    length = np.linalg.norm(vectors, axis=1, keepdims=True)
    return vectors / np.where(length > 0, length, 1.0)


def spread(surfaces: Surfaces, count: int, most: int = MOST_POINTS) -> Points:
    """About `count` points, but one on every triangle that has an area as long as those are no more than `most`; the
    same ones every time.

    A triangle gets them by the root of its area: large ones need more for their vertices to be as good as others', not
    as much more as they are larger.
    """
    size = np.sqrt(surfaces.areas)
    wanted = size * (count / max(size.sum(), 1e-300))
    fraction = (np.arange(len(size)) * 0.6180339887498949) % 1.0
    least = min(most / max(len(size), 1), 1.0)
    each = np.where(size > 0, np.floor(np.maximum(wanted, least) + fraction), 0).astype(np.int64)
    triangle = np.repeat(np.arange(len(each)), each)
    k = np.arange(len(triangle)) - np.repeat(np.cumsum(each) - each, each)
    # Roberts 2018, "The Unreasonable Effectiveness of Quasirandom Sequences": R2, from another place in every triangle
    turn = triangle[:, None] * np.array([0.6180339887498949, 0.4142135623730951]) + 0.5
    u, v = ((turn + k[:, None] * np.array([0.7548776662466927, 0.5698402909980532])) % 1.0).T
    over = u + v > 1
    u, v = np.where(over, 1 - u, u), np.where(over, 1 - v, v)
    barycentric = np.stack([1 - u - v, u, v], axis=1)
    return Points(triangle, barycentric, (surfaces.areas / np.maximum(each, 1))[triangle])


def at(surfaces: Surfaces, points: Points, values: NDArray[np.float64]) -> NDArray[np.float64]:
    """Values of vertices, (V, C), at the points, (N, C)."""
    return np.einsum("nk,nkc->nc", points.barycentric, values[surfaces.corners[points.triangle]])


def merged(surfaces: Surfaces) -> NDArray[np.int64]:
    """For each vertex the number of its group, (V,): those at one place, of an instance, whose normals are alike."""
    owner = np.repeat(np.arange(len(surfaces.firsts) - 1), np.diff(surfaces.firsts)).astype(np.uint64)
    bits = np.rint(surfaces.places / _PLACE).astype(np.int64).view(np.uint64)
    factors = np.array([0x9E3779B97F4A7C15, 0xC2B2AE3D27D4EB4F, 0x165667B19E3779F9], np.uint64)
    key = owner * np.uint64(0xD6E8FEB86659FD93)
    for k in range(3):
        key = (key ^ (bits[:, k] * factors[k])) * np.uint64(0xFF51AFD7ED558CCD)
        key ^= key >> np.uint64(32)
    group, left, count = np.zeros(len(key), np.int64), np.arange(len(key)), 0
    while len(left):
        _, first, place = np.unique(key[left], return_index=True, return_inverse=True)
        chosen = left[first][place]
        same = np.einsum("ij,ij->i", surfaces.normals[left], surfaces.normals[chosen]) > _ALIKE
        same |= chosen == left
        group[left[same]] = count + place[same]
        count, left = count + len(first), left[~same]
    return np.unique(group, return_inverse=True)[1]


def fit(surfaces: Surfaces, points: Points, found: NDArray[np.float64]) -> NDArray[np.float64]:
    """Values of the vertices, (V, C), whose interpolation comes near what was `found` at the points, (N, C) >= 0.

    0 for vertices of no triangle. Conjugate gradients, scaled by the diagonal (Shewchuk 1994).
    """
    group = merged(surfaces)
    corners, size = group[surfaces.corners], int(group.max(initial=-1)) + 1
    at_points = corners[points.triangle]

    def gathered(index: NDArray[np.int64], values: NDArray[np.float64]) -> NDArray[np.float64]:
        return np.stack([np.bincount(index.ravel(), values[..., c].ravel(), size) for c in range(values.shape[-1])], 1)

    share = points.barycentric * (points.weight / max(points.weight.max(initial=0.0), 1e-300))[:, None]
    mass = gathered(at_points, share[..., None])
    for _ in range(2):  # the second time those are gone that hid others
        total = gathered(at_points, share[..., None] * found[:, None])
        found = _bearable(found, share, mass[at_points, 0], total[at_points])
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


def _bearable(found: NDArray[np.float64], share: NDArray[np.float64], mass: NDArray[np.float64],
              total: NDArray[np.float64]) -> NDArray[np.float64]:
    """What was `found`, but rgb at most `_LIMIT` times as bright as at all other points of the triangle's vertices:
    what is brighter is rare light that one path has met. `mass` (N, 3) and `total` (N, 3, C) are of those vertices."""
    others = (total - share[..., None] * found[:, None])[..., :3].sum(axis=1).max(axis=1)
    most = _LIMIT * others / np.maximum((mass - share).sum(axis=1), 1e-300)
    brightest = found[:, :3].max(axis=1)
    factor = np.where(brightest > most, most / np.maximum(brightest, 1e-300), 1.0)
    return np.concatenate([found[:, :3] * np.maximum(factor, 0.0)[:, None], found[:, 3:]], axis=1)
