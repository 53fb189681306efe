"""Timed spans: exclusive of one another, apart by thread, and around functions where they stand."""

from __future__ import annotations

import sys
import threading
import time
import types

import pytest

from benchmarks.spans import Spans


def test_a_span_excludes_those_inside_it() -> None:
    spans = Spans()
    with spans.span("outer"):
        time.sleep(0.01)
        with spans.span("inner"):
            time.sleep(0.05)
    assert spans.main["inner"] >= 0.05
    assert 0.01 <= spans.main["outer"] < spans.main["inner"]


def test_other_threads_are_counted_aside() -> None:
    spans = Spans()

    def work() -> None:
        with spans.span("work"):
            time.sleep(0.01)

    thread = threading.Thread(target=work)
    thread.start()
    thread.join()
    assert spans.aside["work"] >= 0.01 and "work" not in spans.main


def test_a_watched_function_and_method_are_timed_and_still_work(monkeypatch: pytest.MonkeyPatch) -> None:
    module = types.ModuleType("watched_module")
    exec("def twice(x): return 2 * x\nclass Adder:\n    def add(self, x): return x + 1", module.__dict__)
    monkeypatch.setitem(sys.modules, "watched_module", module)
    spans = Spans()
    spans.watch("function", "watched_module:twice")
    spans.watch("method", "watched_module:Adder.add")
    assert module.twice(2) == 4 and module.Adder().add(1) == 2
    assert set(spans.main) == {"function", "method"}
