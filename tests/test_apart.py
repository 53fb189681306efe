"""Functions that run in another process do no harm to this one."""

from __future__ import annotations

import subprocess
import sys
import threading

import numpy as np
import pytest
from apart_functions import double
from needs import needs

from viewer.base.apart import Apart, ApartError

DOUBLE, REFUSE, MISBEHAVE = (f"apart_functions:{name}" for name in ("double", "refuse", "misbehave"))
MEGABYTE = 1 << 20


@pytest.fixture
def apart():
    other = Apart()
    yield other
    other.close()


def test_arrays_come_back(apart):
    data = bytes(range(100))
    result, expected = apart.call(DOUBLE, data, 60, MEGABYTE, number=7), double(data, number=7)
    assert result.keys() == expected.keys()
    for name, array in result.items():
        assert array.dtype == expected[name].dtype and array.flags.writeable
        np.testing.assert_array_equal(array, expected[name])


def test_a_value_error_is_told_and_the_process_goes_on(apart):
    apart.call(DOUBLE, bytes(2), 60, MEGABYTE)
    process = apart.process
    with pytest.raises(ApartError, match="^is not to my taste$"):
        apart.call(REFUSE, b"", 60, MEGABYTE)
    apart.call(DOUBLE, bytes(2), 60, MEGABYTE)
    assert apart.process is process


@pytest.mark.parametrize("how, seconds, words", [
    ("crash", 60, "too broken"), ("hang", 0.05, "takes longer than"), ("answer", 60, "too broken"),
    pytest.param("take", 60, "too much memory", marks=needs("linux"))])
def test_after_harm_the_next_call_works(apart, how, seconds, words):
    with pytest.raises(ApartError, match=words):
        apart.call(MISBEHAVE, b"", seconds, MEGABYTE, how=how)
    assert apart.call(DOUBLE, bytes([1, 2]), 60, MEGABYTE)["doubled"].tolist() == [[2, 4]]


@needs("linux")
def test_what_computes_is_stopped_by_its_own_time_and_not_by_the_clock(apart, monkeypatch):
    monkeypatch.setattr("viewer.base.apart._PATIENCE", 1e6)
    with pytest.raises(ApartError, match="takes longer than 1 s"):
        apart.call(MISBEHAVE, b"", 1, MEGABYTE, how="compute")
    assert apart.call(DOUBLE, bytes([1, 2]), 60, MEGABYTE)["doubled"].tolist() == [[2, 4]]


def test_a_time_that_is_up_as_the_answer_comes_does_no_harm_to_the_next_call(apart, monkeypatch):
    class Late(threading.Timer):
        """Ends as late as it can: when it has begun, and is cancelled."""

        def __init__(self, seconds, stop):
            super().__init__(0, stop)
            self.is_cancelled, self.function = threading.Event(), self.wait_and_stop
            self.stop = stop

        def cancel(self):
            self.is_cancelled.set()

        def wait_and_stop(self):
            self.is_cancelled.wait(60)
            self.stop()

    monkeypatch.setattr(threading, "Timer", Late)
    for number in range(3):
        assert apart.call(DOUBLE, bytes([number, 2]), 60, MEGABYTE)["doubled"].tolist() == [[2 * number, 4]]


def test_what_a_library_prints_is_no_answer(apart):
    assert apart.call(MISBEHAVE, b"", 60, MEGABYTE, how="print")["answer"].tolist() == [0, 0, 0]


def test_threads_take_turns(apart):
    results = {}

    def work(k):
        results[k] = apart.call(DOUBLE, bytes([k, k]), 60, MEGABYTE)["doubled"].tolist()

    threads = [threading.Thread(target=work, args=(k,)) for k in range(8)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert results == {k: [[2 * k, 2 * k]] for k in range(8)}


def test_it_ends_when_nobody_can_call_it_any_more():
    """As when this process is killed: its end of the pipe closes."""
    code = f"import sys; sys.path[:] = {sys.path!r}; from viewer.base.apart import serve; serve()"
    subprocess.run([sys.executable, "-c", code], stdin=subprocess.DEVNULL, timeout=60, check=True)
