"""Boxes about runs of a few segments of a strand, for what need not know each segment."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    from ..scene.curves import TraceCurves

_RUNS = 1 << 16
"""About the most runs into which strands are cut; each strand has one at least."""
_CORNERS = np.array([[(k >> axis) & 1 for axis in range(3)] for k in range(8)], bool)


def curve_runs(curves: TraceCurves) -> NDArray[np.float64]:
    """The corners of boxes that hold all segments with their radii, (boxes, 8, 3), in tracer space."""
    first = curves.first
    roots = np.append(0, np.flatnonzero(np.diff(first) != 1) + 1)
    counts = np.diff(np.append(roots, len(first)))
    most = -(-len(first) // _RUNS)  # segments of a run
    runs = -(-counts // most)
    begins = np.repeat(roots, runs) + most * (np.arange(runs.sum()) - np.repeat(np.cumsum(runs) - runs, runs))
    ends = np.append(begins[1:], len(first)) - 1
    rows = np.stack([first[begins], first[ends] + 2], axis=1).astype(np.int64)  # of points, and one after
    low, high = (bound.reduceat(curves.points, rows.ravel())[::2].astype(np.float64)
                 for bound in (np.minimum, np.maximum))
    radius = high[:, 3:]
    low, high = low[:, :3] - radius, high[:, :3] + radius
    return np.where(_CORNERS, high[:, None], low[:, None])
