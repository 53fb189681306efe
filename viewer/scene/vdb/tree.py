"""The tree of an OpenVDB grid: a root, two levels of inner nodes of 32 and 16 children along each axis, and leaves.

A leaf has 8 voxels along each axis. The value of an inner node or of the root that has no child is a *tile*, the value
of all voxels there: 8, 128 or 4096 along each axis. The nodes stand in the file depth first, without values, and after
them the values of the leaves in the same order. In the number of a child, and of a voxel in its leaf, z is the fastest
axis.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..densities import MAX_VOXELS
from .blocks import Block, decode, skip_block
from .header import Grid
from .stream import Stream

LEAF, INNER, UPPER = 8, 128, 4096
"""The voxels that a leaf, an inner node of the lower level and one of the upper level have along each axis."""
BATCH = 128
"""Leaves that are decoded at a time: 65,536 voxels, whose coordinates take 3 MB."""
VOXELS = np.stack(np.unravel_index(np.arange(LEAF**3), (LEAF,) * 3), axis=1)
"""(x, y, z) of each voxel in its leaf, (512, 3)."""
_BITS = np.array([byte.bit_count() for byte in range(256)], np.uint8)


@dataclass(frozen=True, eq=False)
class Tiles:
    """Active tiles of one node, of `size` voxels along each axis: first voxels (T, 3) and values (T, channels)."""

    origins: np.ndarray
    size: int
    values: np.ndarray


@dataclass(frozen=True, eq=False)
class Tree:
    """`tiles` are those that are active. `origins` (L, 3) int32 and `masks` (L, 64) uint8 are of all leaves: the first
    voxel of each and which are active, a bit each; `blocks` are where their values stand."""

    background: np.ndarray
    tiles: list[Tiles]
    origins: np.ndarray
    masks: np.ndarray
    blocks: list[Block]

    @property
    def active_voxels(self) -> int:
        return sum(map(_voxels, self.tiles)) + int(_BITS[self.masks].sum(dtype=np.int64))

    def box(self) -> np.ndarray | None:
        """The least and greatest (x, y, z) of an active voxel, (2, 3) int64; None if there is none."""
        lows = [tiles.origins.min(axis=0) for tiles in self.tiles]
        highs = [tiles.origins.max(axis=0) + tiles.size - 1 for tiles in self.tiles]
        for first in range(0, len(self.origins), BATCH):
            masks = self.masks[first:first + BATCH]
            is_used = masks.any(axis=1)
            if not is_used.any():
                continue
            origins = self.origins[first:first + BATCH][is_used].astype(np.int64)
            bits = unpacked(masks[is_used]).reshape(-1, LEAF, LEAF, LEAF)
            sides = np.stack([bits.any(axis=(2, 3)), bits.any(axis=(1, 3)), bits.any(axis=(1, 2))], axis=1)
            lows.append((origins + sides.argmax(axis=2)).min(axis=0))
            highs.append((origins + LEAF - 1 - sides[..., ::-1].argmax(axis=2)).max(axis=0))
        return np.stack([np.min(lows, axis=0), np.max(highs, axis=0)]).astype(np.int64) if lows else None

    def leaf_values(self, stream: Stream, grid: Grid, first: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """The active voxels of BATCH leaves from `first` on: each one's leaf and its number in the leaf, both (N,), and
        its value, (N, channels). Raises InputError."""
        bits = unpacked(self.masks[first:first + BATCH])
        parts = decode(stream, grid, self.blocks[first:first + BATCH])
        values = [part if len(part) != LEAF**3 else part[row] for part, row in zip(parts, bits)]
        leaf, voxel = np.nonzero(bits)
        return leaf + first, voxel, np.concatenate(values)


def unpacked(masks: np.ndarray) -> np.ndarray:
    """The bits of masks (N, bytes), (N, 8 bytes) bool."""
    return np.unpackbits(masks, axis=1, bitorder="little").view(bool)


def read_tree(stream: Stream, grid: Grid) -> Tree:
    """The tree of `grid`, without the values of its leaves. Raises InputError."""
    assert grid.dtype is not None
    stream.at = grid.tree
    if (buffers := stream.number("i")) != 1:
        raise stream.error(f"its tree has {buffers} buffers; trees with one are read")
    background = stream.array(grid.dtype, grid.channels)
    tile_count, child_count = stream.numbers("2I")
    entry = np.dtype([("origin", "<i4", 3), ("value", grid.dtype, grid.channels), ("active", "u1")])
    if stream.array(entry, tile_count)["active"].any():
        raise stream.error(f"has a tile of {UPPER}^3 voxels, which is too large")
    nodes = _Nodes(stream, grid)
    for _ in range(child_count):
        nodes.upper(np.array(stream.numbers("3i"), np.int64))
    if stream.at != grid.values:
        raise stream.error(f"its tree ends at byte {stream.at}, but it says that its values begin at {grid.values}")
    origins = np.concatenate([np.zeros((0, 3), np.int32), *nodes.origins])
    masks = np.concatenate([np.zeros((0, LEAF**3 // 8), np.uint8), *nodes.masks])
    blocks = []
    for mask, active in zip(masks, _BITS[masks].sum(axis=1, dtype=np.int64).tolist()):
        if stream.take(LEAF**3 // 8) != mask.tobytes():
            raise stream.error(f"at byte {stream.at} a leaf has another mask than in the tree")
        blocks.append(skip_block(stream, grid, LEAF**3, active))
    if stream.at != grid.tree_end:
        raise stream.error(f"its values end at byte {stream.at}, but it says at {grid.tree_end}")
    return Tree(background, nodes.tiles, origins, masks, blocks)


class _Nodes:
    """Walks through the inner nodes, and collects the leaves and the active tiles below them."""

    def __init__(self, stream: Stream, grid: Grid) -> None:
        self._stream, self._grid = stream, grid
        self.tiles: list[Tiles] = []
        self._voxels = 0
        self._known: set[bytes] = set()
        self.origins: list[np.ndarray] = []
        self.masks: list[np.ndarray] = []

    def upper(self, origin: np.ndarray) -> None:
        if (origin % UPPER).any() or np.abs(origin).max() > 1 << 30:
            raise self._stream.error(f"a node begins at {origin.tolist()}, not at multiples of {UPPER}")
        if origin.tobytes() in self._known:
            raise self._stream.error(f"two nodes begin at {origin.tolist()}")
        self._known.add(origin.tobytes())
        for child in self._inner(origin, UPPER // INNER, INNER):
            leaves = self._inner(child, INNER // LEAF, LEAF)
            self.origins.append(leaves.astype(np.int32))
            self.masks.append(self._stream.array("u1", len(leaves), LEAF**3 // 8))

    def _inner(self, origin: np.ndarray, side: int, size: int) -> np.ndarray:
        """The first voxels of the children, (children, 3), of a node of `side` children of `size` along each axis."""
        stream, count = self._stream, side**3
        is_child, is_active = unpacked(stream.array("u1", 2, count // 8))
        block = skip_block(stream, self._grid, count, int(is_active.sum()))
        if (is_child & is_active).any():
            raise stream.error(f"at byte {block.start} a node has values where it has children")
        if is_active.any():
            values = decode(stream, self._grid, [block])[0]
            values = values if len(values) != count else values[is_active]
            self.tiles.append(Tiles(_places(is_active, origin, side, size), size, values))
            self._voxels += _voxels(self.tiles[-1])
            if self._voxels > MAX_VOXELS:
                raise stream.error(f"has tiles of more than {MAX_VOXELS:,} voxels, which are too many")
        return _places(is_child, origin, side, size)


def _places(bits: np.ndarray, origin: np.ndarray, side: int, size: int) -> np.ndarray:
    return origin + size * np.stack(np.unravel_index(np.flatnonzero(bits), (side,) * 3), axis=1)


def _voxels(tiles: Tiles) -> int:
    return len(tiles.origins) * tiles.size**3
