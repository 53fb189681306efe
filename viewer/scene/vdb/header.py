"""What stands before the voxels of an OpenVDB file: its version, and of each grid the type, metadata and transform.

The format has no specification. It is what OpenVDB's `io::Archive` writes (Museth 2013, "VDB: High-resolution sparse
volumes with dynamic topology").
"""

from __future__ import annotations

import re
import struct
from dataclasses import dataclass

import numpy as np

from .stream import Stream

MAGIC = b" BDV\0\0\0\0"
OLDEST, NEWEST = 222, 225
"""The versions of the format that are read. Older ones store the values of nodes without masks."""
MAX_GRIDS = 1024
ZIP, ACTIVE_MASK, BLOSC = 1, 2, 4
_TYPES = {
    "float": ("<f4", 1, "FloatGrid"), "double": ("<f8", 1, "DoubleGrid"), "half": ("<f2", 1, "HalfGrid"),
    "int32": ("<i4", 1, "Int32Grid"), "int64": ("<i8", 1, "Int64Grid"), "vec3s": ("<f4", 3, "Vec3SGrid"),
    "vec3d": ("<f8", 3, "Vec3DGrid"), "vec3i": ("<i4", 3, "Vec3IGrid"),
}
"""Of the types of values that are read: how one is stored, how many are in a voxel, and OpenVDB's name of the grid."""


@dataclass(frozen=True, eq=False)
class Grid:
    """What a grid says of itself. Its tree begins at byte `tree`, the values of leaves at `values`, and both end at
    `tree_end`. The grid ends at `end`; an instance has its tree elsewhere."""

    name: str
    type: str
    """OpenVDB's name of the class, such as FloatGrid; what the file says if it is none that is read."""
    dtype: np.dtype | None
    """Of one value, as it is held in memory; None for a type that is not read."""
    channels: int
    is_half: bool
    """Whether the file holds the values as half floats."""
    compression: int
    metadata: dict[str, bytes]
    index_to_world: np.ndarray | None
    """(4, 4) float64, column vectors; None if the transform is not linear, as a frustum's. Such a grid is not read."""
    tree: int
    values: int
    tree_end: int
    end: int

    @property
    def stored(self) -> np.dtype:
        """The type of a value in the file."""
        assert self.dtype is not None
        return np.dtype("<f2") if self.is_half else self.dtype

    def text(self, key: str) -> str:
        return self.metadata.get(key, b"").decode("utf-8", "replace")

    def whole(self, key: str, form: str) -> tuple[int, ...] | None:
        """The whole numbers of an entry of the metadata; None if there are none."""
        value = self.metadata.get(key, b"")
        return struct.unpack("<" + form, value) if len(value) == struct.calcsize("<" + form) else None


def read_grids(stream: Stream) -> list[Grid]:
    """The headers of all grids of a file. Raises InputError."""
    stream.take(len(MAGIC))
    version = stream.number("I")
    if not OLDEST <= version <= NEWEST:
        raise stream.error(f"has version {version} of OpenVDB's format; {OLDEST} to {NEWEST} are read")
    stream.take(8)  # the library's version
    if not stream.number("B"):
        raise stream.error("was written as a stream, without the positions of its grids; that is not read")
    stream.take(36)  # a UUID
    _metadata(stream)
    grids: dict[str, Grid] = {}
    count = stream.number("I")
    if count > MAX_GRIDS:
        raise stream.error(f"has {count} grids; at most {MAX_GRIDS} are read")
    for number in range(count):
        stream.place = f"grid {number}"
        unique, grid = _grid(stream, grids)
        grids[unique] = grid
        stream.at = grid.end
    stream.place = ""
    return list(grids.values())


def _grid(stream: Stream, known: dict[str, Grid]) -> tuple[str, Grid]:
    """The grid that begins here, and the name by which others refer to it."""
    unique, kind, parent = stream.string(), stream.string(), stream.string()
    name = unique.split("\x1e")[0]
    stream.place = f"grid '{name[:80]}'"
    if unique in known:
        raise stream.error("two grids have this name")
    start, values, end = stream.numbers("3q")
    middle = start if parent else values  # which OpenVDB leaves at 0 in an instance
    if not stream.at <= start <= middle <= end <= len(stream.data):
        raise stream.error(f"its positions in the file, {start}, {values} and {end}, are out of order "
                           f"or beyond its {len(stream.data)} bytes")
    stream.at = start
    compression = stream.number("I")
    if compression & ~(ZIP | ACTIVE_MASK | BLOSC) or (compression & ZIP and compression & BLOSC):
        raise stream.error(f"its compression {compression} is unknown")
    metadata = _metadata(stream)
    matrix = _transform(stream)
    match = re.fullmatch("Tree_([a-z0-9]+)_5_4_3(_HalfFloat)?", kind)
    stored, channels, shown = _TYPES.get(match[1] if match else "", ("", 1, kind))
    dtype = np.dtype(stored) if stored else None
    is_half = match is not None and match[2] is not None
    tree, tree_end = stream.at, end
    if parent:  # an instance: it has a transform of its own and shares the tree of another grid
        if parent not in known:
            raise stream.error(f"is an instance of '{parent[:80]}', which does not stand before it")
        source = known[parent]
        tree, values, tree_end = source.tree, source.values, source.tree_end
        compression, shown, is_half = source.compression, source.type, source.is_half
        dtype, channels = source.dtype, source.channels
        metadata = {key: value for key, value in source.metadata.items() if key.startswith("file_")} | metadata
    return unique, Grid(name, shown, dtype, channels, is_half, compression, metadata, matrix, tree, values, tree_end,
                        end)


def _metadata(stream: Stream) -> dict[str, bytes]:
    found = {}
    for _ in range(stream.number("I")):
        name, _ = stream.string(), stream.string()
        found[name] = stream.take(stream.number("I"))
    return found


def _transform(stream: Stream) -> np.ndarray | None:
    kind = stream.string()
    matrix = np.eye(4)
    if kind in ("AffineMap", "UnitaryMap"):
        matrix = stream.array("<f8", 4, 4).T.copy()  # OpenVDB has row vectors
    elif kind in ("ScaleMap", "UniformScaleMap"):  # and four more vectors, which follow from the scale
        matrix[range(3), range(3)] = stream.array("<f8", 5, 3)[0]
    elif kind in ("ScaleTranslateMap", "UniformScaleTranslateMap"):
        matrix[:3, 3], matrix[range(3), range(3)] = stream.array("<f8", 6, 3)[:2]
    elif kind == "TranslationMap":
        matrix[:3, 3] = stream.array("<f8", 3)
    else:
        return None
    if not np.isfinite(matrix).all():
        raise stream.error(f"its transform, a {kind}, has numbers that are not finite")
    return matrix
