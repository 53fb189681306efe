"""All triangles of a scene as one of Embree's.

embreex has no instances. So the triangles of every instance are transformed to tracer space in float64 and rounded to
float32, and Embree copies them once more (the limit is `viewer.trace.rays.intersect.EMBREE_TRIANGLES`). We use its
robust mode, which costs a fifth of the speed: without it, one in twenty rays that are aimed exactly at an edge misses.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from embreex.mesh_construction import TriangleMesh
from embreex.rtcore_scene import EmbreeScene
from numpy.typing import NDArray

from ..layout import INSTANCE_MASK
from ..texels import put_texels
from .flatten import flatten
from .intersect import SHADOW_REACH
from .threads import in_threads

if TYPE_CHECKING:
    from ..scene.geometry import TraceGeometry

TASK = 8192
"""Paths whose rays a thread traces before it takes others: some milliseconds."""


class EmbreeTriangles:
    """All instances as one Embree scene, and the instance and triangle of each of its triangles."""

    def __init__(self, geometry: TraceGeometry) -> None:
        self._geometry = geometry
        vertices, triangles, pairs = flatten(geometry, list(enumerate(geometry.instances)))
        self._pairs = pairs.view(np.uint64).ravel()  # one uint64 is faster to look up than two uint32
        self._count = len(triangles)
        if self._count:
            self._scene = EmbreeScene(robust=True)
            self._mesh = TriangleMesh(self._scene, vertices, triangles)
            self.occluded(vertices[:1], vertices[:1])  # Embree builds its tree for the first rays

    def are_those_of(self, geometry: TraceGeometry) -> bool:
        """Whether no triangle of `geometry` has moved or is of another kind."""
        return self._geometry.has_triangles_of(geometry)

    def intersect(self, origins: NDArray, directions: NDArray, reach: NDArray | None = None) -> dict[str, NDArray]:
        """The nearest hits: `primID` (-1: none), `u`, `v` and `tfar`, (rays,) each, and `Ng`, (rays, 3), the normals on
        their front. `tfar` overwrites `reach`."""
        if not self._count or not len(origins):
            nothing = np.zeros(len(origins), np.float32)
            return {"primID": np.full(len(origins), -1), "u": nothing, "v": nothing, "tfar": nothing + np.inf,
                    "Ng": np.zeros((len(origins), 3), np.float32)}

        def trace(first: int) -> dict[str, NDArray]:
            rows = slice(first, first + TASK)
            return self._scene.run(origins[rows], directions[rows], None if reach is None else reach[rows],
                                   query="INTERSECT", output=True)

        found = in_threads(trace, range(0, len(origins), TASK))
        if len(found) == 1:
            return found[0]
        return {name: np.concatenate([part[name] for part in found]) for name in ("primID", "u", "v", "tfar", "Ng")}

    def places(self, primitives: NDArray) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
        """The instance of each triangle that was hit, and its number in the mesh."""
        pairs = self._pairs[primitives]
        return (pairs & np.uint64(INSTANCE_MASK)).astype(np.int64), (pairs >> np.uint64(32)).astype(np.int64)

    def occluded(self, origins: NDArray, vectors: NDArray) -> NDArray[np.bool_]:
        """Whether the vectors, without their ends, are occluded."""
        if not self._count or not len(origins):
            return np.zeros(len(origins), bool)
        return self._scene.run(origins, vectors, SHADOW_REACH, query="OCCLUDED") >= 0

    def write_hits(self, found: dict[str, NDArray], hits: NDArray[np.uint32], texels: NDArray[np.intp]) -> None:
        """Write to rows `texels` of `hits`, (paths, 4), what the hit texture has of what was found."""
        rows = np.empty((len(texels), 4), np.uint32)
        rows.view(np.uint64)[:, 0] = self._pairs.take(found["primID"], mode="wrap")  # -1 takes the last
        rows[:, 2], rows[:, 3] = found["u"].view(np.uint32), found["v"].view(np.uint32)
        put_texels(hits, texels, rows)
