"""Boxes about round segments, for a tree. A long thin segment that runs across the axes would have a box that is almost
empty, so it is given as several pieces with a box each."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    from ..scene.curves import TraceCurves

_MAX_PIECES = 16
_EMPTY = 4.0
"""A piece may have a box of this many times its own area. With 1 to 16 pieces a ray through long straight fibres costs
a quarter of what it costs with one; more gain little."""
_MOST_BOXES = 1 << 21
"""Above so many boxes, 170 MB while the tree is built, segments get fewer pieces."""


def curve_boxes(curves: TraceCurves) -> tuple[NDArray[np.float32], NDArray[np.float32], NDArray[np.int64]]:
    """The lower and upper corners of boxes, (n, 3) float32, and the number of the segment in each, (n,)."""
    first = curves.first.astype(np.int64)
    a, b = curves.points[first], curves.points[first + 1]
    pieces = _pieces(a, b)
    segment = np.repeat(np.arange(len(first)), pieces)
    step = (np.arange(len(segment)) - np.repeat(np.cumsum(pieces) - pieces, pieces)).astype(np.float32)
    count = pieces[segment].astype(np.float32)
    a, b = a[segment], b[segment]
    begin, end = (a + (k / count)[:, None] * (b - a) for k in (step, step + 1))
    lower = np.minimum(begin[:, :3] - begin[:, 3:], end[:, :3] - end[:, 3:])
    upper = np.maximum(begin[:, :3] + begin[:, 3:], end[:, :3] + end[:, 3:])
    return lower - _SLACK, upper + _SLACK, segment


_SLACK = np.float32(1e-7)
"""What rounding takes from a box: a unit in the last place of the scene's radius."""


def _pieces(a: NDArray[np.float32], b: NDArray[np.float32]) -> NDArray[np.int64]:
    """So many that the box of a piece is no more than `_EMPTY` times as large as what is in it, if `_MAX_PIECES` do."""
    size, radius = np.abs(b[:, :3] - a[:, :3]), np.maximum(a[:, 3], b[:, 3])
    x, y, z = size.T
    length = np.linalg.norm(size, axis=1)
    # Half the area of a piece's box is S / n^2 + D r / n + 12 r^2, with S of the segment's box and D its sides' sum.
    # The half area of a cylinder is pi r L / n. The first term is the empty one.
    with np.errstate(divide="ignore", invalid="ignore"):
        wanted = (x * y + y * z + z * x) / (_EMPTY * np.pi * radius * length)
    pieces = np.ceil(np.clip(np.nan_to_num(wanted, nan=1.0, posinf=_MAX_PIECES), 1, _MAX_PIECES)).astype(np.int64)
    too_many = int(pieces.sum()) - max(_MOST_BOXES, len(a))
    if too_many > 0:
        pieces -= np.ceil((pieces - 1) * (too_many / (int(pieces.sum()) - len(a)))).astype(np.int64)
    return pieces
