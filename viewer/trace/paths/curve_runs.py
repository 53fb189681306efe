"""Boxes about runs of a few segments of a strand, for what need not know each segment."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    from ..scene.curves import TraceCurves

_RUNS = 1 << 18
"""About the most runs into which strands are cut; each strand has one at least."""
_CORNERS = np.array([[(k >> axis) & 1 for axis in range(3)] for k in range(8)], bool)


def curve_runs(curves: TraceCurves) -> NDArray[np.float64]:
    """The corners of boxes that hold all segments with their radii, (boxes, 8, 3), in tracer space."""
    first = curves.first.astype(np.int64)
    count, number = len(first), np.arange(len(first))
    is_root = np.r_[True, first[1:] != first[:-1] + 1]
    in_strand = number - np.maximum.accumulate(np.where(is_root, number, 0))
    begins = np.flatnonzero(in_strand % -(-count // _RUNS) == 0)
    rows = np.stack([first[begins], first[np.append(begins[1:], count) - 1] + 2], axis=1)  # of points, and one after
    low, high = (bound.reduceat(curves.points, rows.ravel())[::2].astype(np.float64)
                 for bound in (np.minimum, np.maximum))
    radius = high[:, 3:]
    low, high = low[:, :3] - radius, high[:, :3] + radius
    return np.where(_CORNERS, high[:, None], low[:, None])
