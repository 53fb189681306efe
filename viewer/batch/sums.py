"""Sums of the samples of one picture, which come in any order and are added in that of their numbers."""

from __future__ import annotations

from itertools import pairwise

import numpy as np

MOST_PARTS = 32
LEAST_SAMPLES = 16
"""Of a part: with fewer, beginning it would take longer than tracing it."""


def parts_of(samples: int) -> list[range]:
    """The samples in parts that depend on their number alone, and not on who traces them."""
    count = min(max(samples // LEAST_SAMPLES, 1), MOST_PARTS)
    bounds = [samples * k // count for k in range(count + 1)]
    return [range(low, high) for low, high in pairwise(bounds)]


class Sums:
    """`total` is the sum in float64 of what was added, in the order of the numbers from 0 on. So it is the same to the
    last bit whatever the order in which parts come."""

    def __init__(self) -> None:
        self.total: np.ndarray | None = None
        self._next = 0
        self._early: dict[int, np.ndarray] = {}

    def add(self, number: int, sums: np.ndarray) -> None:
        self._early[number] = sums
        while self._next in self._early:
            part = self._early.pop(self._next).astype(np.float64)
            self.total = part if self.total is None else self.total + part
            self._next += 1
