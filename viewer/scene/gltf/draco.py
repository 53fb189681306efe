"""Primitives that Draco has compressed (KHR_draco_mesh_compression)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ...base.apart import ApartError, apart
from .accessors import COMPONENT_COUNTS, Accessors, component_type
from .element import Element

EXTENSION = "KHR_draco_mesh_compression"
TRIANGLES, TRIANGLE_STRIP = 4, 5
_VERSION = (2, 2)
_MESH, _EDGEBREAKER = 1, 1
_HAS_METADATA = 1 << 15
_MAX_DEPTH = 16
_SECONDS, _SECONDS_PER_ELEMENT = 5.0, 2e-6
"""How long decoding may take: more than ten times as long as it does. Broken data may announce millions of elements,
and hang."""
_BYTES, _BYTES_PER_ELEMENT = 1 << 28, 256


def decoded(accessors: Accessors, primitive: Element, mode: int) -> tuple[Accessors, int]:
    """The accessors and the mode by which to read a primitive, decoded if it is compressed. Raises InputError."""
    place = primitive.extension(EXTENSION)
    if place is None:
        return accessors, mode
    if mode not in (TRIANGLES, TRIANGLE_STRIP):
        raise primitive.error(f"{mode}, but {EXTENSION} is for triangles and triangle strips", "mode")
    data = accessors.buffers.compressed(place.index("bufferView", len(accessors.buffers.views)))
    size = _size(place, bytes(data))
    accessors.claim(place, 3 * size.faces + size.points)
    elements = size.faces + size.points
    try:
        arrays = apart.call("viewer.scene.decoders:draco", data, _SECONDS + _SECONDS_PER_ELEMENT * elements,
                            _BYTES + _BYTES_PER_ELEMENT * elements)
    except ApartError as error:
        raise place.error(f"the compressed data {error}") from error
    found = {primitive.index("indices", len(accessors.items)): arrays["faces"].reshape(-1, 1)}
    attributes, ids = primitive.object("attributes"), place.object("attributes")
    for key in ids.value:
        if key in attributes:
            index, number = attributes.index(key, len(accessors.items)), str(ids.integer(key))
            if number not in arrays:
                raise ids.error(f"the compressed data has no attribute {number}", key)
            found[index] = _converted(accessors.items[index], arrays[number])
    for index, array in found.items():
        declared = accessors.count(index)
        if declared != len(array):
            primitive.warn(f"the compressed data has {len(array)} elements for accessors[{index}] of {declared}")
    return accessors.decoded(found), TRIANGLES  # the connectivity is a list of triangles in either mode


def _converted(accessor: Element, array: np.ndarray) -> np.ndarray:
    """The decoded values, (N, C); integers in the accessor's component type, since the decoder widens them."""
    kind = accessor.string("type")
    if COMPONENT_COUNTS.get(kind) != array.shape[1]:
        raise accessor.error(f"{kind[:20]!r}, but the compressed data has {array.shape[1]} components", "type")
    return array.astype(np.float32 if array.dtype.kind == "f" else component_type(accessor), copy=False)


@dataclass(frozen=True)
class _Size:
    faces: int
    points: int


def _size(place: Element, data: bytes) -> _Size:
    """What the header announces, so that too much is refused before it is decoded."""
    try:
        return _Header(data).size()
    except IndexError as error:
        raise place.error("the compressed data ends inside its header") from error
    except ValueError as error:
        raise place.error(f"the compressed data {error}") from error


class _Header:
    """Reads the beginning of a Draco bitstream; raises IndexError at its end, ValueError for what is no such mesh.

    Source: google.github.io/draco/spec, sections 3 (header), 3.2 (metadata), 4 and 5 (connectivity).
    """

    def __init__(self, data: bytes) -> None:
        self._data, self._place = data, 0

    def size(self) -> _Size:
        if self._bytes(5) != b"DRACO":
            raise ValueError("does not begin with 'DRACO'")
        version = self._byte(), self._byte()
        if version != _VERSION:
            raise ValueError(f"is of version {version[0]}.{version[1]}; only 2.2 is supported")
        if self._byte() != _MESH:
            raise ValueError("is not a mesh")
        method = self._byte()
        if (self._byte() | self._byte() << 8) & _HAS_METADATA:
            for _ in range(self._varint()):
                self._varint()  # the attribute's number
                self._skip_metadata(0)
            self._skip_metadata(0)
        if method == _EDGEBREAKER:
            self._byte()  # how the mesh is traversed
            points = self._varint()
            return _Size(self._varint(), points)
        return _Size(self._varint(), self._varint())

    def _skip_metadata(self, depth: int) -> None:
        if depth > _MAX_DEPTH:
            raise ValueError("has metadata nested too deeply")
        for _ in range(self._varint()):
            self._bytes(self._byte())
            self._bytes(self._varint())
        for _ in range(self._varint()):
            self._bytes(self._byte())
            self._skip_metadata(depth + 1)

    def _byte(self) -> int:
        self._place += 1
        return self._data[self._place - 1]

    def _bytes(self, count: int) -> bytes:
        self._place += count
        if self._place > len(self._data):
            raise IndexError
        return self._data[self._place - count:self._place]

    def _varint(self) -> int:
        """Seven bits a byte, the lowest first; the highest bit of a byte says that there is another."""
        value = shift = 0
        while True:
            byte = self._byte()
            value |= (byte & 127) << shift
            shift += 7
            if byte < 128:
                return value
            if shift > 35:
                raise ValueError("has a number of more than 32 bits")
