"""Cem Yuksel's .bcc, binary curve collections: yarns as splines (cemyuksel.com/research/yarnmodels)."""

from __future__ import annotations

import struct
from pathlib import Path

import numpy as np

from ..errors import InputError
from .curve_points import curves_of
from .curves import CurveKind, Curves

_HEADER = struct.Struct("<4s2sBBQQ40s")
"""The signature with the sizes of numbers, the type of curves, the dimensions, the axis that is up, the numbers of
curves and of points, and text. For each curve its number of points follows, negative if it is closed, and the points.
"""
_SIZES = b"BCC\x44"
"""Whole numbers and floats of four bytes."""
_KINDS: dict[bytes, CurveKind] = {b"C0": "catmull-rom", b"PL": "linear"}
_FROM_UP = {0: (1, 0, 2), 1: (0, 1, 2), 2: (0, 2, 1)}
"""Which axis of the file is x, y and z where x, y or z is up there. One of them is turned round, or it would be a
mirror image."""


def read_bcc(path: Path, data: bytes, warnings: list[str]) -> tuple[Curves, str]:
    """The curves, and the text of the header. Raises InputError.

    The format has no radii; half the mean distance of neighbouring points is taken, and a warning says so.
    """
    if len(data) < _HEADER.size:
        raise InputError(path, "", f"the file ends in its header of {_HEADER.size} bytes")
    sizes, kind, dimensions, up, strands, count, text = _HEADER.unpack_from(data)
    if sizes[:3] != _SIZES[:3]:
        raise InputError(path, "header", "not a BCC file: it does not begin with 'BCC'")
    if sizes != _SIZES:
        raise InputError(path, "header", "has numbers of other sizes than four bytes, which are not read")
    if kind not in _KINDS:
        raise InputError(path, "header", f"curves of the type {kind.decode('latin-1')!r} are not read; C0, uniform "
                                         "Catmull-Rom splines, and PL, polylines, are")
    if dimensions != 3 or up > 2:
        raise InputError(path, "header", f"has {dimensions} dimensions of which number {up} is up; 3 are read, of "
                                         "which 0, 1 or 2 is up")
    size = 4 * strands + 12 * count
    if size > len(data) - _HEADER.size:
        raise InputError(path, "header", f"{strands:,} curves of {count:,} points take {size:,} bytes, but the file "
                                         f"has {len(data) - _HEADER.size:,}")
    if size < len(data) - _HEADER.size:
        warnings.append(f"{len(data) - _HEADER.size - size:,} bytes behind the last curve are not read")
    words = np.frombuffer(data, "<i4", size // 4, _HEADER.size)
    at = _places_of_counts(path, words, strands)
    signed = words[at].astype(np.int64)
    if (total := int(np.abs(signed).sum())) != count:
        raise InputError(path, "header", f"says {count:,} points, but the curves have {total:,}")
    is_point = np.ones(len(words), bool)
    is_point[at] = False
    points = words.view("<f4")[is_point].reshape(-1, 3)[:, _FROM_UP[up]]
    if up == 2:
        points[:, 2] *= -1
    elif up == 0:
        points[:, 0] *= -1
    offsets, closed = np.concatenate([[0], np.cumsum(np.abs(signed))]), signed < 0
    curves = curves_of(path, points, np.ones(count, np.float32), offsets, closed, _KINDS[kind])
    steps = np.linalg.norm(np.diff(points, axis=0), axis=1)
    steps[offsets[1:-1] - 1] = 0.0  # from the last point of a curve to the first of the next
    radius = float(steps.sum(dtype=np.float64)) / (2 * (count - strands)) or 1.0
    warnings.append(f"the file has no radii; {radius:g} is taken where no setting gives another, half the mean "
                    "distance of neighbouring points")
    return curves.with_radius(radius), text.split(b"\0")[0].decode("latin-1").strip()


def _places_of_counts(path: Path, words: np.ndarray, strands: int) -> np.ndarray:
    """Where in `words` the number of points of each curve stands, (strands,) int64. Each leads to the next."""
    numbers, places, at = words.data, np.empty(strands, np.int64), 0
    for strand in range(strands):
        if at >= len(numbers):
            raise InputError(path, f"strand {strand}", "the points of the curves before it fill the file")
        places[strand] = at
        at += 1 + 3 * abs(numbers[at])
    if at > len(numbers):
        raise InputError(path, f"strand {strands - 1}", f"has {abs(numbers[int(places[-1])]):,} points, of which the "
                                                        "file ends before the last")
    return places
