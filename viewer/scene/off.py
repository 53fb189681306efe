"""OFF, Geomview's object file format, as text."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np

from ..errors import InputError
from .mtl import PLAIN
from .raw_mesh import RawMesh, RawModel, colored, cut_polygons, linear_colors
from .text import line_of_row, number_rows, plain_text, without_comments

_KEYWORD = re.compile(rb"\s*(ST)?([CN4n]*)OFF\b")


def read_off(path: Path, data: bytes, warnings: list[str]) -> RawModel:
    """One mesh. Vertices may have normals, colours and texture coordinates, faces colours.

    Raises InputError about binary files, other than three dimensions, and rows that do not fit what is declared.
    """
    text = without_comments(plain_text(data))
    keyword = _KEYWORD.match(text)
    body = text[keyword.end():] if keyword else text
    if body.lstrip(b" ").startswith(b"BINARY"):
        raise InputError(path, "", "a binary OFF; only text is read")
    has_uvs = keyword is not None and keyword[1] is not None
    letters = keyword[2] if keyword else b""
    has_colors, has_normals, is_homogeneous = (letter in letters for letter in (b"C", b"N", b"4"))
    if b"n" in letters:
        raise InputError(path, "", "an nOFF, whose vertices have other than three dimensions")

    rows = number_rows(path, body, line_of_row(body, 1 + text[:len(text) - len(body)].count(b"\n")))
    if not len(rows) or rows.counts[0] < 2:
        raise InputError(path, "", "there are no numbers of vertices and faces")
    vertex_count, face_count = (int(x) if 0 <= x < len(data) else -1 for x in rows.values[:2])
    if min(vertex_count, face_count) < 0 or 1 + vertex_count + face_count > len(rows):
        problem = f"{rows.values[0]:.15g} vertices and {rows.values[1]:.15g} faces are declared in {len(rows)} lines"
        raise InputError(path, "", problem)

    first = rows.starts[1:vertex_count + 1]
    counts = rows.counts[1:vertex_count + 1]
    size = 4 if is_homogeneous else 3
    needed = size + (3 if has_normals else 0) + (3 if has_colors else 0) + (2 if has_uvs else 0)
    if (counts < needed).any():
        row = int((counts < needed).argmax())
        raise InputError(path, f"vertex {row}", f"{counts[row]} numbers where {needed} are needed")

    def columns(start: int, count: int) -> np.ndarray:
        return rows.values[first[:, None] + np.arange(start, start + count)]
    positions = columns(0, 3)
    if is_homogeneous:
        positions = positions / columns(3, 1)
    normals = columns(size, 3) if has_normals else None
    at = size + (3 if has_normals else 0)
    channels = 4 if (counts - at - (2 if has_uvs else 0)).min(initial=4) >= 4 else 3
    colors = linear_colors(columns(at, channels), warnings=warnings) if has_colors else None
    uvs = columns(at + (channels if has_colors else 0), 2) if has_uvs else None
    mesh = RawMesh(path.stem, positions, normals=normals, uvs=uvs, colors=colors, material=colored(PLAIN, colors))
    if not face_count:
        return RawModel([RawMesh(path.stem, positions, "points", colors=colors, material=colored(PLAIN, colors))])
    return RawModel([_with_faces(path, mesh, rows.values, rows.starts[1 + vertex_count:][:face_count + 1], warnings)])


def _with_faces(path: Path, mesh: RawMesh, values: np.ndarray, starts: np.ndarray, warnings: list[str]) -> RawMesh:
    first, counts = starts[:-1], np.diff(starts)
    sizes = values[first]
    wrong = (sizes < 0) | (sizes > counts - 1) | (sizes != np.floor(sizes))
    if wrong.any():
        which = int(wrong.argmax())
        problem = f"{sizes[which]:.15g} corners are declared in a line of {counts[which]} numbers"
        raise InputError(path, f"face {which}", problem)
    sizes = sizes.astype(np.int64)
    corner_face = np.repeat(np.arange(len(sizes)), sizes)
    position = np.arange(len(corner_face)) - np.repeat(np.cumsum(sizes) - sizes, sizes)
    corners = values[first[corner_face] + 1 + position]
    wrong = (corners < 0) | (corners >= len(mesh.positions))
    if wrong.any():
        which = int(wrong.argmax())
        problem = f"vertex {corners[which]:.15g} of {len(mesh.positions)}, which count from 0"
        raise InputError(path, f"face {corner_face[which]}", problem)
    corners = corners.astype(np.int64)
    kept, face = cut_polygons(mesh.positions, corners, sizes, warnings)
    colors = _face_colors(values, first + 1 + sizes, counts - 1 - sizes, warnings)
    if colors is None or mesh.colors is not None:
        return RawMesh(mesh.name, mesh.positions, "triangles", corners[kept], mesh.normals, mesh.uvs, mesh.colors,
                       mesh.material)
    made = mesh.picked(corners[kept])
    colors = np.repeat(colors[face], 3, axis=0)
    return RawMesh(made.name, made.positions, normals=made.normals, uvs=made.uvs, colors=colors,
                   material=colored(PLAIN, colors))


def _face_colors(values: np.ndarray, at: np.ndarray, counts: np.ndarray,
                 warnings: list[str]) -> np.ndarray | None:
    """(F, 4) linear colours, PLAIN's where a face has none; None where no face has three or four numbers of colour."""
    has_color = (counts == 3) | (counts == 4)
    if not has_color.any():
        return None
    colors = np.tile(np.array(PLAIN.base_color, np.float32), (len(at), 1))
    channels = 3 if (counts[has_color] == 3).any() else 4
    colors[has_color] = linear_colors(values[at[has_color, None] + np.arange(channels)], warnings=warnings)
    return colors
