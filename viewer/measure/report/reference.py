"""The reference: path traced in two independent halves, whose difference shows its noise."""

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
"""Samples per pixel of the first part of each half; every later part has as many as all before it."""
LEAST_SPP = 8
_UNBIASED = {name: getattr(Settings(), name) for name in ("clamp", "bounces", "sampling")}
"""Settings of the reference, whatever the user chose for the points."""
_SEED = 0x9E3779B1  # its multiples are far from the small seeds that users choose


@dataclass(frozen=True, eq=False)
class Reference:
    """`linear` (H, W, 4) is the mean of `halves`, (H, W, 3) each; `spp` and `seconds` are those of both together."""

    linear: np.ndarray
    halves: Halves
    spp: int
    seconds: float

    def floor(self, mask: np.ndarray) -> float:
        return relmse_floor(self.halves, mask)


class ReferenceMaker:
    """Renders the two halves in parts, each of which is kept on disk.

    One picture of many samples converges faster than the mean of several of fewer samples, which are not stratified
    against one another. So every part doubles the number of samples.
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
        """Samples per pixel so far, of both halves."""
        return sum(self._spp)

    def next_spp(self) -> int:
        """Samples per pixel of the next part of each half, if there is time for it."""
        return self._spp[1] or FIRST_SPP

    def add(self, spp: int, report: Callable[[float], None] | None = None) -> None:
        """Render a part of so many samples per pixel for each half, or take what an interrupted run has kept."""
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
        """The reference so far; a part of it must be there."""
        first, second = (total / spp for total, spp in zip(self._sums, self._spp))
        return Reference(((first + second) / 2).astype(np.float32), Halves(first[..., :3], second[..., :3]), self.spp,
                         self.seconds)
