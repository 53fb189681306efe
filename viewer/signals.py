"""Being asked to stop, by Ctrl-C or another process, ends the work by an exception: no half-written file is left."""

from __future__ import annotations

import signal
from collections.abc import Iterator
from contextlib import contextmanager, suppress


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


@contextmanager
def stoppable() -> Iterator[None]:
    """Raises Stopped in the block for SIGINT, SIGTERM and SIGHUP, where they are not ignored (as under nohup)."""

    def stop(number: int, _: object) -> None:
        raise Stopped(number)

    asked = [getattr(signal, name) for name in ("SIGINT", "SIGTERM", "SIGHUP") if hasattr(signal, name)]
    before = {number: signal.getsignal(number) for number in asked}
    changed = [n for n, handler in before.items() if handler in (signal.SIG_DFL, signal.default_int_handler)]
    with suppress(ValueError):  # only the main thread may set handlers
        for number in changed:
            signal.signal(number, stop)
    try:
        yield
    finally:
        with suppress(ValueError):
            for number in changed:
                signal.signal(number, before[number])
