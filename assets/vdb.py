"""A small writer of OpenVDB files (.vdb), for the project's own volumes and for tests."""

from __future__ import annotations

import struct
import zlib
from collections import defaultdict
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from uuid import UUID

import numpy as np

ZIP, ACTIVE_MASK, BLOSC = 1, 2, 4
_UUID = UUID("6f1c4c1e-7f0b-4c0e-9a35-3c5a1b7d0e42")
"""OpenVDB takes a file whose UUID is 0 for one that it has read."""
Blocks = dict[tuple[int, int, int], np.ndarray]


@dataclass
class VdbGrid:
    """`values` (nx, ny, nz) float32, or (nx, ny, nz, 3) for colours. Those that are not 0 are active."""

    name: str
    values: np.ndarray
    origin: tuple[int, int, int] = (0, 0, 0)
    """The index of the first value."""
    index_to_world: np.ndarray = field(default_factory=lambda: np.eye(4))
    """(4, 4), column vectors."""
    half: bool = False
    flags: int = ZIP | ACTIVE_MASK
    pack: Callable[[bytes], bytes] = zlib.compress
    tiles: bool = False
    """Whether a leaf of one value, all active, is stored as a tile."""
    fog: bytes = b"fog volume"
    more: Sequence[tuple[tuple[int, int, int], np.ndarray]] = ()
    """Further values, elsewhere: pairs of an origin and an array. They share no leaf."""
    empty_leaves: bool = False
    """Whether leaves without active voxels are stored, too."""
    background: float = 0.0
    parent: str = ""
    """The name of the grid whose tree this one shares; then it has only a transform of its own."""
    transform: tuple[str, bytes] | None = None
    """A kind of transform other than an affine map, and its numbers."""
    inactive: bytes = b""
    """What a masked block of a leaf begins with instead of a 0: a kind, values of inactive voxels, a mask."""
    metadata: dict[str, tuple[str, bytes]] = field(default_factory=dict)
    """More entries, or others: by its name the type and the value of each."""


def vdb_bytes(grids: Sequence[VdbGrid], version: int = 224) -> bytes:
    out = bytearray(b" BDV\0\0\0\0" + struct.pack("<3IB", version, 10, 0, 1) + str(_UUID).encode())
    out += struct.pack("<2I", 0, len(grids))
    for grid in grids:
        kind = f"Tree_{'vec3s' if grid.values.ndim == 4 else 'float'}_5_4_3{'_HalfFloat' * grid.half}"
        out += _text(grid.name) + _text(kind) + _text(grid.parent)
        writer = _Tree(grid)
        transform, numbers = grid.transform or ("AffineMap", grid.index_to_world.T.astype("<f8").tobytes())
        head = struct.pack("<I", grid.flags) + writer.metadata() + _text(transform) + numbers
        topology, values = (b"", b"") if grid.parent else (writer.topology(), writer.values())
        head += topology
        start = len(out) + 24
        place = 0 if grid.parent else start + len(head)
        out += struct.pack("<3q", start, place, start + len(head) + len(values)) + head + values
    return bytes(out)


class _Tree:
    def __init__(self, grid: VdbGrid) -> None:
        self.grid = grid
        self.background = np.full(np.shape(grid.values)[3:] or 1, grid.background, "<f4")
        self.leaves: Blocks = {}
        self.tiles: Blocks = {}
        for origin, values in ((grid.origin, grid.values), *grid.more):
            self._add(np.array(origin), values.astype("<f4").reshape(*values.shape[:3], -1))

    def _add(self, low: np.ndarray, values: np.ndarray) -> None:
        before, after = low % 8, -(low + values.shape[:3]) % 8
        values = np.pad(values, [*zip(before, after), (0, 0)])
        for x, y, z in np.ndindex(*(n // 8 for n in values.shape[:3])):
            block = values[8 * x:8 * x + 8, 8 * y:8 * y + 8, 8 * z:8 * z + 8].reshape(512, -1)
            place = tuple((low - before + (8 * x, 8 * y, 8 * z)).tolist())
            if self.grid.tiles and block.all() and (block == block[0]).all():
                self.tiles[place] = block[:1]
            elif block.any() or self.grid.empty_leaves:
                self.leaves[place] = block

    def metadata(self) -> bytes:
        count = sum(int(b.any(axis=1).sum()) for b in self.leaves.values()) + 512 * len(self.tiles)
        entries = {"class": ("string", self.grid.fog), "name": ("string", self.grid.name.encode()),
                   "is_saved_as_half_float": ("bool", bytes([self.grid.half])),
                   "file_voxel_count": ("int64", struct.pack("<q", count)), **self.grid.metadata}
        return struct.pack("<I", len(entries)) + b"".join(
            _text(name) + _text(kind) + struct.pack("<I", len(value)) + value for name, (kind, value) in
            entries.items())

    def topology(self) -> bytes:
        upper: dict[tuple[int, ...], set] = defaultdict(set)
        for place in (*self.leaves, *self.tiles):
            upper[_node(place, 4096)].add(_node(place, 128))
        out = struct.pack("<I", 1) + self.background.tobytes() + struct.pack("<2I", 0, len(upper))
        for place in sorted(upper):
            out += struct.pack("<3i", *place)
            children = sorted(upper[place])
            out += self._node(children, {}, place, 128, 32)
            for child in children:
                leaves = self._below(self.leaves, child)
                out += self._node(leaves, self.tiles, child, 8, 16)
                out += b"".join(_mask(self.leaves[leaf].any(axis=1)) for leaf in leaves)
        return out

    def values(self) -> bytes:
        out = b""
        for upper in sorted({_node(place, 4096) for place in self.leaves}):
            for inner in sorted({_node(place, 128) for place in self.leaves if _node(place, 4096) == upper}):
                for leaf in self._below(self.leaves, inner):
                    active = self.leaves[leaf].any(axis=1)
                    out += _mask(active) + self._block(self.leaves[leaf], active, self.grid.inactive)
        return out

    def _node(self, children: list, tiles: Blocks, place: tuple, size: int, side: int) -> bytes:
        is_child, is_tile = np.zeros(side**3, bool), np.zeros(side**3, bool)
        values = np.tile(self.background, (side**3, 1))
        for child in children:
            is_child[_number(child, place, size, side)] = True
        for tile in self._below(tiles, place) if tiles else ():
            number = _number(tile, place, size, side)
            is_tile[number], values[number] = True, tiles[tile]
        return _mask(is_child) + _mask(is_tile) + self._block(values, is_tile)

    def _block(self, values: np.ndarray, active: np.ndarray, begin: bytes = b"") -> bytes:
        is_masked = bool(self.grid.flags & ACTIVE_MASK)
        stored = values[active] if is_masked else values
        data = stored.astype("<f2" if self.grid.half else "<f4").tobytes()
        if self.grid.flags & (ZIP | BLOSC) and (data or not self.grid.half):
            packed = self.grid.pack(data)
            # Of no values at all, OpenVDB stores what Blosc makes of them.
            is_packed = len(packed) < len(data) or (not data and bool(self.grid.flags & BLOSC))
            data = struct.pack("<q", len(packed) if is_packed else -len(data)) + (packed if is_packed else data)
        return (begin or b"\0" if is_masked else b"\6") + data

    def _below(self, blocks: Blocks, place: tuple) -> list:
        """The blocks in a node of 128 voxels, in the order of the file."""
        return sorted(block for block in blocks if _node(block, 128) == place)


def _node(place: tuple, size: int) -> tuple:
    return tuple(k // size * size for k in place)


def _number(child: tuple, place: tuple, size: int, side: int) -> int:
    x, y, z = ((a - b) // size for a, b in zip(child, place))
    return (x * side + y) * side + z


def _mask(bits: np.ndarray) -> bytes:
    return np.packbits(bits, bitorder="little").tobytes()


def _text(text: str) -> bytes:
    return struct.pack("<I", len(text)) + text.encode()
