"""Computes normals from the geometry, for files without usable normals."""

from __future__ import annotations

import numpy as np

from .unit_vectors import unit_vectors
from .weld import weld

CREASE = np.pi / 4
MAX_VALENCE = 64
_CHUNK = 1 << 15
"""Triangles per step, so that what a step makes stays in the cache."""


def flat_normals(positions: np.ndarray) -> np.ndarray:
    """One normal per triangle: from (3 T, 3) unindexed positions, (3 T, 3) float32; +Z for a triangle without area."""
    return np.repeat(_unit(_face_normals(positions.reshape(-1, 3, 3))), 3, axis=0)


def smooth_normals(positions: np.ndarray, triangles: np.ndarray) -> np.ndarray:
    """The normal of each vertex: the mean over its triangles, weighted by their angle at it (Thurmer & Wuthrich 1998).

    From (N, 3) positions and (T, 3) vertex indices, (N, 3) float32; +Z for a vertex whose triangles all have no area.
    """
    corners = positions[triangles]
    weighted = corner_angles(corners)[..., None] * _unit(_face_normals(corners))[:, None, :]
    return _unit(sum_by(triangles.ravel(), weighted.reshape(-1, 3), len(positions)))


def creased_normals(positions: np.ndarray, triangles: np.ndarray, crease: float = CREASE) -> np.ndarray:
    """The normal of each triangle corner: the mean over the triangles at that position whose normals differ from its
    own triangle's by less than `crease` radians.

    From (N, 3) positions and (T, 3) vertex indices, (T, 3, 3) float32. Corners with equal positions count as one vertex
    even if their indices differ, so a seam in the texture coordinates is not visible. Where more than MAX_VALENCE
    triangles meet, all of them are averaged.
    """
    face, weighted = np.empty((len(triangles), 3)), np.empty((len(triangles), 3, 3))
    chunks = [slice(k, k + _CHUNK) for k in range(0, len(triangles), _CHUNK)]
    for chunk in chunks:
        corners = positions[triangles[chunk]]
        face[chunk] = _unit(_face_normals(corners))
        weighted[chunk] = corner_angles(corners)[..., None] * face[chunk, None, :]
    vertex = weld(positions)[triangles]
    means = unit_vectors(sum_by(vertex.ravel(), weighted.reshape(-1, 3), len(positions)))
    normals = _unit(means)[vertex].reshape(-1, 3)

    # If all triangles at a vertex are within half the crease angle of their mean, every two of them are within the
    # crease angle, and the mean is their normal already.
    creased = np.zeros(len(positions), bool)
    for chunk in chunks:
        cosines = np.einsum("tki,ti->tk", means[vertex[chunk]], face[chunk])
        creased[vertex[chunk][cosines < np.cos(crease / 2)]] = True
    vertex = vertex.ravel()
    size = np.bincount(vertex, minlength=len(positions))
    todo = np.flatnonzero((creased & (size <= MAX_VALENCE))[vertex])
    todo = todo[np.argsort(vertex[todo], kind="stable")]
    start = np.searchsorted(vertex[todo], vertex[todo])
    own, by_corner, total = face[todo // 3], weighted.reshape(-1, 3), np.zeros((len(todo), 3))
    for k in range(int(size[vertex[todo]].max(initial=0))):
        here = np.flatnonzero(k < size[vertex[todo]])
        other = start[here] + k
        near = np.einsum("ij,ij->i", own[here], own[other]) > np.cos(crease)
        total[here[near]] += by_corner[todo[other[near]]]
    normals[todo] = _unit(total)
    return normals.reshape(-1, 3, 3)


def grouped_normals(positions: np.ndarray, triangles: np.ndarray, groups: np.ndarray) -> np.ndarray:
    """The normal of each triangle corner: the mean over the triangles of its smoothing group at that position.

    From (N, 3) positions, (T, 3) vertex indices and the (T,) numbers of the groups, (T, 3, 3) float32. Triangles of
    group 0 are flat.
    """
    corners = positions[triangles]
    face = _unit(_face_normals(corners)).astype(np.float64)
    weighted = corner_angles(corners)[..., None] * face[:, None, :]
    # What is summed: a position of a group, or a triangle of group 0.
    _, group = np.unique(groups, return_inverse=True)
    shared = weld(positions)[triangles].astype(np.int64) * (group.max(initial=0) + 1) + group.reshape(-1, 1)
    keys = np.where(groups[:, None] == 0, -1 - np.arange(len(triangles))[:, None], shared)
    _, key = np.unique(keys, return_inverse=True)
    key = key.ravel()
    return _unit(sum_by(key, weighted.reshape(-1, 3), len(keys) * 3)[key]).reshape(-1, 3, 3)


def corner_angles(corners: np.ndarray) -> np.ndarray:
    """The interior angles of triangles in radians: from (T, 3, 3) corners, (T, 3); 0 if an edge has no length."""
    to_next = unit_vectors(np.roll(corners, -1, axis=1) - corners)
    to_previous = -np.roll(to_next, 1, axis=1)
    return np.arccos(np.clip(np.einsum("tki,tki->tk", to_next, to_previous), -1, 1)) * to_next.any(axis=2)


def sum_by(group: np.ndarray, vectors: np.ndarray, count: int) -> np.ndarray:
    """Sums of (M, C) vectors that share a number in `group` (M,), as (count, C) float64."""
    return np.stack([np.bincount(group, component, count) for component in vectors.T], axis=1)


def _face_normals(corners: np.ndarray) -> np.ndarray:
    """From (T, 3, 3) corners, (T, 3) float64 normals whose length is twice the triangle's area."""
    corners = corners.astype(np.float64)
    return np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])


def _unit(vectors: np.ndarray) -> np.ndarray:
    """Unit vectors as float32; vectors without length become +Z."""
    out = unit_vectors(vectors).astype(np.float32)
    out[~vectors.any(axis=-1)] = (0, 0, 1)
    return out
