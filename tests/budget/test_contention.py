"""Time that was spent waiting for a processor."""

from __future__ import annotations

import time

import pytest

from viewer.budget import contention
from viewer.budget.contention import Stopwatch


@pytest.fixture
def clocks(monkeypatch):
    """What the clocks show: wall, this process's processors, and what its threads ran and waited."""
    now = {"wall": 0.0, "processor": 0.0, "usage": (0, 0)}
    monkeypatch.setattr(time, "perf_counter", lambda: now["wall"])
    monkeypatch.setattr(time, "process_time", lambda: now["processor"])
    monkeypatch.setattr(contention, "_usage", lambda: now["usage"])
    return now


@pytest.mark.parametrize("wall, processor, usage, quiet", [
    (2.0, 2.0, (0, 0), 2.0),  # nothing is told
    (2.0, 0.1, (100_000_000, 0), 2.0),  # a graphics card is waited for
    (4.0, 1.0, (1_000_000_000, 3_000_000_000), 1.0),  # three others at work
    (1.0, 1.0, (1_000_000_000, 1_000_000_000), 1.0),  # what was waited, was so beside the work
])
def test_waiting_for_a_processor_does_not_count(clocks, wall, processor, usage, quiet):
    watch = Stopwatch()
    clocks |= {"wall": wall, "processor": processor, "usage": usage}
    assert watch.quiet_seconds == pytest.approx(quiet)
    assert watch.slowdown == pytest.approx(wall / quiet)
