"""Curves: many strands, each a line of points with a radius: hair, fur, yarn."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import cached_property
from os import PathLike
from pathlib import Path
from typing import Literal, get_args

import numpy as np

from ..base.expect import expect, expect_path
from ..errors import UsageError
from .arrays import HoldsArrays, scene_array
from .fibre import Fibre

CurveKind = Literal["linear", "catmull-rom", "b-spline"]
FEWEST_POINTS = {"linear": 2, "catmull-rom": 2, "b-spline": 4}
"""The fewest points of a strand of each kind. A closed strand has at least 3."""
_CHUNK = 1 << 16
"""Points per piece of what is computed in float64."""


@dataclass(frozen=True, eq=False, repr=False)
class Curves(HoldsArrays):
    """Strands in world coordinates, each a tube with round ends about a curve through or near its points.

    `points` (n, 3) float32. `radii` (n,) float32, not negative. `offsets` (strands + 1,) int64: the points of strand k
    are offsets[k] to offsets[k + 1]. `closed` (strands,) bool: the strand goes on from its last point to its first.
    The points of a strand run from the root to the tip. `colors` (n, 3) float32 or None: the colour of many such fibres
    together, linear, in place of the fibre's absorption.

    `kind` says how the curve follows from the points. "linear": straight from point to point. "catmull-rom": the
    uniform spline through all points; at the ends of an open strand the spline sees a further point, such that the
    curve runs straight there. "b-spline": the uniform cubic B-spline, which an open strand of n points begins and ends
    a segment away from its outermost points, and n - 3 segments long. The radius and the colour follow the same rule.

    `fibre` says what the strands do to light; None: the settings `hair-...` do. All arrays are held read-only (see
    `scene_array`). Raises UsageError for arrays that cannot be this.
    """

    name: str
    points: np.ndarray
    radii: np.ndarray
    offsets: np.ndarray
    closed: np.ndarray
    kind: CurveKind = "linear"
    colors: np.ndarray | None = None
    fibre: Fibre | None = None

    def __post_init__(self) -> None:
        expect(self.name, str, "Curves.name", "text")
        if self.kind not in get_args(CurveKind):
            raise UsageError(f"Curves.kind is {self.kind!r}, not one of {', '.join(get_args(CurveKind))}")
        if self.fibre is not None:
            expect(self.fibre, Fibre, "Curves.fibre", "a Fibre")
        self._set("points", scene_array(self.points, "Curves.points", np.float32, None, 3))
        count = len(self.points)
        self._set("radii", scene_array(self.radii, "Curves.radii", np.float32, count))
        if count and self.radii.min() < 0:
            worst = int(self.radii.argmin())
            raise UsageError(f"Curves.radii[{worst}] is {self.radii[worst]:g}: a radius is not negative")
        if self.colors is not None:
            self._set("colors", scene_array(self.colors, "Curves.colors", np.float32, count, 3))
        offsets = scene_array(self.offsets, "Curves.offsets", np.int64, None)
        if not len(offsets) or offsets[0] != 0 or offsets[-1] != count or (np.diff(offsets) < 0).any():
            raise UsageError(f"Curves.offsets must rise from 0 to {count}, the number of points")
        if len(offsets) < 2:
            raise UsageError(f"Curves {self.name!r}: there are no strands")
        self._set("offsets", offsets)
        self._set("closed", scene_array(self.closed, "Curves.closed", np.bool_, len(offsets) - 1))
        fewest = np.maximum(FEWEST_POINTS[self.kind] * ~self.closed, 3 * self.closed)
        if (short := self.lengths < fewest).any():
            worst = int(short.argmax())
            raise UsageError(f"Curves: strand {worst} has {self.lengths[worst]} points; at least {fewest[worst]} are "
                             f"needed for one that is {'closed' if self.closed[worst] else self.kind}")

    def __repr__(self) -> str:
        """In one line: the arrays would fill pages."""
        return f"<Curves {self.name!r}: {self.strand_count} strands, {self.kind}, {len(self.points)} points>"

    @property
    def strand_count(self) -> int:
        return len(self.closed)

    @property
    def lengths(self) -> np.ndarray:
        """The number of points of each strand, (strands,) int64."""
        return np.diff(self.offsets)

    @property
    def spans(self) -> np.ndarray:
        """The number of segments of each strand, straight or cubic, (strands,) int64."""
        lost = 3 if self.kind == "b-spline" else 1
        return self.lengths - lost * ~self.closed

    @property
    def layout(self) -> tuple[object, ...]:
        """All that programs and the sizes of buffers depend on, apart from the number of pieces that cubics become."""
        return self.kind, len(self.points), self.strand_count, self.colors is None, self.fibre

    @cached_property
    def corners(self) -> np.ndarray:
        """The corners of the box about all points with their radii, (8, 3) float64; (0, 3) without points."""
        if not len(self.points):
            return np.zeros((0, 3))
        radii = self.radii[:, None].astype(np.float64)
        box = np.stack([(self.points - radii).min(axis=0), (self.points + radii).max(axis=0)])
        return box[np.array([[(k >> axis) & 1 for axis in range(3)] for k in range(8)]), [0, 1, 2]]

    @cached_property
    def widest(self) -> float:
        """The largest radius, 0 without points."""
        return float(self.radii.max(initial=0.0))

    def _chunks(self) -> Iterator[tuple[np.ndarray, np.ndarray]]:
        for first in range(0, len(self.points), _CHUNK):
            part = slice(first, first + _CHUNK)
            yield self.points[part].astype(np.float64), self.radii[part].astype(np.float64)

    def radius_about(self, center: np.ndarray) -> float:
        """The radius of the sphere about `center` that encloses all points with their radii."""
        return max((float((np.linalg.norm(points - center, axis=1) + radii).max())
                    for points, radii in self._chunks()), default=0.0)

    def farthest(self, direction: np.ndarray) -> np.ndarray:
        """What lies farthest along `direction` on the spheres about all points, (3,) float64."""
        best, found, step = -np.inf, np.zeros(3), direction / np.linalg.norm(direction)
        for points, radii in self._chunks():
            along = points @ step + radii
            k = int(along.argmax())
            if along[k] > best:
                best, found = float(along[k]), points[k] + radii[k] * step
        return found

    def save(self, path: str | PathLike[str]) -> None:
        """Write a .curves file, the text that Mitsuba reads, without colours and fibre.

        Mitsuba's `linearcurve` reads straight strands and Catmull-Rom splines, which are written as segments, and its
        `bsplinecurve` B-splines. Raises OutputError, and UsageError for what is no path and for another ending.
        """
        from .curves_text import write_curves

        expect_path(path, "path")
        if Path(path).suffix.lower() != ".curves":
            raise UsageError(f"{path}: curves are saved as .curves")
        write_curves(path, self)

    def with_radius(self, radius: float) -> Curves:
        """The same curves with this radius everywhere; as they are if it is 0. Calls with one radius return the same
        object, so that a renderer keeps what it has of it."""
        if radius == 0 or not len(self.points):
            return self
        known: Curves | None = self.__dict__.get("_thick")
        if known is None or known.radii[0] != np.float32(radius):
            radii = np.full(len(self.points), radius, np.float32)
            radii.flags.writeable = False
            known = self.__dict__["_thick"] = replace(self, radii=radii)
        return known
