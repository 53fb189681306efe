"""Which pixels of a picture camera rays can meet geometry in: conservative, so that the others need not be traced."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from ...scene.camera import Camera
from ...scene.scene import Scene
from .camera_rays import projection
from .curve_runs import curve_runs

if TYPE_CHECKING:
    from ..scene.geometry import TraceGeometry

MOST_TRIANGLES = 2_000_000
"""More would take longer here than many pictures gain."""
NEAREST = 1e-3
"""Least distance from the eye along the view, in tracer units, at which geometry is projected."""
ERROR = 4e-6
"""How far, in tracer units, the float32 rays of the tracer may be from where a pixel is."""
_SMALL = 1 / 64
"""Part of the picture's side up to which the box of a triangle stands for it."""
_CHUNK = 1 << 20


def coverage(geometry: TraceGeometry, scene: Scene, camera: Camera, size: tuple[int, int],
             every: int = 1) -> NDArray[np.bool_] | None:
    """Whether any triangle or curve may be seen in each pixel, (H, W), row 0 at the bottom; `size` and `every` are as
    for `camera_uniforms`. None if that is not known, or is true of all pixels.

    A pixel is as wide as its box filter, and at least one pixel more on each side. Nothing is known of scenes with
    volumes or fog, and where geometry comes close to the eye or is behind it.
    """
    if geometry.has_grids or geometry.fog is not None or geometry.triangle_count > MOST_TRIANGLES:
        return None
    view, spans = _View(scene, camera, size), _Spans(size)
    for instance in geometry.instances:
        mesh = geometry.meshes[instance.mesh]
        if not len(mesh.triangles):
            continue
        seen = view.pixels(mesh.positions @ instance.transform[:, :3].T + instance.transform[:, 3])
        if seen is None:
            return None
        for first in range(0, len(mesh.triangles), _CHUNK):
            spans.add(seen[0], mesh.triangles[first:first + _CHUNK], seen[1])
    if geometry.curves is not None:
        corners = curve_runs(geometry.curves)
        seen = view.pixels(corners.reshape(-1, 3))
        if seen is None:
            return None
        pixels, margin = seen[0].reshape(-1, 8, 2), seen[1]
        spans.add_boxes(np.floor(pixels.min(axis=1) - margin), np.floor(pixels.max(axis=1) + margin))
    covered = spans.covered()[every // 2::every, every // 2::every][:size[1] // every, :size[0] // every]
    return None if covered.all() else covered


class LastCoverage:
    """`coverage`, which keeps its last answer: a picture in many parts asks for it again for each of them."""

    def __init__(self) -> None:
        self._asked: tuple[object, ...] | None = None
        self._answer: NDArray[np.bool_] | None = None

    def __call__(self, geometry: TraceGeometry, scene: Scene, camera: Camera, size: tuple[int, int],
                 every: int = 1) -> NDArray[np.bool_] | None:
        asked = geometry, scene, camera, size, every  # the first three are equal only to themselves
        if asked != self._asked:
            self._asked, self._answer = asked, coverage(geometry, scene, camera, size, every)
        return self._answer


class _View:
    """Projects points of tracer space to pixels."""

    def __init__(self, scene: Scene, camera: Camera, size: tuple[int, int]) -> None:
        self._matrix, self._offset, self._unit = projection(scene, camera, size)
        self._half = np.array(size) / 2

    def pixels(self, points: NDArray[np.floating]) -> tuple[NDArray[np.float64], float] | None:
        """Where they are seen, (N, 2), and the margin of what they bound; None if any is too close to the eye."""
        x, y, w = self._matrix @ points.T + self._offset[:, None]
        nearest = float(w.min())
        if not nearest * self._unit >= NEAREST:
            return None
        farthest_off = ERROR * float(np.linalg.norm(self._matrix[:2], axis=1).max() * self._half.max()) / nearest
        return np.stack([x / w + 1, y / w + 1], axis=1) * self._half, 1 + farthest_off


class _Spans:
    """Collects rectangles of pixels by the differences at their corners, which are summed up at the end.

    Corners are counted many at a time, since that goes over the whole picture: there may be thousands of instances.
    """

    def __init__(self, size: tuple[int, int]) -> None:
        self._size, self._small = np.array(size), max(size) * _SMALL
        self._differences = np.zeros((size[1] + 1) * (size[0] + 1), np.int64)
        self._corners: dict[int, list[NDArray[np.int64]]] = {1: [], -1: []}
        """By their differences, those that are not counted yet."""
        self._waiting = 0

    def add(self, points: NDArray[np.float64], triangles: NDArray[np.uint32], margin: float) -> None:
        """Add triangles, (N, 3), of points, (V, 2), in pixels, widened by `margin`."""
        boxes = np.concatenate([np.floor(points - margin), np.floor(points + margin)], axis=1)
        columns = np.clip(boxes, -1, np.tile(self._size, 2)).astype(np.int32).T.copy()
        a, b, c = triangles.T
        x0, y0 = (np.minimum(np.minimum(of[a], of[b]), of[c]) for of in columns[:2])
        x1, y1 = (np.maximum(np.maximum(of[a], of[b]), of[c]) for of in columns[2:])
        is_seen = (x1 >= 0) & (y1 >= 0) & (x0 < self._size[0]) & (y0 < self._size[1])
        is_small = np.maximum(x1 - x0, y1 - y0) <= self._small + 2 * margin
        chosen = is_seen & is_small
        self._add_boxes(*(edge[chosen] for edge in (x0, y0, x1, y1)))
        large = points[triangles[is_seen & ~is_small]]
        for part in np.array_split(large, max(len(large) * int(self._size[1]) // (_CHUNK), 1)):
            self._add_rows(part, margin)

    def add_boxes(self, low: NDArray[np.float64], high: NDArray[np.float64]) -> None:
        """Add rectangles between pixels, (N, 2) each, which belong to them; those outside of the picture are left out.
        """
        is_seen = ((high >= 0) & (low < self._size)).all(axis=1)
        (x0, y0), (x1, y1) = low[is_seen].T, high[is_seen].T
        self._add_boxes(x0, y0, x1, y1)

    def _add_rows(self, corners: NDArray[np.float64], margin: float) -> None:
        """Add the pixels of each row between the triangle's ends in it."""
        if not len(corners):
            return
        height = self._size[1]
        first = np.clip(np.floor(corners[..., 1].min(axis=1) - margin), 0, height - 1).astype(np.int64)
        last = np.clip(np.floor(corners[..., 1].max(axis=1) + margin), 0, height - 1).astype(np.int64)
        count = last - first + 1
        which = np.repeat(np.arange(len(corners)), count)
        row = np.arange(len(which)) - np.repeat(np.cumsum(count) - count, count) + first[which]
        bottom, top = row - margin, row + 1 + margin
        left, right = np.full(len(row), np.inf), np.full(len(row), -np.inf)
        for k in range(3):
            start, way = corners[which, k], (corners[:, k - 2] - corners[:, k])[which]
            rise = np.where(way[:, 1] == 0, 1.0, way[:, 1])
            ends = np.stack([bottom - start[:, 1], top - start[:, 1]]) / rise
            ends = np.where(way[:, 1] == 0, [[0.0], [1.0]], ends)  # of a horizontal edge: all of it
            enter, leave = np.clip(ends.min(axis=0), 0, None), np.clip(ends.max(axis=0), None, 1)
            meets = enter <= leave
            meets &= (np.maximum(start[:, 1], start[:, 1] + way[:, 1]) >= bottom)
            meets &= (np.minimum(start[:, 1], start[:, 1] + way[:, 1]) <= top)
            for x in (start[:, 0] + enter * way[:, 0], start[:, 0] + leave * way[:, 0]):
                left, right = np.where(meets, np.minimum(left, x), left), np.where(meets, np.maximum(right, x), right)
        found = (left <= right) & (right + margin >= 0) & (left - margin < self._size[0])
        row = row[found]
        self._add_boxes(np.floor(left[found] - margin), row, np.floor(right[found] + margin), row)

    def _add_boxes(self, x0: NDArray, y0: NDArray, x1: NDArray, y1: NDArray) -> None:
        """Add rectangles of pixels, all of whose edges belong to them."""
        x0, x1 = (np.clip(x, 0, self._size[0] - 1).astype(np.int64) for x in (x0, x1))
        y0, y1 = (np.clip(y, 0, self._size[1] - 1).astype(np.int64) * (self._size[0] + 1) for y in (y0, y1))
        x1, y1 = x1 + 1, y1 + self._size[0] + 1
        self._corners[1] += y0 + x0, y1 + x1
        self._corners[-1] += y0 + x1, y1 + x0
        self._waiting += len(x0)
        if self._waiting > _CHUNK:
            self._count()

    def _count(self) -> None:
        for difference, corners in self._corners.items():
            if corners:
                counts = np.bincount(np.concatenate(corners), minlength=len(self._differences))
                self._differences += difference * counts
                corners.clear()
        self._waiting = 0

    def covered(self) -> NDArray[np.bool_]:
        """Whether each pixel is in any of them, (H, W)."""
        self._count()
        table = self._differences.reshape(self._size[1] + 1, self._size[0] + 1)
        return table.cumsum(axis=0).cumsum(axis=1)[:-1, :-1] > 0
