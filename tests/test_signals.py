"""Being asked to stop."""

from __future__ import annotations

import os
import signal
import threading

import pytest

from viewer.base.signals import Stopped, postponed, stoppable


@pytest.mark.parametrize("name, status, text", [("SIGINT", 130, "interrupted"), ("SIGTERM", 143, "terminated"),
                                                ("SIGHUP", 129, "terminated")])
def test_a_signal_ends_the_block_and_its_handler_comes_back(name, status, text):
    number = getattr(signal, name, None)
    if number is None:
        pytest.skip(f"no {name} here")
    default = signal.default_int_handler if name == "SIGINT" else signal.SIG_DFL
    before = signal.signal(number, default)  # under nohup it is ignored
    try:
        with pytest.raises(Stopped) as stopped, stoppable():
            os.kill(os.getpid(), number)
            threading.Event().wait(5)
        assert (stopped.value.exit_status, str(stopped.value)) == (status, text)
        assert signal.getsignal(number) is default
    finally:
        signal.signal(number, before)


def test_the_first_signal_is_recorded_and_the_second_raises():
    with stoppable():
        handler = signal.getsignal(signal.SIGINT)
        with postponed() as request:
            assert request.number is None
            os.kill(os.getpid(), signal.SIGINT)
            assert request.number == signal.SIGINT
            with pytest.raises(Stopped):
                os.kill(os.getpid(), signal.SIGTERM)
                threading.Event().wait(5)
        assert signal.getsignal(signal.SIGINT) is handler


def test_outside_of_our_own_program_signals_do_what_they_did():
    with postponed() as request, pytest.raises(KeyboardInterrupt):
        os.kill(os.getpid(), signal.SIGINT)
        threading.Event().wait(5)
    assert request.number is None


def test_what_is_ignored_stays_ignored():
    before = signal.signal(signal.SIGTERM, signal.SIG_IGN)
    try:
        with stoppable():
            os.kill(os.getpid(), signal.SIGTERM)
            assert signal.getsignal(signal.SIGTERM) == signal.SIG_IGN
    finally:
        signal.signal(signal.SIGTERM, before)


def test_another_thread_may_use_it():
    problems = []

    def work():
        try:
            with stoppable():
                pass
        except BaseException as error:
            problems.append(error)

    thread = threading.Thread(target=work)
    thread.start()
    thread.join()
    assert problems == []
