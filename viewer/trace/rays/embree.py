"""Rays through Embree, for where OpenGL is software anyway.

embreex has no instances: every instance's triangles are put into tracer space in float64, rounded to float32 and kept
by Embree once more (`viewer.trace.intersect.EMBREE_TRIANGLES` is the limit). Its robust mode is used, which costs a
fifth of the speed: without it one ray in twenty that is aimed exactly at an edge slips through.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import embreex
import numpy as np
from embreex.mesh_construction import TriangleMesh
from embreex.rtcore_scene import EmbreeScene
from numpy.typing import NDArray

from ...gpu.context import Context
from ..layout import FREE, IDLE, IN_FLIGHT, INSTANCE_MASK, MISS
from .flatten import flatten
from .intersect import SHADOW_REACH, Answer, Surfaces, WaveTextures
from .see_through import MAX_LAYERS, SeeThrough

if TYPE_CHECKING:
    from ..scene.geometry import TraceGeometry

_STEP = 1e-6
"""From one see-through triangle to the next, in tracer units. To meet the same one again does no harm: it decides the
same again."""


@dataclass
class Rays:
    """A wave's rays on this side, (slots, 4) float32 each, as the textures have them."""

    origin: NDArray[np.float32]
    direction: NDArray[np.float32]
    shadow_origin: NDArray[np.float32]
    shadow_vector: NDArray[np.float32]


class EmbreeIntersector:
    """See `viewer.trace.intersect.Intersector`."""

    def __init__(self, context: Context, geometry: TraceGeometry, surfaces: Surfaces | None = None) -> None:
        self.name = "embree " + ".".join(embreex.__version__.split(".")[:2])
        self._triangles = _Triangles(geometry)
        self._is_see_through = np.array([instance.see_through for instance in geometry.instances], bool)
        self._coverage: SeeThrough | None = None
        if self._is_see_through.any():
            if surfaces is None:
                raise ValueError("see-through triangles need their surfaces")
            self._coverage = SeeThrough(context, surfaces)
        self._rays: Rays | None = None

    def fetch(self, wave: WaveTextures) -> Rays:
        slots = wave.origin.width * wave.origin.height
        if self._rays is None or len(self._rays.origin) != slots:
            self._rays = Rays(*(np.empty((slots, 4), np.float32) for _ in range(4)))
        rays = self._rays
        wave.origin.read_into(rays.origin)
        wave.direction.read_into(rays.direction)
        wave.shadow_origin.read_into(rays.shadow_origin)
        wave.shadow_vector.read_into(rays.shadow_vector)
        return rays

    def trace(self, rays: Rays) -> Answer:
        words = np.zeros((len(rays.origin), 4), np.uint32)
        words[:, 0] = MISS
        state = rays.origin[:, 3]
        moving = np.flatnonzero(state == IN_FLIGHT)
        found = self._triangles.intersect(_rows(rays.origin, moving), _rows(rays.direction, moving))
        self._triangles.put(found, words, moving)
        vector = rays.shadow_vector
        shadowed = np.flatnonzero((state != IDLE) & ((vector[:, 0] != 0) | (vector[:, 1] != 0) | (vector[:, 2] != 0)))
        free = np.zeros(len(words), np.uint32)
        free[shadowed] = self._free(_rows(rays.shadow_origin, shadowed), _rows(vector, shadowed))
        words[:, 0] |= free * np.uint32(FREE)
        return Answer(int(np.count_nonzero(state)), len(moving) + len(shadowed), words)

    def store(self, wave: WaveTextures, answer: Answer) -> None:
        wave.hit.write(answer.words)

    def release(self) -> None:
        if self._coverage is not None:
            self._coverage.release()

    def _free(self, origins: NDArray, vectors: NDArray) -> NDArray[np.bool_]:
        """Which shadow rays meet nothing."""
        if self._coverage is None:
            return ~self._triangles.occluded(origins, vectors)
        # Layer after layer: Embree gives the nearest triangle in the way, the shaders its coverage. (To look for what
        # stops a ray for certain beforehand costs more than it saves.)
        free = np.zeros(len(origins), bool)
        pending = np.arange(len(origins))
        start, vector, reach = origins, vectors, np.full(len(origins), SHADOW_REACH, np.float32)
        for _ in range(MAX_LAYERS):
            found = self._triangles.intersect(start, vector, reach.copy())
            words = np.empty((len(pending), 4), np.uint32)
            self._triangles.put(found, words, np.arange(len(pending)))
            hit = found["primID"] >= 0
            free[pending[~hit]] = True
            (asked,) = np.nonzero(hit)
            asked = asked[self._is_see_through[words[asked, 0] & INSTANCE_MASK]]
            if not len(asked):
                break
            on = asked[self._coverage.passes(words[asked], vectors[pending[asked]])]
            step = found["tfar"][on] + (_STEP / np.linalg.norm(vector[on], axis=1)).astype(np.float32)
            pending, vector, reach = pending[on], vector[on], reach[on] - step
            start = start[on] + step[:, None] * vector
        return free


class _Triangles:
    """All instances as one Embree scene, and the way back from its triangles to theirs."""

    def __init__(self, geometry: TraceGeometry) -> None:
        vertices, triangles, words = flatten(geometry, list(enumerate(geometry.instances)))
        self._pairs = words.view(np.uint64).ravel()  # faster to look up than two by two
        self._count = len(triangles)
        if self._count:
            self._scene = EmbreeScene(robust=True)
            self._mesh = TriangleMesh(self._scene, vertices, triangles)
            self.occluded(vertices[:1], vertices[:1])  # the first rays build it

    def intersect(self, origins: NDArray, directions: NDArray, reach: NDArray | None = None) -> dict[str, NDArray]:
        """The nearest hits, (rays,) each of `primID` (-1: none), `u`, `v` and `tfar`, which is `reach` written over."""
        if not self._count or not len(origins):
            nothing = np.zeros(len(origins), np.float32)
            return {"primID": np.full(len(origins), -1), "u": nothing, "v": nothing, "tfar": nothing + np.inf}
        return self._scene.run(origins, directions, reach, query="INTERSECT", output=True)

    def occluded(self, origins: NDArray, vectors: NDArray) -> NDArray[np.bool_]:
        """Whether anything lies on the vectors, their ends left out."""
        if not self._count or not len(origins):
            return np.zeros(len(origins), bool)
        return self._scene.run(origins, vectors, SHADOW_REACH, query="OCCLUDED") >= 0

    def put(self, found: dict[str, NDArray], words: NDArray[np.uint32], slots: NDArray[np.intp]) -> None:
        """Write hits as the hit texture has them to some of the slots' `words` (all slots, 4)."""
        words.view(np.uint64)[slots, 0] = self._pairs.take(found["primID"], mode="wrap")  # -1: the last
        words[slots, 2] = found["u"].view(np.uint32)
        words[slots, 3] = found["v"].view(np.uint32)


def _rows(texels: NDArray[np.float32], slots: NDArray[np.intp]) -> NDArray[np.float32]:
    """xyz of some slots, (len(slots), 3); of all of them without a copy."""
    return texels[:, :3] if len(slots) == len(texels) else texels.take(slots, axis=0)[:, :3]
