"""Shadow rays through media, for Embree: what shaders/trace/shadow_transmittance.glsl does for the BVH in a shader.

A shadow ray passes boundaries between media of one index, and the media on its way dim it.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from ...scene.unit_vectors import unit_vectors
from ..kinds import BOUNDARY
from ..layout import INSTANCE_MASK, KIND_SHIFT, MEDIA_REACH

if TYPE_CHECKING:
    from ..scene.geometry import TraceGeometry


class ShadowMedia:
    """The media of a scene, and the light of shadow rays that is left.

    A `nesting`, (N,) int64, is that of shaders/media/nesting.glsl. Origins and vectors are (N, 3) float32, in tracer
    space.
    """

    def __init__(self, geometry: TraceGeometry) -> None:
        self._sigma_t = (np.array([medium.sigma_t for medium in geometry.media]) * geometry.unit).astype(np.float32)
        self._medium_of = np.array([instance.medium for instance in geometry.instances], np.int64)
        self._nesting = geometry.nesting
        self._fog = geometry.fog

    def along(self, nesting: NDArray, origins: NDArray, vectors: NDArray, start: NDArray, end: NDArray) -> NDArray:
        """Transmittance (N, 3) between the fractions `start` and `end` of each vector, (N,) each."""
        size = np.linalg.norm(vectors, axis=1)
        size[size == 0] = 1
        unit = vectors / size[:, None]
        b = np.einsum("ij,ij->i", origins, unit)
        nearest = origins - b[:, None] * unit
        half_chord = np.sqrt(np.maximum(MEDIA_REACH**2 - np.einsum("ij,ij->i", nearest, nearest), 0))
        begin, until = start * size, np.minimum(end * size, np.maximum(half_chord - b, 0))
        way = np.maximum(until - begin, 0)
        media = self._nesting.innermost(nesting)
        if self._fog is not None:
            outside = np.flatnonzero(media == 0)
            way[outside] = self._fog.length(origins[outside], unit[outside], begin[outside], until[outside])
        return np.exp(-self._sigma_t[media] * way[:, None])

    def cross(self, nesting: NDArray, instances: NDArray, is_front: NDArray) -> NDArray:
        """The nesting behind boundaries of these instances, which are hit on the front or the back."""
        return self._nesting.cross(nesting, self._medium_of[instances], is_front)


def is_boundary(hits: NDArray[np.uint32]) -> NDArray[np.bool_]:
    """Whether hits, (N, 4) texels of the hit texture, are on boundaries that rays pass."""
    return (hits[:, 0] >> KIND_SHIFT & 7) == BOUNDARY.number


def instances_of(hits: NDArray[np.uint32]) -> NDArray[np.int64]:
    """The instances that were hit."""
    return (hits[:, 0] & INSTANCE_MASK).astype(np.int64)


def offset_origin(points: NDArray[np.float32], normals: NDArray[np.float32]) -> NDArray[np.float32]:
    """Points moved off a surface towards `normals`, (N, 3) of any length, as shaders/trace/offset_origin.glsl does."""
    normals = unit_vectors(normals)
    ulps = (256 * normals).astype(np.int32)
    bits = np.ascontiguousarray(points, np.float32).view(np.int32)
    moved = (bits + np.where(points < 0, -ulps, ulps)).view(np.float32)
    return np.where(np.abs(points) < 1 / 32, points + normals / 65536, moved).astype(np.float32)
