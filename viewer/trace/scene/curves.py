"""The curves of a scene as the path tracer has them: round segments in tracer space, and what their fibres do."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from ...scene.curve_segments import polylines
from ...scene.curves import Curves
from ...scene.fibre import Fibre, gives_color, hair_fibre, sigma_a_of_color
from ...scene.scene import Scene
from ...settings import Settings
from ..kinds import FIBRE
from ..layout import FIBRE_TEXELS, KIND_SHIFT

NO_NEIGHBOUR = -1.0
"""The radius of a row of `TraceCurves.points` at the end of an open strand."""


@dataclass(frozen=True, eq=False)
class TraceCurves:
    """m round segments of several sets of curves.

    `points` (n, 4) float32: x, y, z and the radius. Each strand has its points in a row, and one row more at both ends,
    which has the neighbour there if the strand is closed, else a radius of `NO_NEIGHBOUR`. `first` (m,) uint32 is the
    row of each segment's end at the root; the three rows about it are the other end and those of its neighbours.
    `codes` (m,) uint32 is x of hits of each segment (viewer/trace/rays/intersect.py), with the number of the set.
    `colors` (n, 3) float32, or None if no set has colours; those of sets without are negative. `sources` are the sets.
    """

    points: NDArray[np.float32]
    first: NDArray[np.uint32]
    codes: NDArray[np.uint32]
    colors: NDArray[np.float32] | None
    sources: tuple[Curves, ...]
    strands: int

    def texels(self, settings: Settings) -> dict[str, np.ndarray]:
        """The sections of the scene buffer that shaders/trace/fibre_hit.glsl reads. A colour in the settings is that of
        all fibres; else points have those of their set, if it has any."""
        default, is_colored = hair_fibre(settings), gives_color(settings)
        fibres = [source.fibre or default for source in self.sources]
        if is_colored:
            fibres = [replace(fibre, sigma_a=default.sigma_a) for fibre in fibres]
        sections = {"curve_points": self.points, "fibres": _records(fibres)}
        if self.colors is not None:
            absorption = np.full((len(self.points), 4), -1, np.float32)
            begin = 0
            for fibre, end in zip(fibres, self._last_rows() if not is_colored else ()):
                colored = self.colors[begin:end]
                absorption[begin:end, :3] = np.where(colored < 0, -1, sigma_a_of_color(colored, fibre.beta_n))
                begin = end
            sections["fibre_absorption"] = absorption
        return sections

    def _last_rows(self) -> list[int]:
        """One after the last row of each set."""
        number = self.codes & np.uint32((1 << KIND_SHIFT) - 1)
        ends = np.searchsorted(number, np.arange(len(self.sources)), side="right")
        return [int(self.first[end - 1]) + 3 if end else 0 for end in ends]


def trace_curves(scene: Scene, before: tuple[Scene, TraceCurves | None] | None = None) -> TraceCurves | None:
    """The curves of `scene` in tracer space; None if there are none. Those of the scene `before` are kept if all are
    the same. Raises UsageError for too many segments."""
    if not scene.curves:
        return None
    if before is not None and before[0].curves == scene.curves and before[0].radius == scene.radius and bool(
            (before[0].center == scene.center).all()):
        return before[1]
    kept = [(source, *_distinct(*polylines(source))) for source in scene.curves if source.spans.any()]
    if not kept:
        return None
    has_colors = any(source.colors is not None for source, _, _ in kept)
    points, first, codes, colors, begin = [], [], [], [], 0
    for number, (source, corners, counts) in enumerate(kept):
        # A row before and one after the corners of each strand, whose segments begin at all its corners but the last
        strand = np.repeat(np.arange(len(counts)), counts + 1)
        rows = np.arange(len(strand)) + 2 * strand + 1
        points.append(_points(scene, corners, counts, rows))
        segment = np.repeat(np.arange(len(counts)), counts)
        first.append((begin + np.arange(len(segment)) + 3 * segment + 1).astype(np.uint32))
        codes.append(np.full(len(segment), FIBRE.number << KIND_SHIFT | number, np.uint32))
        if has_colors:
            colors.append(np.full((len(points[-1]), 3), -1, np.float32))
            if source.colors is not None:
                colors[-1][rows] = corners[:, 4:]
        begin += len(points[-1])
    return TraceCurves(np.concatenate(points), np.concatenate(first), np.concatenate(codes),
                       np.concatenate(colors) if has_colors else None, tuple(source for source, _, _ in kept),
                       sum(len(counts) for _, _, counts in kept))


def _distinct(corners: NDArray[np.float32], counts: NDArray[np.int64]) -> tuple[NDArray[np.float32], NDArray[np.int64]]:
    """Without corners that repeat the one before, which would be spheres of no direction in the place of a strand's
    end. A strand keeps two corners at least."""
    ends = np.cumsum(counts + 1)
    is_kept = np.append(True, (corners[1:, :4] != corners[:-1, :4]).any(axis=1))
    is_kept[ends - counts - 1] = True
    if is_kept.all():
        return corners, counts
    left = np.add.reduceat(is_kept, ends - counts - 1, dtype=np.int64)
    is_kept[ends[(left == 1) & (counts > 0)] - 1] = True
    left = np.maximum(left, np.minimum(counts + 1, 2))
    return corners[is_kept], left - 1


def _points(scene: Scene, corners: NDArray[np.float32], counts: NDArray[np.int64], rows: NDArray[np.int64]
            ) -> NDArray[np.float32]:
    """The rows of strands of so many segments; `rows` are those of their corners."""
    points = np.zeros((len(corners) + 2 * len(counts), 4), np.float32)
    points[:, 3] = NO_NEIGHBOUR
    points[rows, :3] = (corners[:, :3] - scene.center) / scene.radius
    points[rows, 3] = corners[:, 3] / scene.radius
    last = np.cumsum(counts + 1) - 1
    root = last - counts
    is_closed = (corners[last, :4] == corners[root, :4]).all(axis=1) & (counts > 2)
    root, last = rows[root[is_closed]], rows[last[is_closed]]
    points[root - 1], points[last + 1] = points[last - 1], points[root + 1]
    return points


def _records(fibres: Sequence[Fibre]) -> NDArray[np.float32]:
    """The records of the section `fibres`: sigma_a, beta_m; beta_n, tilt, ior, 0."""
    records = np.zeros((len(fibres), FIBRE_TEXELS, 4), np.float32)
    for row, fibre in zip(records, fibres):
        row[0] = *fibre.sigma_a, fibre.beta_m
        row[1, :3] = fibre.beta_n, fibre.tilt, fibre.ior
    return records.reshape(-1, 4)
