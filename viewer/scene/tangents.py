"""Computes tangents for normal maps by the rules of MikkTSpace (Mikkelsen 2008), vectorised.

As in MikkTSpace, a face's tangent points along the texture's u axis. At a vertex the tangents of the adjacent faces are
projected onto the plane perpendicular to the normal and averaged, weighted by the faces' angles. Mirrored and
unmirrored faces are never averaged, and neither are vertices that differ in position, normal or texture coordinates.
Faces without area in texture space take their neighbours' tangent. Unlike in MikkTSpace, faces that share only a vertex
and no edge are averaged as well.
"""

from __future__ import annotations

import numpy as np

from .normals import corner_angles, sum_by
from .weld import weld


def make_tangents(positions: np.ndarray, normals: np.ndarray, uvs: np.ndarray,
                  triangles: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Tangents for an indexed mesh. A vertex that mirrored and unmirrored faces share is split.

    `positions`, `normals` (N, 3) and `uvs` (N, 2) are float32, with v downwards; `triangles` (T, 3) are integers.
    Returns (source, tangents, triangles). Vertex k of the new mesh is a copy of the old vertex source[k]; source is
    (N',) with source[:N] == arange(N). tangents is (N', 4) float32, triangles (T, 3) uint32. The bitangent is
    w * cross(normal, tangent) and points up in the texture image.
    """
    count = len(positions)
    face_tangent, mirrored, usable = _face_tangents(positions, uvs, triangles)
    vertex = triangles.ravel()
    side = np.repeat(mirrored, 3).astype(np.intp)
    normal = normals[vertex]
    tangent = np.repeat(face_tangent, 3, axis=0)
    tangent -= normal * np.einsum("ij,ij->i", normal, tangent)[:, None]
    length = np.sqrt(np.einsum("ij,ij->i", tangent, tangent))
    usable = np.repeat(usable, 3) & (length > 0)
    weight = np.where(usable, corner_angles(positions[triangles]).ravel() / np.where(usable, length, 1), 0)

    welded = weld(positions, normals, uvs)
    group = 2 * welded[vertex] + side
    total = sum_by(group[usable], (tangent * weight[:, None])[usable], 2 * count)

    # Corners of faces without a tangent take the side (mirrored or not) that their vertex has.
    has = np.zeros((count, 2), bool)
    has[vertex[usable], side[usable]] = True
    side = np.where(usable, side, ~has[vertex, 0] & has[vertex, 1])
    # A vertex with both sides stays unmirrored; its mirrored corners get a copy of it after the last vertex.
    split = np.flatnonzero(has.all(axis=1))
    copy_of = np.arange(count)
    copy_of[split] = count + np.arange(len(split))
    new_vertex = np.where(side == 1, copy_of[vertex], vertex)

    source = np.concatenate([np.arange(count), split])
    new_side = np.concatenate([has[:, 1] & ~has[:, 0], np.ones(len(split), bool)]).astype(np.intp)
    return source, _finish(total[2 * welded[source] + new_side], normals[source], new_side), \
        new_vertex.reshape(-1, 3).astype(np.uint32)


def any_tangents(normals: np.ndarray) -> np.ndarray:
    """A unit vector perpendicular to each (N, 3) unit normal, continuous except at z = 0 (Duff et al. 2017)."""
    x, y, z = normals.T
    sign = np.where(z >= 0, 1.0, -1.0)
    a = -1.0 / (sign + z)
    return np.stack([1.0 + sign * x * x * a, sign * x * y * a, -sign * x], axis=1).astype(np.float32)


def _face_tangents(positions: np.ndarray, uvs: np.ndarray,
                   triangles: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """For each triangle: the direction of growing u (T, 3), whether the texture is mirrored (T,), and whether the
    tangent is defined (T,)."""
    p, uv = positions[triangles].astype(np.float64), uvs[triangles].astype(np.float64)
    edge1, edge2 = p[:, 1] - p[:, 0], p[:, 2] - p[:, 0]
    (u1, v1), (u2, v2) = (uv[:, 1] - uv[:, 0]).T, (uv[:, 2] - uv[:, 0]).T
    area = u1 * v2 - u2 * v1
    tangent = v2[:, None] * edge1 - v1[:, None] * edge2
    # v points down, so the area of an unmirrored texture is negative on a counter-clockwise triangle.
    tangent *= np.sign(area)[:, None]
    length = np.sqrt(np.einsum("ij,ij->i", tangent, tangent))
    usable = (area != 0) & (length > 0) & np.isfinite(length)
    tangent[~usable] = 0
    return tangent / np.where(usable, length, 1)[:, None], area > 0, usable


def _finish(total: np.ndarray, normals: np.ndarray, mirrored: np.ndarray) -> np.ndarray:
    """Unit tangents with their handedness, (N, 4) float32, from sums. If a sum is zero, any perpendicular vector."""
    length = np.linalg.norm(total, axis=1)
    good = length > 1e-6
    out = np.empty((len(total), 4), np.float32)
    out[:, :3] = np.where(good[:, None], total / np.where(good, length, 1)[:, None], any_tangents(normals))
    out[:, 3] = 1 - 2 * mirrored
    return out
