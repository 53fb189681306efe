"""Cem Yuksel's .hair: strands of hair as polylines (cemyuksel.com/research/hairmodels)."""

from __future__ import annotations

import struct
from pathlib import Path

import numpy as np

from ..errors import InputError
from .curve_points import curves_of
from .curves import Curves

_HEADER = struct.Struct("<4s4I5f88s")
"""The signature, the numbers of strands and of points, which arrays follow, and for all that lack one: the segments of
a strand, the thickness, the transparency and the colour; then text."""
_SEGMENTS, _POINTS, _THICKNESS, _TRANSPARENCY, _COLOR, _UV = 1, 2, 4, 8, 16, 32
"""The bits of the arrays, which follow in this order. The last is an extension of LuxCore."""


def read_hair(path: Path, data: bytes, warnings: list[str]) -> tuple[Curves, str]:
    """The curves, and the text of the header. Raises InputError.

    Thickness is a diameter. The colour of the header is that of a file without an array of colours, unless it is
    white, which is what programs write that know nothing of colours.
    """
    if len(data) < _HEADER.size:
        raise InputError(path, "", f"the file ends in its header of {_HEADER.size} bytes")
    signature, strands, count, arrays, segments, thickness, transparency, *color, text = _HEADER.unpack_from(data)
    if signature != b"HAIR":
        raise InputError(path, "header", "not a HAIR file: it does not begin with 'HAIR'")
    if arrays >= 2 * _UV:
        raise InputError(path, "header", f"names arrays that are not known: bits {arrays:#x}")
    if not arrays & _POINTS:
        raise InputError(path, "header", "says that the file has no points")
    layout = ((_SEGMENTS, "<u2", strands, 1, "segments"), (_POINTS, "<f4", count, 3, "points"),
              (_THICKNESS, "<f4", count, 1, "thickness"), (_TRANSPARENCY, "<f4", count, 1, "transparency"),
              (_COLOR, "<f4", count, 3, "colours"), (_UV, "<f4", count, 2, "texture coordinates"))
    found, offset = {}, _HEADER.size
    for bit, dtype, rows, columns, name in layout:
        if not arrays & bit:
            continue
        size = np.dtype(dtype).itemsize * rows * columns
        if offset + size > len(data):
            raise InputError(path, name, f"{rows:,} of them take {size:,} bytes, but the file has "
                                         f"{len(data) - offset:,} left")
        found[bit] = np.frombuffer(data, dtype, rows * columns, offset).reshape(rows, columns)
        offset += size
    if offset < len(data):
        warnings.append(f"{len(data) - offset:,} bytes behind the last array are not read")
    if _SEGMENTS in found:
        lengths = found[_SEGMENTS][:, 0].astype(np.int64) + 1
    else:
        if strands * (segments + 1) != count:  # checked first: the numbers may be huge
            raise InputError(path, "header", f"{strands:,} strands of {segments:,} segments do not have {count:,} "
                                             "points")
        lengths = np.full(strands, segments + 1, np.int64)
    offsets = np.concatenate([[0], np.cumsum(lengths)])
    if offsets[-1] != count:
        raise InputError(path, "segments", f"the strands have {offsets[-1]:,} points, but the file has {count:,}")
    thick = found[_THICKNESS][:, 0] if _THICKNESS in found else np.full(count, thickness, np.float32)
    if (found[_TRANSPARENCY] if _TRANSPARENCY in found else np.float32(transparency)).any():
        warnings.append("the transparency of hair is left out")
    colors = found.get(_COLOR)
    if colors is None and color != [1.0, 1.0, 1.0]:
        colors = np.tile(np.array(color, np.float32), (count, 1))
    if colors is not None and (colors.min(initial=0) < 0 or colors.max(initial=0) > 1):
        warnings.append("colours below 0 are taken as 0, and those above 1 as 1")
    curves = curves_of(path, found[_POINTS], thick / np.float32(2), offsets, np.zeros(strands, bool), colors=colors)
    return curves, text.split(b"\0")[0].decode("latin-1").strip()
