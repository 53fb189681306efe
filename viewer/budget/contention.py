"""How much longer work takes because the processors have other things to do."""

from __future__ import annotations

import os
import time
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path

_TASKS = Path("/proc/self/task")
"""Linux tells of each thread for how long it ran, and waited for a processor: Documentation/scheduler/sched-stats."""


class Stopwatch:
    """Runs from when it is made; knows what of the time this process was kept waiting for a processor."""

    def __init__(self) -> None:
        self._started, self._processor, self._usage = time.perf_counter(), time.process_time(), _usage()

    @property
    def seconds(self) -> float:
        return time.perf_counter() - self._started

    @property
    def quiet_seconds(self) -> float:
        """What the same would have taken on an idle machine, about; `seconds` where the system does not tell.

        Threads wait side by side, so what they waited is the most that was lost; and nothing takes less time than
        processors worked on it, if it is one at a time.
        """
        ran, waited = (now - then for now, then in zip(_usage(), self._usage, strict=True))
        share = ran / (ran + waited) if ran > 0 and waited > 0 else 1.0
        seconds = self.seconds
        return max(seconds * share, min(seconds, time.process_time() - self._processor))

    @property
    def slowdown(self) -> float:
        """1 on an idle machine."""
        return self.seconds / max(self.quiet_seconds, 1e-9)


def quiet_seconds(run: Callable[[], object]) -> float:
    """Of `run`, which reads its picture back, so that the device is done with it."""
    watch = Stopwatch()
    run()
    return watch.quiet_seconds


def _usage() -> tuple[int, int]:
    """Nanoseconds that this process's threads ran, and waited though they could have run."""
    ran = waited = 0
    with suppress(OSError):
        for task in os.listdir(_TASKS):
            with suppress(OSError, ValueError, IndexError):  # a thread that has ended meanwhile
                words = (_TASKS / task / "schedstat").read_text().split()
                ran, waited = ran + int(words[0]), waited + int(words[1])
    return ran, waited
