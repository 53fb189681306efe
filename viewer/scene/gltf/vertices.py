"""The vertices that a primitive draws, and their order."""

from __future__ import annotations

import numpy as np

from .accessors import Accessors
from .element import Element
from .topology import MODES, RESTART, RESTARTABLE, to_list


class Vertices:
    """The vertices of one primitive. If its indices use less than half of its vertex buffer, the others are dropped.

    Some exporters let hundreds of primitives share one large vertex buffer. `count` is the number of vertices that
    remain. `indices` (M,) uint32 connect them to points, lines or triangles; None means 0, 1, 2, ...
    """

    def __init__(self, accessors: Accessors, primitive: Element, mode: int) -> None:
        self._accessors = accessors
        position = primitive.object("attributes").index("POSITION", len(accessors.items))
        self._stored = self.count = len(accessors.raw(position, "VEC3"))
        self._used: np.ndarray | None = None
        self.indices = self._read_indices(primitive, mode)
        if self.indices is not None and len(self.indices) > 0:
            self._drop_unused(self.indices)

    def raw(self, owner: Element, key: str, *types: str) -> np.ndarray:
        """The values of the accessor at `owner.key` for these vertices, (count, components), as stored."""
        return self._pick(self._accessors.raw(self._accessor(owner, key), *types))

    def floats(self, owner: Element, key: str, *types: str) -> np.ndarray:
        """As `raw`, converted to float32."""
        return self._pick(self._accessors.floats(self._accessor(owner, key), *types))

    def _pick(self, values: np.ndarray) -> np.ndarray:
        return values if self._used is None else values[self._used]

    def _accessor(self, owner: Element, key: str) -> int:
        index = owner.index(key, len(self._accessors.items))
        found = self._accessors.count(index)
        if found != self._stored:
            raise owner.error(f"{found} values for {self._stored} positions", key)
        return index

    def _read_indices(self, primitive: Element, mode: int) -> np.ndarray | None:
        kind, _, size = MODES[mode]
        restart = None
        if "indices" in primitive:
            raw = self._accessors.raw(primitive.index("indices", len(self._accessors.items)), "SCALAR")[:, 0]
            if raw.dtype.kind != "u":
                raise primitive.error("must be of an unsigned integer type", "indices")
            highest = int(raw.max())
            if highest == np.iinfo(raw.dtype).max:
                if mode not in RESTARTABLE or RESTART not in primitive.document.extensions:
                    problem = f"{highest} is the primitive restart value, which {RESTART} allows in strips alone"
                    raise primitive.error(problem, "indices")
                restart = highest
                highest = int(raw.max(where=raw != restart, initial=0))
            if highest >= self._stored:
                raise primitive.error(f"index {highest}, but there are {self._stored} vertices", "indices")
            self._accessors.claim(primitive, len(raw))
            indices = raw.astype(np.uint32)
        else:
            self._accessors.claim(primitive, self._stored)
            indices = np.arange(self._stored, dtype=np.uint32)
        if len(indices) < size:
            return indices[:0]
        if mode in (1, 4) and len(indices) % size:
            primitive.warn(f"{len(indices)} vertices do not form complete {kind}; the last ones are left out")
        elif "indices" not in primitive and mode in (0, 1, 4):
            return None
        return to_list(mode, indices, restart)

    def _drop_unused(self, indices: np.ndarray) -> None:
        # A mask takes one byte per vertex; for few indices into many vertices sorting the indices is cheaper.
        if len(indices) < self._stored // 8:
            used, indices = np.unique(indices, return_inverse=True)
            self.indices = indices.astype(np.uint32)
        else:
            drawn = np.zeros(self._stored, bool)
            drawn[indices] = True
            used = np.flatnonzero(drawn)
            if len(used) >= self._stored // 2:
                return
            number = np.zeros(self._stored, np.uint32)
            number[used] = np.arange(len(used))
            self.indices = number[indices]
        self._used, self.count = used, len(used)
