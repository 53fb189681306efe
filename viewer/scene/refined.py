"""Large triangles in smaller ones, for light that is stored at vertices."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from weakref import WeakKeyDictionary, ref

import numpy as np

from .convex import is_convex
from .mesh import Mesh
from .scene import Scene
from .triangles import triangles_of

LONGEST = 1 / 16
"""Of an edge, in radii of the scene."""
MOST_TRIANGLES = 4096
"""Of a mesh, after it is divided. Meshes of more triangles stay as they are."""

_last: list[ref[Scene]] = []
"""The last scene that was made: scenes that share meshes, under other lights, share divided ones, too."""
_made: WeakKeyDictionary[Mesh, dict[int, Mesh]] = WeakKeyDictionary()


def refined(scene: Scene) -> Scene:
    """`scene`, or a copy in which the triangles of coarse meshes are divided into four, as often as their longest edge
    asks for; the same object each time. Surfaces stay where they are, and so does what is interpolated over them. No
    surface of a convex scene lights another."""
    known: list[Scene | None] = scene.__dict__.setdefault("_refined", [])
    if not known:
        meshes = tuple(_divided(mesh, times) for mesh, times in zip(scene.meshes, _times(scene), strict=True))
        if _are_same(meshes, scene.meshes) or is_convex(scene):
            known.append(None)
        else:
            last = _last[0]() if _last else None
            shared = last.meshes if last is not None and _are_same(meshes, last.meshes) else meshes
            fine = replace(scene, meshes=shared)
            known.append(fine)
            _last[:] = [ref(fine)]
    return known[0] or scene


def _are_same(some: Sequence[Mesh], others: Sequence[Mesh]) -> bool:
    return len(some) == len(others) and all(a is b for a, b in zip(some, others, strict=True))


def _times(scene: Scene) -> list[int]:
    """How often each mesh is divided."""
    scales = np.zeros(len(scene.meshes))
    for instance in scene.instances:
        scale = np.linalg.norm(instance.transform[:3, :3], axis=0).max()
        scales[instance.mesh] = max(scales[instance.mesh], scale)
    times = []
    for mesh, scale in zip(scene.meshes, scales, strict=True):
        most = np.log2(max(MOST_TRIANGLES / max(mesh.triangle_count, 1), 1)) // 2
        wanted = 0.0
        if mesh.normals is not None and most > 0:
            corners = mesh.positions[triangles_of(mesh)].astype(np.float64)
            edge = np.linalg.norm(corners - np.roll(corners, 1, axis=1), axis=2).max(initial=0.0) * scale
            wanted = np.ceil(np.log2(max(edge / (LONGEST * scene.radius), 1.0)))
        times.append(int(min(wanted, most)))
    return times


def _divided(mesh: Mesh, times: int) -> Mesh:
    if not times:
        return mesh
    known = _made.setdefault(mesh, {})
    if times not in known:
        known.clear()
        fine = mesh
        for _ in range(times):
            fine = _halved(fine)
        known[times] = fine
    return known[times]


def _halved(mesh: Mesh) -> Mesh:
    """With a vertex in the middle of each edge. Normals and tangents there are means, not of unit length, so that
    between them they are what they were."""
    corners = triangles_of(mesh).astype(np.int64)
    edges = np.sort(np.stack([corners, np.roll(corners, -1, axis=1)], axis=2), axis=2)  # ab, bc, ca
    pairs, number = np.unique(edges.reshape(-1, 2), axis=0, return_inverse=True)
    ab, bc, ca = (number.reshape(-1, 3) + len(mesh.positions)).T
    a, b, c = corners.T
    indices = np.stack([a, ab, ca, ab, b, bc, ca, bc, c, ab, bc, ca], axis=1)

    def with_middles(values: np.ndarray) -> np.ndarray:
        return np.concatenate([values, (values[pairs[:, 0]] + values[pairs[:, 1]]) / 2])

    tangents = mesh.tangents
    if tangents is not None:
        tangents = with_middles(tangents)
        tangents[:, 3] = np.where(tangents[:, 3] < 0, -1, 1)
    return replace(mesh, positions=with_middles(mesh.positions), indices=indices.astype(np.uint32).ravel(),
                   tangents=tangents,
                   normals=None if mesh.normals is None else with_middles(mesh.normals),
                   uvs=tuple(with_middles(uv) for uv in mesh.uvs),
                   colors=None if mesh.colors is None else with_middles(mesh.colors))
