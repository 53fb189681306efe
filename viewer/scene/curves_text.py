"""Mitsuba's curves as text: a point a line, `x y z radius`, and a blank line between strands."""

from __future__ import annotations

from os import PathLike
from pathlib import Path

import numpy as np

from ..base.atomic import atomic_write
from ..errors import InputError
from .curve_points import curves_of
from .curve_segments import segments
from .curves import Curves
from .text import line_of_row, number_rows, plain_text


def read_curves(path: Path, data: bytes, warnings: list[str]) -> tuple[Curves, str]:
    """The curves, and no text. Raises InputError."""
    text = plain_text(data)
    rows = number_rows(path, text, line_of_row(text))
    if (bad := rows.counts != 4).any():
        worst = int(bad.argmax())
        raise InputError(path, f"line {rows.lines[worst] + 1}",
                         f"has {rows.counts[worst]} numbers; a point has 4: x, y, z and its radius")
    values = rows.values.reshape(-1, 4).astype(np.float32)
    first = np.flatnonzero(np.diff(rows.lines, prepend=-2) > 1)
    offsets = np.append(first, len(values)) if len(values) else np.zeros(1, np.int64)
    return curves_of(path, np.ascontiguousarray(values[:, :3]), np.ascontiguousarray(values[:, 3]), offsets,
                     np.zeros(len(offsets) - 1, bool), place=lambda point: f"line {rows.lines[point] + 1}"), ""


def write_curves(path: str | PathLike[str], curves: Curves) -> None:
    """Write the points of straight strands and of B-splines, which Mitsuba's `linearcurve` and `bsplinecurve` read, and
    the segments of Catmull-Rom splines. What is closed ends where it began. Raises OutputError."""
    if curves.kind == "b-spline":
        rows = np.column_stack([curves.points, curves.radii])
        strands = [np.concatenate([part, part[:3]]) if closed else part
                   for part, closed in zip(np.split(rows, curves.offsets[1:-1]), curves.closed, strict=True)]
    else:
        pieces = segments(curves)
        cuts = np.flatnonzero(np.diff(pieces.strand)) + 1
        strands = [np.concatenate([part[:, 0], part[-1:, 1]]) for part in np.split(pieces.ends, cuts) if len(part)]
    with atomic_write(path) as temporary, temporary.open("w") as file:
        for k, strand in enumerate(strands):  # 9 digits are enough to read the same float32 again
            file.write("\n" * (k > 0) + "%.9g %.9g %.9g %.9g\n" * len(strand) % tuple(strand.ravel().tolist()))
