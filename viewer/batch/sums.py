"""Sums of the samples of one picture, which come in any order and are added in that of their numbers."""

from __future__ import annotations

from itertools import pairwise
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from ..trace.paths.part import Part

MOST_PARTS = 32
LEAST_SAMPLES = 16
"""Of a part: with fewer, beginning it would take longer than tracing it."""


def parts_of(samples: int) -> list[range]:
    """The samples in parts that depend on their number alone, and not on who traces them."""
    count = min(max(samples // LEAST_SAMPLES, 1), MOST_PARTS)
    bounds = [samples * k // count for k in range(count + 1)]
    return [range(low, high) for low, high in pairwise(bounds)]


class Sums:
    """The sums in float64 of the parts with even numbers and of those with odd ones, which denoisers compare, each in
    the order of the numbers. So they are the same to the last bit whatever the order in which parts come."""

    def __init__(self) -> None:
        self._halves: dict[int, Part] = {}
        self._next = 0
        self._early: dict[int, Part] = {}

    def add(self, number: int, part: Part) -> None:
        self._early[number] = part
        while self._next in self._early:
            self._take(self._next)
            self._next += 1

    @property
    def halves(self) -> list[Part]:
        """Of all parts that have come; one of them or none, if there are so few."""
        for number in sorted(self._early):  # those before it will not come any more
            self._take(number)
        return [half for _, half in sorted(self._halves.items())]

    def _take(self, number: int) -> None:
        half, part = number % 2, self._early.pop(number)
        self._halves[half] = self._halves[half] + part if half in self._halves else part
