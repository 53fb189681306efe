"""glTF's accessors: typed arrays in buffers."""

from __future__ import annotations

from collections import ChainMap
from collections.abc import Mapping, MutableMapping
from copy import copy

import numpy as np

from .buffers import Buffers
from .element import Element

_COMPONENTS: dict[int, np.dtype] = {
    5120: np.dtype("i1"), 5121: np.dtype("u1"), 5122: np.dtype("<i2"), 5123: np.dtype("<u2"), 5125: np.dtype("<u4"),
    5126: np.dtype("<f4")}
COMPONENT_COUNTS = {"SCALAR": 1, "VEC2": 2, "VEC3": 3, "VEC4": 4, "MAT2": 4, "MAT3": 9, "MAT4": 16}


class Accessors:
    """The file's accessors, each read once. Arrays may be views of the file's bytes and must not be written to."""

    def __init__(self, root: Element, buffers: Buffers) -> None:
        self.items = root.array("accessors")
        self.buffers = buffers
        self._raw: MutableMapping[int, np.ndarray] = {}
        self._floats: dict[int, np.ndarray] = {}
        self._decoded: Mapping[int, np.ndarray] = {}

    def decoded(self, arrays: dict[int, np.ndarray]) -> Accessors:
        """These accessors, of which some have the elements that a compressed primitive holds for them."""
        other = copy(self)
        other._decoded, other._raw, other._floats = arrays, ChainMap(dict(arrays), self._raw), {}
        return other

    def count(self, index: int) -> int:
        """The number of elements that an accessor has, or that the file declares for it; nothing is read."""
        if index in self._decoded:
            return len(self._decoded[index])
        return self.items[index].integer("count", low=1)

    def claim(self, place: Element, count: int, what: str = "") -> None:
        """As Buffers.claim."""
        self.buffers.claim(place, count, what)

    def raw(self, index: int, *types: str) -> np.ndarray:
        """The elements, (count, components), in the stored component type.

        Raises InputError unless the accessor's type (such as "VEC3") is one of `types`.
        """
        accessor = self.items[index]
        kind = accessor.string("type")
        if kind not in types:
            raise accessor.error(f"must be {' or '.join(types)} here, not {kind[:20]!r}", "type")
        if index not in self._raw:
            self._raw[index] = self._read(accessor, COMPONENT_COUNTS[kind])
        return self._raw[index]

    def floats(self, index: int, *types: str) -> np.ndarray:
        """The elements, (count, components) float32. Normalised integers become 0..1 or -1..1 (glTF 2.0, 3.6.2.2)."""
        raw = self.raw(index, *types)
        if index not in self._floats:
            if raw.dtype != np.float32:
                self.claim(self.items[index], len(raw))
            self._floats[index] = _to_float(raw, self.items[index].boolean("normalized", False))
        return self._floats[index]

    def _read(self, accessor: Element, components: int) -> np.ndarray:
        dtype = component_type(accessor)
        count = accessor.integer("count", low=1)
        sparse = accessor.object("sparse") if "sparse" in accessor else None
        if "bufferView" in accessor:
            array = self._strided(accessor, dtype, count, components)
        else:
            self.claim(accessor, count)
            array = np.zeros((count, components), dtype)
        if sparse is None:
            return array
        self.claim(accessor, count)
        return self._substitute(array, sparse, dtype)

    def _strided(self, place: Element, dtype: np.dtype, count: int, components: int) -> np.ndarray:
        """The elements in the buffer view that `place` refers to, as a view without a copy."""
        index = place.index("bufferView", len(self.buffers.views))
        data = self.buffers.view(index)
        size = dtype.itemsize * components
        offset = place.integer("byteOffset", 0)
        stride = self.buffers.views[index].integer("byteStride", size)
        if stride < size:
            raise self.buffers.views[index].error(f"{stride} bytes cannot hold elements of {size}", "byteStride")
        end = offset + stride * (count - 1) + size
        if end > len(data):
            raise place.error(f"{count} elements end at byte {end}, but bufferViews[{index}] has {len(data)}", "count")
        return np.ndarray((count, components), dtype, data, offset, (stride, dtype.itemsize))

    def _substitute(self, base: np.ndarray, sparse: Element, dtype: np.dtype) -> np.ndarray:
        """A copy of the base array with the sparse values inserted."""
        count = sparse.integer("count", low=1)
        if count > len(base):
            raise sparse.error(f"{count} values for an accessor of {len(base)}", "count")
        place = sparse.object("indices")
        index_type = component_type(place)
        if index_type.kind != "u":
            raise place.error("must be an unsigned integer type", "componentType")
        indices = self._strided(place, index_type, count, 1)[:, 0].astype(np.int64)
        values = self._strided(sparse.object("values"), dtype, count, base.shape[1])
        if indices.max() >= len(base):
            raise place.error(f"index {indices.max()}, but the accessor has {len(base)} elements")
        if (np.diff(indices) <= 0).any():
            raise place.error("the indices must increase strictly")
        array = base.copy()
        array[indices] = values
        return array


def component_type(element: Element) -> np.dtype:
    number = element.integer("componentType")
    if number not in _COMPONENTS:
        raise element.error(f"{number} is not a component type", "componentType")
    return _COMPONENTS[number]


def _to_float(raw: np.ndarray, normalized: bool) -> np.ndarray:
    if not normalized or raw.dtype.kind == "f":
        return raw.astype(np.float32, copy=False)
    scale = np.float32(np.iinfo(raw.dtype).max)
    return np.maximum(raw.astype(np.float32) / scale, np.float32(-1))
