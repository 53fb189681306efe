"""STL, binary and ASCII, with the colours that Materialise Magics and VisCAM write into binary files."""

from __future__ import annotations

import re
import struct
from pathlib import Path

import numpy as np

from ..errors import InputError
from .mtl import PLAIN
from .raw_mesh import RawMesh, RawModel, colored, linear_colors
from .text import decoded, number_rows, plain_text

_FACET = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("attribute", "<u2")])
_HEADER = 80
_DATA = 84
_SOLID = re.compile(rb"^ *(end ?solid|solid)\b([^\n]*)", re.MULTILINE | re.IGNORECASE)
_VERTEX = re.compile(rb"vertex\s+(\S+\s+\S+\s+\S+)", re.IGNORECASE)


def read_stl(path: Path, data: bytes, warnings: list[str]) -> RawModel:
    """A mesh for each solid. Raises InputError for a file that ends within a triangle."""
    count = struct.unpack_from("<I", data, _HEADER)[0] if len(data) >= _DATA else 0
    is_binary = len(data) == _DATA + _FACET.itemsize * count and len(data) >= _DATA
    if not is_binary:
        start = plain_text(data[:1 << 16]).lower()
        if b"\0" not in start[:1024] and (b"vertex" in start or start.lstrip().startswith(b"solid")):
            return _read_ascii(path, plain_text(data), warnings)
    return _read_binary(path, data, count, warnings)


def _read_binary(path: Path, data: bytes, count: int, warnings: list[str]) -> RawModel:
    if len(data) < _DATA:
        raise InputError(path, "", f"neither an ASCII STL nor a binary one, which has at least {_DATA} bytes")
    there, rest = divmod(len(data) - _DATA, _FACET.itemsize)
    if rest and there < count:
        raise InputError(path, f"triangle {there + 1}", f"the file ends in it; {count} triangles are declared")
    if rest:
        warnings.append(f"{len(data) - _DATA - count * _FACET.itemsize} bytes behind the last triangle; "
                        "they are left out")
    elif there != count:
        warnings.append(f"{count} triangles are declared and {there} are there; all of these are read")
        count = there
    facets = np.frombuffer(data, _FACET, count, _DATA)
    colors = _facet_colors(data[:_HEADER], facets["attribute"])
    positions = facets["corners"].reshape(-1, 3).astype(np.float64)
    colors = None if colors is None else np.repeat(colors, 3, axis=0)
    return RawModel([RawMesh(path.stem, positions, colors=colors, material=colored(PLAIN, colors), is_faceted=True)])


def _facet_colors(header: bytes, attribute: np.ndarray) -> np.ndarray | None:
    """(T, 4) linear colours of the facets, or None.

    Bit 15 says in files of Magics, known by COLOR= in the header, that a facet has the colour of the header; in files
    of VisCAM that it has one of its own. Five bits each are red, green and blue, from the lowest on in Magics' files,
    from the highest on in VisCAM's.
    """
    marked = attribute >> 15 == 1
    at = header.find(b"COLOR=")
    if at < 0 and not marked.any():
        return None
    low, middle, high = (attribute >> shift & 31 for shift in (0, 5, 10))
    if 0 <= at <= _HEADER - 10:
        default = linear_colors(np.frombuffer(header, np.uint8, 4, at + 6)[None], 255)[0]
        order, has_own = (low, middle, high), ~marked
    elif at < 0:
        default = np.array(PLAIN.base_color, np.float32)
        order, has_own = (high, middle, low), marked
    else:
        return None
    return np.where(has_own[:, None], linear_colors(np.stack(order, axis=1), 31), default)


def _read_ascii(path: Path, text: bytes, warnings: list[str]) -> RawModel:
    names = list(_SOLID.finditer(text))
    starts = [match.end() for match in names]
    ends = [match.start() for match in names[1:]] + [len(text)]
    if not names:
        starts, ends = [0], [len(text)]
    meshes = []
    for number, (start, end) in enumerate(zip(starts, ends)):
        chunk = text[start:end]
        vertices = _VERTEX.findall(chunk)
        if not vertices:
            continue
        name = decoded(names[number][2].strip()) if names else ""
        place = f"solid {name[:40]}" if name else "solid"
        rows = number_rows(path, b"\n".join(b" ".join(v.split()) if b"\n" in v else v for v in vertices),
                           lambda row, place=place: f"{place}, vertex {row + 1}")  # type: ignore[misc]
        if len(rows) % 3:
            problem = f"{len(rows)} vertices, which is no multiple of three"
            raise InputError(path, place, problem)
        meshes.append(RawMesh(name or path.stem, rows.columns(0, 3), is_faceted=True))
    return RawModel(meshes)
