"""What every reader of curves holds to: which points and radii strands may have, and how an error names their place."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np

from ..errors import InputError
from .curves import CurveKind, Curves
from .scene import MAX_EXTENT

Place = Callable[[int], str]
"""Names the place of a point in a file by the point's number."""


def strand_place(offsets: np.ndarray) -> Place:
    """Places as "strand 3, point 7", both counted from 0."""
    def place(point: int) -> str:
        strand = int(np.searchsorted(offsets, point, side="right")) - 1
        return f"strand {strand}, point {point - int(offsets[strand])}"

    return place


def curves_of(path: Path, points: np.ndarray, radii: np.ndarray, offsets: np.ndarray, closed: np.ndarray,
              kind: CurveKind = "linear", colors: np.ndarray | None = None, place: Place | None = None) -> Curves:
    """The curves of a file. Raises InputError for what no curves can be, at the `place` of the point."""
    place = place or strand_place(offsets)
    lengths = np.diff(offsets)
    if not len(lengths):
        raise InputError(path, "", "the file has no strands")
    if (short := lengths < np.where(closed, 3, 2)).any():
        worst = int(short.argmax())
        count = "1 point" if lengths[worst] == 1 else f"{lengths[worst]} points"
        where = place(int(offsets[worst])) if lengths[worst] else f"strand {worst}"
        kind_of, fewest = ("a closed", 3) if closed[worst] else ("a", 2)
        raise InputError(path, where, f"has {count}; {kind_of} strand has at least {fewest}")
    for values, what in ((points, "coordinate"), (radii, "radius"), (colors, "colour")):
        if values is None or (values.max() < MAX_EXTENT and values.min() > -MAX_EXTENT):
            continue
        bad = ~(np.abs(values) < MAX_EXTENT).reshape(len(values), -1).all(axis=1)
        worst = int(bad.argmax())
        problem = f"is beyond {MAX_EXTENT:g}" if np.isfinite(values[worst]).all() else "is infinite or NaN"
        raise InputError(path, place(worst), f"a {what} {problem}")
    if radii.min() < 0:
        worst = int(radii.argmin())
        raise InputError(path, place(worst), f"the radius {radii[worst]:g} is negative")
    if not radii.max() > 0:
        raise InputError(path, "", "all radii are 0: there is nothing to draw")
    if colors is not None:
        colors = np.maximum(colors, 0, dtype=np.float32)
    for values in (points, radii, offsets, closed, colors):
        if values is not None:
            values.flags.writeable = False  # so that they are not copied
    return Curves(path.stem, points, radii, offsets, closed, kind, colors)
