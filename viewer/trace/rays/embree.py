"""Traces rays with Embree, where OpenGL runs in software anyway."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING

import embreex
import numpy as np
from numpy.typing import NDArray

from ...gpu.context import Context
from ..layout import FREE, IDLE, INSTANCE_MASK, KIND_SHIFT, MAX_LAYERS, MISS, NO_KIND
from .embree_curves import EmbreeCurves
from .embree_triangles import TASK, EmbreeTriangles
from .intersect import CLASS_OF_IDLE, SHADOW_REACH, Answer, Surfaces, WavefrontTextures
from .see_through import SeeThrough
from .shadow_media import ShadowMedia, instances_of, is_boundary, offset_origin
from .threads import in_other_threads

if TYPE_CHECKING:
    from ..scene.geometry import TraceGeometry

_STEP = 1e-6
"""Step behind a see-through triangle, in tracer units. Hitting the same triangle again does no harm, since the decision
is the same."""


@dataclass
class Rays:
    """The rays of a wavefront in memory, (paths, 4) float32 each, as the textures have them.

    `medium` is read only in scenes with scattering. All lie in `memory`. The first `count` are to be traced.
    `sees_backs` is that of the wavefront.
    """

    origin: NDArray[np.float32]
    direction: NDArray[np.float32]
    shadow_origin: NDArray[np.float32]
    shadow_vector: NDArray[np.float32]
    medium: NDArray[np.float32]
    memory: NDArray[np.float32]
    count: int
    sees_backs: bool

    def part(self, begin: int, end: int) -> Rays:
        """Some of those that are traced."""
        rows = slice(begin, min(end, self.count))
        return Rays(self.origin[rows], self.direction[rows], self.shadow_origin[rows], self.shadow_vector[rows],
                    self.medium[rows], self.memory, rows.stop - begin, self.sees_backs)


class EmbreeIntersector:
    """An `Intersector`, see viewer/trace/rays/intersect.py."""

    tells_classes = True

    def __init__(self, context: Context, geometry: TraceGeometry, surfaces: Surfaces | None) -> None:
        self.name = "embree " + ".".join(embreex.__version__.split(".")[:2])
        self.triangles = EmbreeTriangles(geometry)
        self._is_see_through = np.array([instance.see_through for instance in geometry.instances], bool)
        self._hand, self._open_back = _backs(geometry)
        self._is_pane = _panes(geometry)
        self._has_panes = surfaces is not None and bool(self._is_pane.any())
        self._coverage: SeeThrough | None = None
        if self._is_see_through.any() or self._has_panes:
            if surfaces is None:
                raise ValueError("see-through triangles need their surfaces")
            self._coverage = SeeThrough(context, surfaces)
        self._media = ShadowMedia(geometry) if geometry.scatters else None
        self._curves = EmbreeCurves(geometry.curves) if geometry.curves is not None else None
        self._spare: list[NDArray[np.float32]] = []  # memory whose rays are traced

    def fetch(self, wavefront: WavefrontTextures) -> Rays:
        count = wavefront.origin.width * wavefront.origin.height
        memory = self._spare.pop() if self._spare else None
        if memory is None or memory.shape[1] != count:
            memory = np.empty((5, count, 4), np.float32)
        origin, direction, shadow_vector, shadow_origin, medium = memory
        if wavefront.shadow_origin is wavefront.origin:
            shadow_origin = origin
        else:
            wavefront.read("shadow_origin", shadow_origin)
        for name, texels in (("origin", origin), ("direction", direction), ("shadow_vector", shadow_vector)):
            wavefront.read(name, texels)
        if self._media is not None:
            wavefront.read("medium", medium)
        return Rays(origin, direction, shadow_origin, shadow_vector, medium, memory,
                    wavefront.rows * wavefront.origin.width, wavefront.sees_backs)

    def trace(self, rays: Rays) -> Answer:
        return self.begin(rays)()

    def begin(self, rays: Rays) -> Callable[[], Answer]:
        """Embree lets Python's other threads run. But OpenGL, which see-through surfaces need, belongs to this thread,
        which then waits for the rays, and curves have tasks of their own."""
        if self._coverage is not None or self._curves is not None or rays.count <= TASK:
            answer = self._trace(rays.part(0, rays.count))
            self._spare.append(rays.memory)
            return lambda: answer
        parts = [rays.part(first, first + TASK) for first in range(0, rays.count, TASK)]
        traced = in_other_threads(self._trace, parts)

        def finish() -> Answer:
            answer = Answer.joined(traced())
            self._spare.append(rays.memory)
            return answer

        return finish

    def _trace(self, rays: Rays) -> Answer:
        hits = np.zeros((rays.count, 4), np.uint32)
        hits[:, 0] = MISS
        status = rays.origin[:, 3]
        in_flight = np.flatnonzero(status > IDLE)
        origins, directions = _rows(rays.origin, in_flight), _rows(rays.direction, in_flight)
        found = self.triangles.intersect(origins, directions)
        self.triangles.write_hits(found, hits, in_flight)
        reach = np.where(found["primID"] >= 0, found["tfar"], np.float32(np.inf))
        if self._curves is not None:
            self._curves.overwrite(hits, in_flight, origins, directions, reach)
        classes = self._classes(rays, hits)
        vector = rays.shadow_vector
        shadowed = np.flatnonzero((status != IDLE) & ((vector[:, 0] != 0) | (vector[:, 1] != 0) | (vector[:, 2] != 0)))
        if self._media is not None or self._has_panes:
            along = np.zeros((len(hits), 4), np.float32)
            along[:, 3] = -1
            along[in_flight, 3] = np.where(np.isfinite(reach), reach, -1)
            nesting = np.zeros(len(shadowed), np.int64)
            if self._media is not None:
                medium = rays.medium[shadowed]
                is_same = (medium[:, 3] < 0) | (medium[:, 1] < 0)  # shaders/trace/state.glsl
                nesting = np.where(is_same, medium[:, 0], medium[:, 1]).astype(np.int64)
            along[shadowed, :3] = self._transmittance(
                _rows(rays.shadow_origin, shadowed), _rows(vector, shadowed), nesting, rays.sees_backs)
            return Answer(int(np.count_nonzero(status)), len(in_flight) + len(shadowed), hits, along,
                          classes)
        free = np.zeros(len(hits), np.uint32)
        free[shadowed] = self._free(_rows(rays.shadow_origin, shadowed), _rows(vector, shadowed), rays.sees_backs)
        hits[:, 0] |= free * np.uint32(FREE)
        return Answer(int(np.count_nonzero(status)), len(in_flight) + len(shadowed), hits, None, classes)

    def _classes(self, rays: Rays, hits: NDArray[np.uint32]) -> NDArray[np.uint8]:
        """As `Answer.classes`, of hits whose shadow rays are not written yet."""
        classes = (hits[:, 0] >> KIND_SHIFT).astype(np.uint8)
        if self._media is not None:
            classes += np.uint8(NO_KIND + 1) * ((rays.medium[:, 0] > 0) & (classes != NO_KIND))
        classes[rays.origin[:, 3] == IDLE] = CLASS_OF_IDLE
        return classes

    def store(self, wavefront: WavefrontTextures, answer: Answer) -> None:
        width = wavefront.hit.width
        area = 0, 0, width, len(answer.hits) // width
        wavefront.hit.write(answer.hits, viewport=area)
        if answer.along is not None:
            wavefront.along.write(answer.along, viewport=area)

    def move(self, geometry: TraceGeometry) -> None:
        """embreex can neither refit a tree nor exchange a mesh: if anything moved, Embree builds a new one of all
        triangles. A second tree for what moves costs every ray more than it saves (benchmarks/results/trees.md)."""
        if not self.triangles.are_those_of(geometry):
            self.triangles = EmbreeTriangles(geometry)
        self._is_see_through = np.array([instance.see_through for instance in geometry.instances], bool)
        self._is_pane = _panes(geometry)
        self._hand, self._open_back = _backs(geometry)
        self._media = ShadowMedia(geometry) if geometry.scatters else None
        if geometry.curves is None:
            self._curves = None
        elif self._curves is None or self._curves.curves is not geometry.curves:
            self._curves = EmbreeCurves(geometry.curves)

    def release(self) -> None:
        if self._coverage is not None:
            self._coverage.release()

    def _free(self, origins: NDArray, vectors: NDArray, sees_backs: bool) -> NDArray[np.bool_]:
        """Which shadow rays are unoccluded."""
        free = self._free_of_triangles(origins, vectors, sees_backs)
        if self._curves is not None:
            asked = np.flatnonzero(free)
            free[asked] = self._curves.intersect(origins[asked], vectors[asked], SHADOW_REACH)[0] < 0
        return free

    def _free_of_triangles(self, origins: NDArray, vectors: NDArray, sees_backs: bool) -> NDArray[np.bool_]:
        sees_backs = sees_backs and bool(self._open_back.any())
        if self._coverage is None and not sees_backs:
            return ~self.triangles.occluded(origins, vectors)
        # One layer at a time: Embree finds the nearest triangle, and the shaders decide whether the ray passes it. (To
        # test for opaque occluders first costs more time than it saves.)
        free = np.zeros(len(origins), bool)
        pending = np.arange(len(origins))
        start, vector, reach = origins, vectors, np.full(len(origins), SHADOW_REACH, np.float32)
        for _ in range(MAX_LAYERS):
            found = self.triangles.intersect(start, vector, reach.copy())
            hits = np.empty((len(pending), 4), np.uint32)
            self.triangles.write_hits(found, hits, np.arange(len(pending)))
            hit = found["primID"] >= 0
            free[pending[~hit]] = True
            passes = hit & self._leaves_by_back(found, hits, vector) if sees_backs else np.zeros(len(pending), bool)
            (asked,) = np.nonzero(hit & ~passes)
            asked = asked[self._is_see_through[hits[asked, 0] & INSTANCE_MASK]]
            if len(asked) and self._coverage is not None:
                passes[asked] = self._coverage.pass_through(hits[asked], vectors[pending[asked]])
            (on,) = np.nonzero(passes)
            if not len(on):
                break
            step = found["tfar"][on] + (_STEP / np.linalg.norm(vector[on], axis=1)).astype(np.float32)
            pending, vector, reach = pending[on], vector[on], reach[on] - step
            start = start[on] + step[:, None] * vector
        return free

    def _leaves_by_back(self, found: dict[str, NDArray], hits: NDArray[np.uint32],
                        vectors: NDArray) -> NDArray[np.bool_]:
        """Whether a shadow ray to the camera comes to the front of a single-sided surface, whose back the rays of the
        camera pass, (N,)."""
        instances = np.minimum(instances_of(hits), len(self._open_back) - 1)  # of misses: any
        return self._open_back[instances] & self._meets_front(found["Ng"], vectors, instances)

    def _meets_front(self, normals: NDArray, vectors: NDArray, instances: NDArray) -> NDArray[np.bool_]:
        """Whether rays, (N, 3), come to the front of what they hit; `normals` are Embree's, by the order of corners."""
        return np.einsum("ij,ij->i", normals, vectors) * self._hand[instances] < 0

    def _transmittance(self, origins: NDArray, vectors: NDArray, nesting: NDArray, sees_backs: bool) -> NDArray:
        """The part of the light that media and panes leave of shadow rays, (N, 3), which begin inside of `nesting`."""
        media = self._media
        light = np.zeros((len(origins), 3), np.float32)
        left = np.ones_like(light)
        pending = np.arange(len(origins))
        if self._curves is not None:
            (pending,) = np.nonzero(self._curves.intersect(origins, vectors, SHADOW_REACH)[0] < 0)
            left, nesting = left[pending], nesting[pending]
        start, begin = origins[pending], np.zeros(len(pending), np.float32)
        for _ in range(MAX_LAYERS):
            vector = vectors[pending]
            found = self.triangles.intersect(start, vector, SHADOW_REACH - begin)
            hits = np.empty((len(pending), 4), np.uint32)
            self.triangles.write_hits(found, hits, np.arange(len(pending)))
            hit = found["primID"] >= 0
            end = np.where(hit, begin + found["tfar"], np.float32(1))
            if media is not None:
                left *= media.along(nesting, origins[pending], vector, begin, end)
            light[pending[~hit]] = left[~hit]
            crosses = hit & is_boundary(hits)
            passes = crosses | (hit & self._leaves_by_back(found, hits, vector)) if sees_backs else crosses.copy()
            (asked,) = np.nonzero(hit & ~passes)
            asked = asked[(self._is_see_through | self._is_pane)[instances_of(hits[asked])]]
            if len(asked) and self._coverage is not None:
                through = self._coverage.transmittance(hits[asked], vector[asked])
                left[asked] *= through
                passes[asked] = through.any(axis=1)
            (on,) = np.nonzero(passes)
            if not len(on):
                break
            normal, instances = found["Ng"][on], instances_of(hits[on])
            nesting = nesting[on]
            if media is not None:
                after = media.cross(nesting, instances, self._meets_front(normal, vector[on], instances))
                nesting = np.where(crosses[on], after, nesting)
            is_along = np.einsum("ij,ij->i", normal, vector[on]) > 0
            beyond = np.where(is_along[:, None], normal, -normal)
            start = offset_origin(start[on] + found["tfar"][on, None] * vector[on], beyond)
            pending, left, vector = pending[on], left[on], vector[on]
            begin = np.einsum("ij,ij->i", start - origins[pending], vector) / np.einsum("ij,ij->i", vector, vector)
            begin = begin.astype(np.float32)
        return light


def _backs(geometry: TraceGeometry) -> tuple[NDArray[np.int8], NDArray[np.bool_]]:
    """For each instance -1 if it is mirrored, else 1, and whether rays of the camera pass it from behind, (N,) each."""
    return (np.array([-1 if instance.is_mirrored else 1 for instance in geometry.instances], np.int8),
            np.array([instance.has_open_back for instance in geometry.instances], bool))


def _panes(geometry: TraceGeometry) -> NDArray[np.bool_]:
    """For each instance whether shadow rays pass it, dimmed, (N,)."""
    return np.array([instance.is_pane for instance in geometry.instances], bool)


def _rows(texels: NDArray[np.float32], rows: NDArray[np.intp]) -> NDArray[np.float32]:
    """The xyz of some rows, (len(rows), 3); all rows are not copied."""
    return texels[:, :3] if len(rows) == len(texels) else texels.take(rows, axis=0)[:, :3]
