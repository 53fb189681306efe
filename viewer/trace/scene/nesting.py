"""The media that a path is inside of, as digits of one whole number: shaders/media/nesting.glsl for arrays."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np
from numpy.typing import NDArray

_LARGEST = 1 << 24
"""Whole numbers up to here are exact in float32."""


class Nesting:
    """Nestings of `count` media, `most` of them at once. `has_order`: the one with the highest number is the one that a
    path is in."""

    def __init__(self, count: int, has_order: bool = False) -> None:
        self.base, self._has_order = max(count, 2), has_order
        self.limit, self.most = 1, 1
        while self.limit * self.base * self.base <= _LARGEST:
            self.limit, self.most = self.limit * self.base, self.most + 1

    @property
    def uniforms(self) -> dict[str, object]:
        """The uniforms of shaders/media/nesting.glsl."""
        return {"u_media_count": self.base, "u_nesting_limit": self.limit}

    def of(self, media: Iterable[int]) -> int:
        """The nesting of these media, the outermost first."""
        nesting = 0
        for medium in media:
            nesting = nesting % self.limit * self.base + medium
        return nesting

    def innermost(self, nesting: NDArray[np.int64]) -> NDArray[np.int64]:
        if not self._has_order:
            return nesting % self.base
        highest, rest = np.zeros_like(nesting), nesting
        while rest.any():
            highest, rest = np.maximum(highest, rest % self.base), rest // self.base
        return highest

    def cross(self, nesting: NDArray[np.int64], media: NDArray[np.int64], is_front: NDArray) -> NDArray[np.int64]:
        """The nestings behind boundaries of solids with these media, entered where `is_front`, else left; (N,)."""
        after = nesting.copy()
        after[is_front] = nesting[is_front] % self.limit * self.base + media[is_front]
        pending, place = ~is_front, 1
        while place <= self.limit and pending.any():
            outer = nesting // place
            found = pending & (outer % self.base == media)
            after[found] = outer[found] // self.base * place + nesting[found] % place
            pending &= ~found
            place *= self.base
        return after
