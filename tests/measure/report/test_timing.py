from __future__ import annotations

import pytest

from viewer.measure.report import timing
from viewer.measure.report.timing import Effort, Timing, measure


@pytest.fixture
def clock(monkeypatch):
    """A clock that stands unless it is put forward: `clock[0]`."""
    now = [0.0]
    monkeypatch.setattr(timing.time, "perf_counter", lambda: now[0])
    return now


def runs(clock, effort: Effort, *seconds: float) -> Timing:
    """What `measure` finds where the runs take so long, the last number for all that follow; tidying takes 100 s."""
    left = list(seconds)

    def run() -> None:
        clock[0] += left.pop(0) if len(left) > 1 else left[0]

    def tidy() -> None:
        clock[0] += 100.0 if effort.seconds > 1e3 else 0.0

    return measure(run, effort, tidy)


def test_the_median_and_the_spread_of_enough_runs(clock):
    found = runs(clock, Effort(3, 50, 0.5), 0.1)
    assert found.n == 5 and [found.p10, found.median, found.p90] == pytest.approx([100] * 3)
    assert runs(clock, Effort(3, 50, 0.5), 0.3).n == 3
    assert runs(clock, Effort(3, 50, 0.5), 0.001).n == 50
    found = runs(clock, Effort(5, 5, 0.0), 0.1, 0.2, 0.3, 0.4, 0.5)
    assert (found.median, found.n) == (pytest.approx(300), 5) and found.p10 == pytest.approx(140)


def test_what_takes_long_is_run_once_and_says_so(clock):
    assert runs(clock, Effort(3, 9, 1.0, once_s=3.0), 4.0).to_json() == {"median": 4e3, "p10": 4e3, "p90": 4e3, "n": 1}


def test_tidying_is_off_the_clock(clock):
    assert runs(clock, Effort(3, 3, 1e4), 1.0).p90 == pytest.approx(1e3)
