"""Wavefront OBJ: polygons, lines and points, with materials."""

from __future__ import annotations

import re
from collections import Counter
from dataclasses import replace
from pathlib import Path

import numpy as np

from ..errors import InputError
from .material import Material
from .mesh import Topology
from .mtl import PLAIN, MaterialLibrary, without_textures
from .raw_mesh import RawMesh, RawModel, colored, cut_polygons, linear_colors
from .text import NumberRows, decoded, number_rows, plain_text

_TABLES = ("v", "vt", "vn", "f", "l", "p")
_SILENT = {"o", "g", "mg"}
"""Other statements that nobody misses."""


def read_obj(path: Path, data: bytes, warnings: list[str]) -> RawModel:
    """A mesh for each material, for faces, lines and points apart; points of all vertices where there are no elements.

    Faces with texture coordinates, or normals, are kept apart from those without. Colours behind a vertex's position
    count, but under a material. Faces without normals are smooth within their smoothing group (s), if the file has any.
    Raises InputError about words that are no numbers, and numbers of vertices that do not exist.
    """
    return _Reader(path, data, warnings).model()


class _Reader:
    def __init__(self, path: Path, data: bytes, warnings: list[str]) -> None:
        self.path, self.warnings = path, warnings
        self.library = MaterialLibrary(path, warnings)
        text = plain_text(data)
        if b"\\\n" in text:
            text = text.replace(b"\\\n", b"  ")
        if b"\n " in text or text.startswith(b" "):
            text = re.sub(rb"^ +", b"", text, flags=re.MULTILINE)
        self.text = text + b"\n\n\n"
        characters = np.frombuffer(self.text, np.uint8)
        ends = np.flatnonzero(characters == ord("\n"))[:-2]
        self.starts = np.concatenate([[0], ends + 1])
        keys = [characters[self.starts[:-1] + k] for k in range(3)]
        self.kinds = np.full(len(ends), len(_TABLES), np.uint8)
        for kind, keyword in enumerate(_TABLES):
            is_kind = keys[len(keyword)] == ord(" ")
            for key, letter in zip(keys, keyword):
                is_kind &= key == ord(letter)
            self.kinds[is_kind] = kind
        self.others = np.flatnonzero((self.kinds == len(_TABLES)) & (keys[0] != ord("#")) & (keys[0] > ord(" ")))

    def model(self) -> RawModel:
        rows = self._table("v")
        self._check_width(rows, "v", 3)
        self.positions = rows.columns(0, 3)
        self.colors = _vertex_colors(rows, self.warnings)
        rows = self._table("vt")
        self._check_width(rows, "vt", 1)
        self.uvs = np.zeros((len(rows), 2))
        for k in range(2):  # a texture of one dimension has u alone
            has_it = rows.counts > k
            self.uvs[has_it, k] = rows.values[rows.starts[:-1][has_it] + k]
        rows = self._table("vn")
        self._check_width(rows, "vn", 3)
        self.normals = rows.columns(0, 3)
        self._read_statements()
        meshes = self._faces() + self._lines() + self._points()
        if not meshes and len(self.positions) and not np.isin(self.kinds, [3, 4, 5]).any():
            material = colored(PLAIN, self.colors)
            meshes = [RawMesh(self.path.stem, self.positions, "points", colors=self.colors, material=material)]
        return RawModel(meshes, self.library.images)

    def _lines_of(self, keyword: str) -> np.ndarray:
        """The numbers of the lines of a kind, from 0."""
        return np.flatnonzero(self.kinds == _TABLES.index(keyword))

    def _block(self, keyword: str) -> bytes:
        """The lines of a kind as one text, without the keyword and comments."""
        lines = self._lines_of(keyword)
        if not len(lines):
            return b""
        breaks = np.flatnonzero(np.diff(lines) > 1)
        first = self.starts[lines[np.concatenate([[0], breaks + 1])]].tolist()
        last = self.starts[lines[np.concatenate([breaks, [len(lines) - 1]])] + 1].tolist()
        block = b"".join([self.text[a:b] for a, b in zip(first, last)])
        if b"#" in block:
            block = re.sub(rb"#[^\n]*", b"", block)
        blank = np.frombuffer(block, np.uint8).copy()
        at = np.concatenate([[0], np.flatnonzero(blank == ord("\n"))[:-1] + 1])
        for k in range(len(keyword)):
            blank[at + k] = ord("0" if keyword in ("f", "l", "p") else " ")
        return blank.tobytes()

    def _place(self, keyword: str, row: int) -> str:
        return f"line {self._lines_of(keyword)[row] + 1} ({keyword})"

    def _table(self, keyword: str) -> NumberRows:
        rows = number_rows(self.path, self._block(keyword), lambda row: self._place(keyword, row))
        if len(rows) < len(self._lines_of(keyword)):
            raise InputError(self.path, "", f"a line of {keyword} without numbers")
        return rows

    def _check_width(self, rows: NumberRows, keyword: str, width: int) -> None:
        if (rows.counts < width).any():
            row = int((rows.counts < width).argmax())
            problem = f"{rows.counts[row]} numbers where {width} are needed"
            raise InputError(self.path, self._place(keyword, row), problem)

    def _read_statements(self) -> None:
        """Materials and what is passed over."""
        uses: list[tuple[int, str]] = []
        groups: list[tuple[int, int]] = [(-1, 0)]
        unknown: Counter[str] = Counter()
        for line in self.others.tolist():
            words = self.text[self.starts[line]:self.starts[line + 1]].split(None, 1)
            keyword, rest = decoded(words[0]), decoded(words[1].strip()) if len(words) > 1 else ""
            if keyword == "usemtl":
                uses.append((line, " ".join(rest.split())))
            elif keyword == "s":
                groups.append((line, _smoothing_group(rest)))
            elif keyword == "mtllib":
                self.library.add_all(rest)
            elif keyword not in _SILENT:
                unknown[keyword[:20]] += 1
        for keyword, count in list(unknown.items())[:20]:
            self.warnings.append(f"{keyword}: not supported; {count} of these lines left out")
        if len(unknown) > 20:
            self.warnings.append(f"{len(unknown) - 20} more kinds of lines; not supported, left out")
        self.use_lines = np.array([line for line, _ in uses], np.int64)
        self.has_smoothing = len(groups) > 1
        self.group_lines, self.groups = np.array(groups, np.int64).T
        names = dict.fromkeys(["", *(name for _, name in uses)])
        number = {name: k for k, name in enumerate(names)}
        self.names = list(names)
        self.use_names = np.array([0, *(number[name] for _, name in uses)], np.int64)

    def _material(self, number: int) -> tuple[Material, bool]:
        """The material of a name, and whether a file has it."""
        name = self.names[number]
        # A comment may stand behind the name, which may hold # itself.
        material = self.library.materials.get(name) or self.library.materials.get(name.split(" #")[0])
        return (PLAIN, False) if material is None else (material, True)

    def _elements(self, keyword: str) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Of all lines of f, l or p: the corners (C, 3) as numbers of v, vt and vn from 0, -1 for none; how many each
        line has; the number of each line's material."""
        block = self._block(keyword)
        lines = self._lines_of(keyword)
        has_parts = b"/" in block
        if has_parts:
            block = block.replace(b"//", b"/0/")
            block = re.sub(rb"/(?=[ \n])", b"/0", block)
        rows = number_rows(self.path, block.replace(b"/", b" "), lambda row: self._place(keyword, row), np.int64)
        # Every line begins with the 0 that its keyword was turned into.
        is_corner = np.ones(len(rows.values), bool)
        owner = np.repeat(np.arange(len(lines)), rows.counts)
        if has_parts:
            characters = np.frombuffer(b"\n" + block, np.uint8)
            is_number = (characters > ord(" ")) & (characters != ord("/"))
            is_corner = characters[np.flatnonzero(is_number[1:] & ~is_number[:-1])] != ord("/")
        is_corner[rows.starts[:-1]] = False
        at = np.flatnonzero(is_corner)
        owner = owner[at]
        numbers = np.zeros((len(at), 3), np.int64)
        numbers[:, 0] = rows.values[at]
        if has_parts:
            # Up to the next corner, or the 0 of the next line, follow the numbers of vt and vn.
            begins = is_corner.copy()
            begins[rows.starts[:-1]] = True
            ends_here = np.concatenate([begins, [True, True]])
            values = np.concatenate([rows.values, [0, 0]])
            has_second = ~ends_here[at + 1]
            numbers[:, 1] = np.where(has_second, values[at + 1], 0)
            numbers[:, 2] = np.where(has_second & ~ends_here[at + 2], values[at + 2], 0)
        counts = np.bincount(owner, minlength=len(lines))
        numbers[:, 1:] -= not has_parts
        for k, (name, table) in enumerate([("v", self.positions), ("vt", self.uvs), ("vn", self.normals)]):
            if k and not has_parts:
                break
            count = len(table)
            column = numbers[:, k]
            if (column < 0).any():
                # Negative numbers count back from the line they stand on.
                before = np.cumsum(self.kinds == k)[lines][owner]
                absolute = np.where(column < 0, before + column + 1, column)
            else:
                absolute = column
            is_named = (column != 0) | (k == 0)
            wrong = is_named & ((absolute < 1) | (absolute > count))
            if wrong.any() and k == 0:
                which = int(wrong.argmax())
                row = int(owner[which])
                word = self._corner(int(lines[row]), which - int(np.searchsorted(owner, row)))
                problem = f"vertex {word}, and there are {count}, which count from 1"
                raise InputError(self.path, self._place(keyword, row), problem)
            if wrong.any():
                self.warnings.append(f"{np.count_nonzero(wrong)} corners name a {name} that does not exist; "
                                     "it is left out")
            numbers[:, k] = np.where(is_named & ~wrong, absolute, 0) - 1
        materials = self.use_names[np.searchsorted(self.use_lines, lines)]
        return numbers, counts, materials

    def _corner(self, line: int, number: int) -> str:
        """The vertex of a corner as the file writes it: int64 ends where its digits may not."""
        text = self.text[self.starts[line]:self.starts[line + 1]]
        return decoded(re.findall(rb"(?<![\d/+-])[-+]?\d+", text)[number][:40])

    def _faces(self) -> list[RawMesh]:
        if not len(self._lines_of("f")):
            return []
        numbers, sizes, materials = self._elements("f")
        kept, face = cut_polygons(self.positions, numbers[:, 0], sizes, self.warnings)
        corners = (numbers if (sizes == 3).all() else numbers[kept]).reshape(-1, 3, 3)
        smoothing = self.groups[np.searchsorted(self.group_lines, self._lines_of("f")) - 1][face]
        group = materials[face] * 4 + (corners[..., 1] >= 0).all(axis=1) * 2 + (corners[..., 2] >= 0).all(axis=1)
        meshes = []
        keys = np.unique(group)
        for key in keys:
            some = group == key if len(keys) > 1 else slice(None)
            mesh = self._triangles(corners[some].reshape(-1, 3), bool(key & 2), bool(key & 1), int(key) // 4)
            meshes.append(replace(mesh, smoothing=smoothing[some]) if self.has_smoothing else mesh)
        return meshes

    def _triangles(self, corners: np.ndarray, has_uvs: bool, has_normals: bool, number: int) -> RawMesh:
        material, is_known = self._material(number)
        used, indices = _merged(corners, [0] + [1] * has_uvs + [2] * has_normals)
        colors = None if self.colors is None or is_known else self.colors[used[:, 0]]
        if not is_known:
            material = colored(PLAIN, colors)
        elif not has_uvs:
            material = without_textures(material)
        return RawMesh(self._name(number), self.positions[used[:, 0]], "triangles", indices,
                       self.normals[used[:, 2]] if has_normals else None,
                       self.uvs[used[:, 1]] if has_uvs else None, colors, material)

    def _name(self, number: int) -> str:
        return self.names[number] or self.path.stem

    def _lines(self) -> list[RawMesh]:
        if not len(self._lines_of("l")):
            return []
        numbers, sizes, materials = self._elements("l")
        line = np.repeat(np.arange(len(sizes)), sizes)
        first = np.flatnonzero(line[1:] == line[:-1])
        pairs = np.stack([numbers[first, 0], numbers[first + 1, 0]], axis=1)
        return self._plain_meshes("lines", pairs, materials[line[first]])

    def _points(self) -> list[RawMesh]:
        if not len(self._lines_of("p")):
            return []
        numbers, sizes, materials = self._elements("p")
        return self._plain_meshes("points", numbers[:, :1], np.repeat(materials, sizes))

    def _plain_meshes(self, topology: Topology, elements: np.ndarray, materials: np.ndarray) -> list[RawMesh]:
        """Meshes of lines or points, (E, 2 or 1) numbers of vertices, one for each material."""
        meshes = []
        for number in np.unique(materials):
            used, indices = np.unique(elements[materials == number], return_inverse=True)
            material, is_known = self._material(int(number))
            colors = None if self.colors is None or is_known else self.colors[used]
            material = without_textures(material) if is_known else colored(PLAIN, colors)
            meshes.append(RawMesh(self._name(int(number)), self.positions[used], topology, indices.ravel(),
                                  colors=colors, material=material))
        return meshes


def _smoothing_group(words: str) -> int:
    """The number of a group; 0 for "off", and for what is no number."""
    word = (words.split() or ["off"])[0]
    return 1 if word == "on" else int(word) if word.isdecimal() and len(word) < 10 else 0


def _merged(corners: np.ndarray, columns: list[int]) -> tuple[np.ndarray, np.ndarray]:
    """The distinct rows of (C, 3) corners, compared by the given columns, and the number of each corner's row."""
    vertex = corners[:, 0]
    first = np.full(vertex.max() + 1, -1)
    first[vertex[::-1]] = np.arange(len(vertex))[::-1]
    # Most vertices have the same texture coordinates and normal wherever they are used; the others need sorting.
    same = first[vertex]
    differs = np.flatnonzero((corners[:, columns] != corners[same][:, columns]).any(axis=1)) if len(columns) > 1 \
        else np.zeros(0, np.int64)
    _, at, again = np.unique(corners[differs][:, columns], axis=0, return_index=True, return_inverse=True)
    same[differs] = differs[at][again.ravel()] if len(differs) else 0
    is_first = np.zeros(len(vertex), bool)
    is_first[same] = True
    return corners[is_first], (np.cumsum(is_first) - 1)[same]


def _vertex_colors(rows: NumberRows, warnings: list[str]) -> np.ndarray | None:
    """The linear colours behind positions, white where a vertex has none; None where no vertex has one."""
    has_color = (rows.counts == 6) | (rows.counts == 7)
    if not has_color.any():
        return None
    colors = np.ones((len(rows), 4), np.float32)
    columns = rows.values[rows.starts[:-1][has_color, None] + np.arange(3, 6)]
    colors[has_color] = linear_colors(columns, warnings=warnings)
    return colors
