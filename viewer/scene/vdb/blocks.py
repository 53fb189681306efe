"""The values of the nodes of an OpenVDB tree, which are stored in blocks, each compressed on its own."""

from __future__ import annotations

import struct
import zlib
from collections.abc import Sequence
from dataclasses import dataclass
from importlib.util import find_spec

import numpy as np

from ...base.apart import ApartError, apart
from .header import ACTIVE_MASK, BLOSC, ZIP, Grid
from .stream import Stream

_INACTIVE = {2: 1, 4: 1, 5: 2}
"""By the first byte of a block: how many values follow that inactive voxels have. They are never stored as half floats,
though rounded to them."""
_SELECTED = (3, 4, 5)
"""The first bytes after which a mask follows that says which of the two values an inactive voxel has."""
_ALL = 6
"""The first byte of a block that has the values of inactive voxels as the others."""
_SECONDS, _SECONDS_PER_BYTE = 5.0, 1e-6
_MEMORY = 1 << 27


@dataclass(frozen=True)
class Block:
    """Where the values of a node stand: `size` bytes from `start`, compressed or not, for `count` voxels."""

    start: int
    size: int
    is_compressed: bool
    count: int


def skip_block(stream: Stream, grid: Grid, count: int, active: int) -> Block:
    """Find the block of a node of `count` values, of which `active` are, and go on behind it. Raises InputError."""
    kind = stream.number("B")
    if kind > _ALL:
        raise stream.error(f"at byte {stream.at - 1} a block of values begins with {kind}, not with 0 to {_ALL}")
    assert grid.dtype is not None
    item, whole = grid.stored.itemsize * grid.channels, grid.dtype.itemsize * grid.channels
    stream.skip(_INACTIVE.get(kind, 0) * whole + (count // 8 if kind in _SELECTED else 0))
    if grid.compression & ACTIVE_MASK and kind != _ALL:
        count = active
    size = count * item
    if not grid.compression & (ZIP | BLOSC) or (grid.is_half and not count):
        return Block(stream.skip(size), size, False, count)
    length = stream.number("q")
    if length > 0:  # a node without active voxels has a chunk of no values, which decoders refuse
        return Block(stream.skip(length), length, count > 0, count)
    if -length != size:  # what compression would make longer is stored as it is
        raise stream.error(f"at byte {stream.at} there are {-length} bytes of values, not {size}")
    return Block(stream.skip(size), size, False, count)


def decode(stream: Stream, grid: Grid, blocks: Sequence[Block]) -> list[np.ndarray]:
    """The values of each block, (count, channels). Raises InputError."""
    item = grid.stored.itemsize * grid.channels
    decoded = iter(_decompressed(stream, grid, [block for block in blocks if block.is_compressed], item))
    arrays = []
    for block in blocks:
        data, start = (next(decoded), 0) if block.is_compressed else (stream.data, block.start)
        values = np.frombuffer(data, grid.stored, block.count * grid.channels, start)
        arrays.append(values.reshape(block.count, grid.channels))
    return arrays


def _decompressed(stream: Stream, grid: Grid, blocks: list[Block], item: int) -> list[bytes]:
    if not blocks:
        return []
    if grid.compression & BLOSC:
        return _blosc(stream, blocks, item)
    return [_unzipped(stream, block, block.count * item) for block in blocks]


def _unzipped(stream: Stream, block: Block, size: int) -> bytes:
    try:
        data = zlib.decompressobj().decompress(stream.data[block.start:block.start + block.size], size)
    except zlib.error as error:
        raise stream.error(f"the zip-compressed values at byte {block.start} are broken") from error
    if len(data) != size:
        raise stream.error(f"the zip-compressed values at byte {block.start} are not {size} bytes")
    return data


def _blosc(stream: Stream, blocks: list[Block], item: int) -> list[bytes]:
    sizes = [block.count * item for block in blocks]
    for block, size in zip(blocks, sizes):
        head = stream.data[block.start:block.start + 16]
        # A chunk of Blosc 1 begins with its own sizes, without and with compression. The decoder trusts the second.
        if len(head) < 16 or block.size < 16 or struct.unpack_from("<I4xI", head, 4) != (size, block.size):
            raise stream.error(f"the Blosc-compressed values at byte {block.start} are not {size} bytes")
    if find_spec("numcodecs") is None:
        raise stream.error("is compressed by Blosc, which needs a package that is not installed: "
                           "pip install 'pbr-viewer[vdb]'")
    chunks = b"".join(stream.data[block.start:block.start + block.size] for block in blocks)
    try:
        found = apart.call("viewer.scene.decoders:blosc", chunks, _SECONDS + _SECONDS_PER_BYTE * sum(sizes),
                           _MEMORY + 4 * sum(sizes), lengths=[block.size for block in blocks])
    except ApartError as error:
        raise stream.error(f"the Blosc-compressed values {error}") from error
    data = found["bytes"].tobytes()
    if len(data) != sum(sizes):
        raise stream.error("the Blosc-compressed values are not as long as they say")
    ends = np.cumsum(sizes)
    return [data[end - size:end] for end, size in zip(ends.tolist(), sizes)]
