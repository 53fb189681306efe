"""Signals that ask the process to stop (Ctrl-C, or sent by another process), turned into an exception.

An exception ends the work in an orderly way, so that no half-written file is left.
"""

from __future__ import annotations

import signal
import sys
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager, suppress
from typing import Any


class Stopped(BaseException):
    """Raised in the running code when the signal `number` arrives."""

    def __init__(self, number: int) -> None:
        super().__init__(number)
        self.number = number

    @property
    def exit_status(self) -> int:
        """The exit status as a shell reports it: 128 plus the signal's number, 130 for Ctrl-C."""
        return 128 + self.number

    def __str__(self) -> str:
        return "interrupted" if self.number == signal.SIGINT else "terminated"


class StopRequest:
    """`number` is the signal that has asked to stop, or None as long as there was none. It handles signals: it records
    the first, and raises Stopped for the next."""

    number: int | None = None

    def __call__(self, number: int, frame: object) -> None:
        if self.number is not None:
            raise Stopped(number)
        self.number = number


@contextmanager
def postponed() -> Iterator[StopRequest]:
    """In the block the first signal to stop is only recorded, so that the work can end by itself; the next raises
    Stopped. A block within another has the same request: a film that is to end ends its picture, too.

    This works inside a `stoppable` block. Elsewhere, for example in a program that uses this package, the handlers of
    signals are not changed.
    """
    handlers = {number: signal.getsignal(number) for number in _stop_signals()}
    outer = next((handler for handler in handlers.values() if isinstance(handler, StopRequest)), None)
    if outer is not None:
        yield outer
        return
    request = StopRequest()
    with _handlers({number: request for number, handler in handlers.items() if isinstance(handler, _Stop)}):
        yield request


@contextmanager
def stoppable() -> Iterator[None]:
    """In the block SIGINT, SIGTERM and SIGHUP raise Stopped, unless the process ignores them (as under nohup)."""
    defaults = (signal.SIG_DFL, signal.default_int_handler)
    try:
        stops = {number: _Stop() for number in _stop_signals() if signal.getsignal(number) in defaults}
        with _handlers(stops), sent_again():
            yield
    except RuntimeError as error:
        if isinstance(error.__cause__, Stopped):  # Python 3.11 wraps so what is raised while a class is being made
            raise error.__cause__ from None
        raise


@contextmanager
def sent_again() -> Iterator[None]:
    """Python ignores what `__del__` or a callback of a weak reference raises, such as Stopped. In the block the signal
    is then sent again a moment later, until one is not ignored. The block ends after the last was sent."""
    from threading import Timer, get_ident  # not above, where no signal is answered yet

    timers: list[Timer] = []
    report = sys.unraisablehook

    def send_again(ignored: sys.UnraisableHookArgs) -> None:
        if not isinstance(ignored.exc_value, Stopped):
            report(ignored)
            return
        # Not now: what this function raises would be ignored, too
        timers.append(Timer(0.01, _send, (get_ident(), ignored.exc_value.number)))
        timers[-1].start()

    sys.unraisablehook = send_again
    try:
        yield
    finally:
        try:
            for timer in timers:
                timer.join()
        finally:
            sys.unraisablehook = report


@contextmanager
def unbroken() -> Iterator[None]:
    """In the block no signal raises an exception; one that came is handled at its end.

    For calls of C code that itself calls Python, does not check whether that raised, and then crashes.
    """
    came: list[int] = []
    before = {number: handler for number in _stop_signals() if callable(handler := signal.getsignal(number))}
    try:
        with _handlers(dict.fromkeys(before, lambda number, frame: came.append(number))):
            yield
    finally:
        for number in came[:1]:
            before[number](number, None)


class _Stop:
    def __call__(self, number: int, frame: object) -> None:
        raise Stopped(number)


def _send(thread: int, number: int) -> None:
    """Send the signal to a thread, the main one, so that it does not wait on; Windows has no signals for threads."""
    if sys.platform == "win32":
        signal.raise_signal(number)
    else:
        signal.pthread_kill(thread, number)


def _stop_signals() -> list[int]:
    """The signals that ask a process to stop, as far as this system has them."""
    return [getattr(signal, name) for name in ("SIGINT", "SIGTERM", "SIGHUP") if hasattr(signal, name)]


@contextmanager
def _handlers(handlers: Mapping[int, Callable[[int, object], None]]) -> Iterator[None]:
    """Signals are handled so in the block. Only the main thread may set handlers; another's block changes nothing."""
    before: dict[int, Any] = {number: signal.getsignal(number) for number in handlers}
    with suppress(ValueError):
        for number, handler in handlers.items():
            signal.signal(number, handler)
    try:
        yield
    finally:
        with suppress(ValueError):
            for number, handler in before.items():
                signal.signal(number, handler)
