"""How long a picture takes: many runs after a warm-up, timed until the device has finished."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True)
class Timing:
    """Milliseconds by the wall clock: median and percentiles of `n` runs, which are equal if there is one run."""

    median: float
    p10: float
    p90: float
    n: int

    @classmethod
    def of(cls, seconds: list[float]) -> Timing:
        """Of the seconds that each run took."""
        p10, median, p90 = np.percentile(np.array(seconds) * 1e3, (10, 50, 90))
        return cls(float(median), float(p10), float(p90), len(seconds))

    def to_json(self) -> dict[str, float]:
        return {"median": self.median, "p10": self.p10, "p90": self.p90, "n": self.n}


@dataclass(frozen=True)
class Effort:
    """How often something is run: until there are `most` runs, or `least` and `seconds` have gone by.

    What takes longer than `once_s` is run once.
    """

    least: int
    most: int
    seconds: float
    once_s: float = float("inf")

    def is_enough(self, runs: int, seconds: float) -> bool:
        """Whether no more runs are due after so many, which took so long together."""
        return runs >= self.most or (runs >= self.least and seconds >= self.seconds)


def frame_effort(limit: float) -> Effort:
    """How often a real-time frame is drawn if all measuring may take `limit` seconds."""
    return Effort(least=7, most=60, seconds=limit / 200)


def picture_effort(limit: float) -> Effort:
    """How often a path-traced picture is rendered if all measuring may take `limit` seconds."""
    return Effort(least=3, most=9, seconds=limit / 200, once_s=limit / 50)


def measure(run: Callable[[], None], effort: Effort, tidy: Callable[[], None] = lambda: None) -> Timing:
    """Time `run`, which returns when its work and the device's is done, and was run before.

    `tidy` follows each run and is not timed.
    """
    seconds: list[float] = []
    started = time.perf_counter()
    while True:
        begun = time.perf_counter()
        run()
        now = time.perf_counter()
        seconds.append(now - begun)
        tidy()
        if effort.is_enough(len(seconds), now - started) or seconds[0] > effort.once_s:
            return Timing.of(seconds)
