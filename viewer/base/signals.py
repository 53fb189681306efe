"""Being asked to stop, by Ctrl-C or another process, ends the work by an exception: no half-written file is left."""

from __future__ import annotations

import signal
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager, suppress
from typing import Any


class Stopped(BaseException):
    """Raised wherever the work is when the signal `number` comes."""

    def __init__(self, number: int) -> None:
        super().__init__(number)
        self.number = number

    @property
    def exit_status(self) -> int:
        """As a shell reports it: 130 for Ctrl-C."""
        return 128 + self.number

    def __str__(self) -> str:
        return "interrupted" if self.number == signal.SIGINT else "terminated"


class StopRequest:
    """Whether somebody has asked to stop: the `number` of the signal, or None."""

    number: int | None = None


@contextmanager
def postponed() -> Iterator[StopRequest]:
    """In the block the first signal to stop is only noted, for work that can end tidily; the next raises Stopped.

    That is so within `stoppable`; elsewhere, as in a program that uses this package, signals do what they did.
    """
    wish = StopRequest()
    before = {number: handler for number in _asked() if isinstance(handler := signal.getsignal(number), _Stop)}

    def note(number: int, frame: object) -> None:
        if wish.number is not None:
            raise Stopped(number)
        wish.number = number

    with _handlers(dict.fromkeys(before, note)):
        yield wish


@contextmanager
def stoppable() -> Iterator[None]:
    """Raises Stopped in the block for SIGINT, SIGTERM and SIGHUP, where they are not ignored (as under nohup)."""
    defaults = (signal.SIG_DFL, signal.default_int_handler)
    with _handlers({number: _Stop() for number in _asked() if signal.getsignal(number) in defaults}):
        yield


class _Stop:
    def __call__(self, number: int, frame: object) -> None:
        raise Stopped(number)


def _asked() -> list[int]:
    """The signals that ask to stop."""
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
