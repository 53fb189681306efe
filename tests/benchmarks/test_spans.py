"""Timed spans: exclusive of one another, apart by thread, and around functions where they stand."""

from __future__ import annotations

import sys
import threading
import types

import pytest

from benchmarks.spans import Spans


@pytest.fixture
def now(monkeypatch: pytest.MonkeyPatch) -> list[float]:
    """A clock that the test sets."""
    clock = [0.0]
    monkeypatch.setattr("benchmarks.spans.time.perf_counter", lambda: clock[0])
    return clock


def test_a_span_excludes_those_inside_it(now: list[float]) -> None:
    spans = Spans()
    with spans.span("outer"):
        now[0] += 1
        with spans.span("inner"):
            now[0] += 5
    assert spans.main == {"inner": 5, "outer": 1}


def test_other_threads_are_counted_aside(now: list[float]) -> None:
    spans = Spans()

    def work() -> None:
        with spans.span("work"):
            now[0] += 1

    thread = threading.Thread(target=work)
    thread.start()
    thread.join()
    assert spans.aside == {"work": 1} and not spans.main


def test_a_watched_function_and_method_are_timed_and_still_work(monkeypatch: pytest.MonkeyPatch) -> None:
    module = types.ModuleType("watched_module")
    exec("def twice(x): return 2 * x\nclass Adder:\n    def add(self, x): return x + 1", module.__dict__)
    monkeypatch.setitem(sys.modules, "watched_module", module)
    spans = Spans()
    spans.watch("function", "watched_module:twice")
    spans.watch("method", "watched_module:Adder.add")
    assert module.twice(2) == 4 and module.Adder().add(1) == 2
    assert set(spans.main) == {"function", "method"}
