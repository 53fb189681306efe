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

_EVEN = 0.75
"""The longest edges are halved first: those longer than this, of the longest one."""

_last: list[ref[Scene]] = []
"""The last scene that was made: scenes that share meshes, under other lights, share divided ones, too."""
_made: WeakKeyDictionary[Mesh, dict[float, Mesh]] = WeakKeyDictionary()


def refined(scene: Scene) -> Scene:
    """`scene`, or a copy in which long edges of the triangles of coarse meshes are divided; the same object each time.
    Surfaces stay where they are, and so does what is interpolated over them. No surface of a convex scene lights
    another."""
    known: list[Scene | None] = scene.__dict__.setdefault("_refined", [])
    if not known:
        meshes = tuple(_divided(mesh, longest) for mesh, longest in zip(scene.meshes, _longest(scene), strict=True))
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


def _longest(scene: Scene) -> list[float]:
    """What no edge of each mesh shall exceed: a power of two, so that few poses that change the radius change it."""
    scales = np.zeros(len(scene.meshes))
    for instance in scene.instances:
        scale = np.linalg.norm(instance.transform[:3, :3], axis=0).max()
        scales[instance.mesh] = max(scales[instance.mesh], scale)
    wanted = [LONGEST * scene.radius / scale if scale > 0 and mesh.normals is not None else np.inf
              for mesh, scale in zip(scene.meshes, scales.tolist(), strict=True)]
    return np.exp2(np.floor(np.log2(wanted))).tolist()


def _divided(mesh: Mesh, longest: float) -> Mesh:
    known = _made.setdefault(mesh, {})
    if longest not in known:
        known.clear()
        fine = mesh
        while (finer := _halved(fine, longest)) is not fine and finer.triangle_count <= MOST_TRIANGLES:
            fine = finer
        known[longest] = fine
    return known[longest]


def _halved(mesh: Mesh, longest: float) -> Mesh:
    """With a vertex in the middle of each edge that is longer than `longest` and hardly shorter than the longest one,
    so that no edge ends within another; the mesh itself if there is none. Normals and tangents there are means, not of
    unit length, so that between them they are what they were."""
    corners = triangles_of(mesh).astype(np.int64)
    lengths = np.linalg.norm(np.diff(mesh.positions[corners[:, [0, 1, 2, 0]]].astype(np.float64), axis=1), axis=2)
    longest = max(longest, lengths.max(initial=0.0) * _EVEN)
    is_long = lengths > longest
    if not is_long.any():
        return mesh
    first = lengths.argmax(axis=1)[:, None]
    corners, is_long = (np.take_along_axis(x, (first + np.arange(3)) % 3, axis=1) for x in (corners, is_long))
    edges = np.sort(np.stack([corners, np.roll(corners, -1, axis=1)], axis=2), axis=2)[is_long]  # of ab, bc, ca
    pairs, number = np.unique(edges, axis=0, return_inverse=True)
    middles = np.full_like(corners, -1)
    middles[is_long] = number.ravel() + len(mesh.positions)
    parts = [corners[~is_long[:, 0]]]
    (a, b, c), (ab, bc, ca) = corners[is_long[:, 0]].T, middles[is_long[:, 0]].T
    for p, q, r, middle in ((a, ab, c, ca), (c, ab, b, bc)):  # both halves, whose edge rp may have a middle, too
        cut = middle >= 0
        parts += [np.stack(triangle, axis=1)[which]
                  for triangle, which in (((p, q, r), ~cut), ((p, q, middle), cut), ((q, r, middle), cut))]

    def with_middles(values: np.ndarray) -> np.ndarray:
        return np.concatenate([values, (values[pairs[:, 0]] + values[pairs[:, 1]]) / 2])

    tangents = mesh.tangents
    if tangents is not None:
        tangents = with_middles(tangents)
        tangents[:, 3] = np.where(tangents[:, 3] < 0, -1, 1)
    return replace(mesh, positions=with_middles(mesh.positions),
                   indices=np.concatenate(parts).astype(np.uint32).ravel(), tangents=tangents,
                   normals=None if mesh.normals is None else with_middles(mesh.normals),
                   uvs=tuple(with_middles(uv) for uv in mesh.uvs),
                   colors=None if mesh.colors is None else with_middles(mesh.colors))
