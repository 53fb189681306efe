"""Being asked to stop."""

from __future__ import annotations

import os
import signal
import sys
import threading
from contextlib import nullcontext

import pytest
from needs import needs

from viewer.base.signals import Stopped, postponed, stoppable, unbroken


@pytest.mark.parametrize("name, status, text", [
    ("SIGINT", 130, "interrupted"), ("SIGTERM", 143, "terminated"),
    pytest.param("SIGHUP", 129, "terminated", marks=needs("posix"))])
def test_a_signal_ends_the_block_and_its_handler_comes_back(name, status, text):
    number = getattr(signal, name)
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


def test_a_block_within_another_has_the_same_request():
    with stoppable(), postponed() as outer:
        with postponed() as inner:
            os.kill(os.getpid(), signal.SIGINT)
            assert inner.number == signal.SIGINT
        assert outer.number == signal.SIGINT
        with pytest.raises(Stopped):
            os.kill(os.getpid(), signal.SIGINT)
            threading.Event().wait(5)


def test_in_a_block_that_may_not_be_broken_a_signal_waits_for_its_end():
    for scope, error in ((stoppable, Stopped), (nullcontext, KeyboardInterrupt)):
        ended = False
        with pytest.raises(error), scope(), unbroken():
            os.kill(os.getpid(), signal.SIGINT)
            threading.Event().wait(0.01)
            ended = True
        assert ended
    assert signal.getsignal(signal.SIGINT) is signal.default_int_handler


def test_a_signal_while_a_class_is_being_made_is_a_signal():
    class Member:
        def __set_name__(self, owner, name):
            os.kill(os.getpid(), signal.SIGINT)
            threading.Event().wait(5)

    with pytest.raises(Stopped), stoppable():
        type("Owner", (), {"member": Member()})


class Deaf:
    """Loses what the handler of a signal raises, as Python ignores what `__del__` raises."""

    def __del__(self):
        os.kill(os.getpid(), signal.SIGINT)
        threading.Event().wait(5)


@needs("posix")
def test_a_signal_that_python_ignored_is_sent_again():
    report = sys.unraisablehook
    with pytest.raises(Stopped), stoppable():
        Deaf()
        Deaf()
        threading.Event().wait(5)
        pytest.fail("nobody was told")
    assert sys.unraisablehook is report


@needs("posix")
@pytest.mark.parametrize("scope", [nullcontext, unbroken])
def test_a_signal_that_python_ignored_at_the_end_of_a_block_ends_it(scope):
    with pytest.raises(Stopped), stoppable():
        Deaf()
        with scope():
            pass
    assert signal.getsignal(signal.SIGINT) is signal.default_int_handler


def test_what_else_python_ignores_is_reported(monkeypatch):
    reported = []
    monkeypatch.setattr(sys, "unraisablehook", lambda ignored: reported.append(ignored.exc_type))

    class Broken:
        def __del__(self):
            raise ValueError

    with stoppable():
        Broken()
    assert reported == [ValueError]


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
