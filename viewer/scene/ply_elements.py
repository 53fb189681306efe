"""The elements of PLY files: numbers of properties, as the header declares them (Turk 1994)."""

from __future__ import annotations

import re
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from ..errors import InputError
from .text import decoded, number_rows, plain_text

_TYPES = {"char": "i1", "int8": "i1", "uchar": "u1", "uint8": "u1", "short": "i2", "int16": "i2", "ushort": "u2",
          "uint16": "u2", "int": "i4", "int32": "i4", "uint": "u4", "uint32": "u4", "float": "f4", "float32": "f4",
          "double": "f8", "float64": "f8", "int64": "i8", "uint64": "u8"}
_ORDERS = {"ascii": "", "binary_little_endian": "<", "binary_big_endian": ">"}
_END = re.compile(rb"^end_header[ \t]*\n", re.MULTILINE)
_MAX_HEADER = 1 << 20


@dataclass(frozen=True)
class Property:
    name: str
    type: str
    count_type: str = ""
    """Of a list; empty for a single number."""


@dataclass
class Element:
    name: str
    count: int
    properties: list[Property] = field(default_factory=list)
    scalars: dict[str, np.ndarray] = field(default_factory=dict)
    """(count,) numbers of each property that is no list."""
    lists: dict[str, tuple[np.ndarray, np.ndarray]] = field(default_factory=dict)
    """Of each list property all numbers, row after row, and how many each row has, (count,)."""

    def columns(self, names: tuple[str, ...]) -> np.ndarray | None:
        """(count, len(names)) numbers, or None where a property is missing."""
        if not all(name in self.scalars for name in names):
            return None
        return np.stack([self.scalars[name] for name in names], axis=1)

    def kind(self, name: str) -> str:
        """The type of a property, as numpy names it, such as u1."""
        return next(_TYPES[p.type] for p in self.properties if p.name == name)


def read_elements(path: Path, data: bytes) -> tuple[dict[str, Element], list[str]]:
    """The elements by their names, and the texture files that the header names. Bytes behind the last element do not
    matter.

    Raises InputError about a header that breaks the format, and about elements that the file is too short for.
    """
    elements, order, textures, start = _read_header(path, data)
    size = len(data) - start
    for element in elements.values():
        if element.properties and element.count > size:
            problem = f"{element.count} are declared in a file of {len(data)} bytes"
            raise InputError(path, f"element {element.name[:20]}", problem)
    _read_ascii(path, data[start:], elements) if not order else _read_binary(path, data, start, elements, order)
    return elements, textures


def _read_header(path: Path, data: bytes) -> tuple[dict[str, Element], str, list[str], int]:
    """The elements, the byte order ("" for ASCII), the texture files, and where the data begin."""
    # All lines end as the first does. One that ends in CR alone is none to re.MULTILINE.
    stop = _END.search(data[:_MAX_HEADER].replace(b"\r", b"\n"))
    if not data.startswith(b"ply") or stop is None:
        raise InputError(path, "header", "there is no end_header" if data.startswith(b"ply") else "it is no PLY")
    end = stop.end() + (data[3:5] == b"\r\n")
    lines = decoded(plain_text(data[:end])).split("\n")
    elements: dict[str, Element] = {}
    order, textures = None, []
    last: Element | None = None
    for number, line in enumerate(lines, 1):
        words = line.split()
        problem = ""
        match words:
            case ["ply"] if number == 1:
                pass
            case [] | ["obj_info", *_] | ["end_header", *_]:
                pass
            case ["comment", keyword, *_] if keyword.lower() == "texturefile":
                textures.append(line.split(None, 2)[-1].strip())
            case ["comment", *_]:
                pass
            case ["format", name, _] if name in _ORDERS:
                order = _ORDERS[name]
            case ["format", *_]:
                problem = f"format {' '.join(words[1:])[:40]!r} is not known"
            case ["element", name, count] if count.isascii() and count.isdigit() and len(count) < 19:
                last = elements[name] = Element(name, int(count))
            case ["property", "list", count_type, kind, name] if (
                    last is not None and kind in _TYPES and _TYPES.get(count_type, "f")[0] in "iu"):
                last.properties.append(Property(name, kind, count_type))
            case ["property", kind, name] if last is not None and kind in _TYPES:
                last.properties.append(Property(name, kind))
            case _:
                problem = f"{line.strip()[:60]!r} makes no sense"
        if problem:
            raise InputError(path, f"line {number} of the header", problem)
    if order is None:
        raise InputError(path, "header", "there is no format")
    for element in elements.values():
        names = [p.name for p in element.properties]
        if len(set(names)) < len(names):
            raise InputError(path, f"element {element.name[:20]}", "two properties have the same name")
    return elements, order, textures, end


def _read_ascii(path: Path, text: bytes, elements: dict[str, Element]) -> None:
    rows = number_rows(path, plain_text(text), lambda row: f"line {row + 1} behind the header")
    done = 0
    for element in elements.values():
        if not element.properties:
            continue
        if done + element.count > len(rows):
            _raise_too_short(path, element, len(rows) - done)
        starts = rows.starts[done:done + element.count]
        ends = rows.starts[done + 1:done + element.count + 1]
        done += element.count
        at = starts.copy()
        for item in element.properties:
            _check_rows(path, element, at < ends)
            if not item.count_type:
                element.scalars[item.name] = rows.values[at]
                at += 1
                continue
            counts = rows.values[at]
            _check_rows(path, element, (counts >= 0) & (counts <= ends - at - 1) & (counts == np.floor(counts)))
            counts = counts.astype(np.int64)
            offset = np.repeat(at + 1 - (np.cumsum(counts) - counts), counts)
            element.lists[item.name] = rows.values[offset + np.arange(len(offset))], counts
            at += 1 + counts


def _check_rows(path: Path, element: Element, good: np.ndarray) -> None:
    if not good.all():
        raise InputError(path, f"{element.name[:20]} {int(good.argmin())}", "its line does not fit its properties")


def _raise_too_short(path: Path, element: Element, there: int) -> None:
    raise InputError(path, f"element {element.name[:20]}", f"{element.count} are declared, and the file ends in number "
                     f"{there}")


def _read_binary(path: Path, data: bytes, at: int, elements: dict[str, Element], order: str) -> None:
    for element in elements.values():
        if not element.properties or not element.count:
            for item in element.properties:
                empty = np.zeros(0)
                element.lists[item.name] = empty, np.zeros(0, np.int64)
                element.scalars[item.name] = empty
            continue
        at = _read_rows(path, data, at, element, order)


def _read_rows(path: Path, data: bytes, at: int, element: Element, order: str) -> int:
    """Read an element's rows from byte `at` on; where they end."""
    sizes = _list_sizes(data, at, element, order)
    layout = _layout(element, order, sizes)
    if at + layout.itemsize * element.count <= len(data):
        rows = np.frombuffer(data, layout, element.count, at)
        if all((rows[f"{p.name} count"] == size).all() for p, size in zip(_lists(element), sizes)):
            for item in element.properties:
                if item.count_type:
                    counts = rows[f"{item.name} count"].astype(np.int64)
                    element.lists[item.name] = rows[item.name].reshape(-1), counts
                else:
                    element.scalars[item.name] = rows[item.name]
            return at + layout.itemsize * element.count
    if not _lists(element):
        _raise_too_short(path, element, (len(data) - at) // max(1, layout.itemsize))
    return _walk_rows(path, data, at, element, order)


def _lists(element: Element) -> list[Property]:
    return [item for item in element.properties if item.count_type]


def _layout(element: Element, order: str, sizes: list[int]) -> np.dtype:
    """The type of a row whose lists have these sizes."""
    fields: list[tuple] = []
    left = iter(sizes)
    for item in element.properties:
        kind = order + _TYPES[item.type]
        if item.count_type:
            fields += [(f"{item.name} count", order + _TYPES[item.count_type]), (item.name, kind, (next(left),))]
        else:
            fields.append((item.name, kind))
    return np.dtype(fields)


def _list_sizes(data: bytes, at: int, element: Element, order: str) -> list[int]:
    """The sizes of the lists of the row at byte `at`; 0 from where the file ends on."""
    sizes = []
    for item in element.properties:
        size = 1
        if item.count_type:
            kind = np.dtype(order + _TYPES[item.count_type])
            size = int(np.frombuffer(data, kind, 1, at)[0]) if at + kind.itemsize <= len(data) else 0
            at += kind.itemsize
            item_size = np.dtype(_TYPES[item.type]).itemsize
            size = size if 0 <= size * item_size <= len(data) - at else 0
            sizes.append(size)
        at += size * np.dtype(_TYPES[item.type]).itemsize
    return sizes


def _walk_rows(path: Path, data: bytes, at: int, element: Element, order: str) -> int:
    """As `_read_rows` for lists of any sizes: row after row, for each list begins where the one before ended."""
    endian = "little" if order == "<" else "big"
    plan = [(np.dtype(_TYPES[p.type]).itemsize, np.dtype(_TYPES[p.count_type]).itemsize if p.count_type else 0,
             p.count_type and _TYPES[p.count_type][0] == "i") for p in element.properties]
    begins: list[list[int]] = [[] for _ in plan]
    counts: list[list[int]] = [[] for _ in plan]
    end = len(data)
    for row in range(element.count):
        for k, (size, count_size, signed) in enumerate(plan):
            count = 1
            if count_size:
                count = int.from_bytes(data[at:at + count_size], endian, signed=bool(signed))  # type: ignore[arg-type]
                at += count_size
            if count < 0:
                raise InputError(path, f"{element.name[:20]} {row}", f"a list of {count} numbers")
            begins[k].append(at)
            counts[k].append(count)
            at += size * count
            if at > end:
                _raise_too_short(path, element, row)
    characters = np.frombuffer(data, np.uint8)
    for item, begin, count_list, (size, count_size, _) in zip(element.properties, begins, counts, plan):
        number = np.array(count_list, np.int64)
        offset = np.repeat(np.array(begin, np.int64) - (np.cumsum(number) - number) * size, number)
        where = offset + np.arange(len(offset)) * size
        values = characters[where[:, None] + np.arange(size)].reshape(-1).view(order + _TYPES[item.type])
        if count_size:
            element.lists[item.name] = values, number
        else:
            element.scalars[item.name] = values
    return at
