"""The reference: path traced in two halves with nothing in common but the scene, so that its own noise is known."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from ...settings import Settings
from ..compare.relmse import Halves
from .bench import Bench
from .errors import relmse_floor
from .store import Record, Store

FIRST_SPP = 64
"""Of the first part of each half; every later one is as large as all before it."""
LEAST_SPP = 8
_UNBIASED = {name: getattr(Settings(), name) for name in ("clamp", "bounces", "sampling")}
"""Whatever the user has the points do."""
_SEED = 0x9E3779B1  # times a number: far from the small ones that users take


@dataclass(frozen=True, eq=False)
class Reference:
    """`linear` (H, W, 4) is the mean of `halves`, (H, W, 3) each; `spp` counts both, `seconds` is what it took."""

    linear: np.ndarray
    halves: Halves
    spp: int
    seconds: float

    def floor(self, mask: np.ndarray) -> float:
        return relmse_floor(self.halves, mask)


class ReferenceMaker:
    """Adds parts to the two halves, each kept as it is made.

    A picture of many samples converges faster than as many pictures of few, whose samples know nothing of one another:
    so the parts double.
    """

    def __init__(self, bench: Bench, store: Store, key: str) -> None:
        self._bench, self._store, self._key = bench, store, key
        self._sums = [np.zeros((*bench.size[::-1], 4)) for _ in range(2)]
        self._spp = [0, 0]
        self._parts = 0
        self.seconds = 0.0
        self._take_kept()

    @property
    def spp(self) -> int:
        """Of both halves."""
        return sum(self._spp)

    def next_spp(self) -> int:
        """Of the next part of each half, were there time for it."""
        return self._spp[1] or FIRST_SPP

    def add(self, spp: int, report: Callable[[float], None] | None = None) -> None:
        """A part of so many samples a pixel for each half; what is there from an interrupted run is not made again."""
        for half in range(2):
            kept = self._store.load(self._name(half), self._key)
            if kept is not None:
                spp = kept.facts["spp"]
            else:
                kept = self._make(half, spp, report)
                self._store.save(self._name(half), self._key, kept)
            self._take(half, kept)
        self._parts += 1

    def _make(self, half: int, spp: int, report: Callable[[float], None] | None) -> Record:
        started = time.perf_counter()
        seed = _SEED * (2 * self._parts + half + 1) & 0xFFFFFFFF
        settings = replace(self._bench.settings, mode="path", spp=spp, seed=seed, **_UNBIASED)
        linear = self._bench.trace(settings, report and (lambda done: report((done + half) / 2)))
        return Record(linear, {"spp": spp}, time.perf_counter() - started)

    def _take_kept(self) -> None:
        while all(self._store.load(self._name(half), self._key) is not None for half in range(2)):
            self.add(0)

    def _take(self, half: int, record: Record) -> None:
        self._sums[half] += record.facts["spp"] * record.picture.astype(np.float64)
        self._spp[half] += record.facts["spp"]
        self.seconds += record.seconds

    def _name(self, half: int) -> str:
        return f"reference-{self._parts}{'ab'[half]}"

    def reference(self) -> Reference:
        """As it is by now; there is a part in it."""
        first, second = (total / spp for total, spp in zip(self._sums, self._spp))
        return Reference(((first + second) / 2).astype(np.float32), Halves(first[..., :3], second[..., :3]), self.spp,
                         self.seconds)
