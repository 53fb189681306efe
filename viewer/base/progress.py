"""A progress bar on stderr for work that takes longer than a second. It is shown only on a terminal."""

from __future__ import annotations

import math
import os
import sys
import threading
import time
from typing import TYPE_CHECKING, Any, Self

from .messages import one_line

if TYPE_CHECKING:
    from rich.progress import Progress as Bar
    from rich.progress import TaskID

DELAY_S = 1.0


class Progress:
    """`step` begins the next of `total` pieces of work, `say` changes the text beside the bar, and `part` sets how much
    of the current piece is done. Where pieces are worked on at once, `done` sets how many are done.

    With a `unit`, such as "models", the bar tells how many pieces are done a minute. Other output to stderr appears
    above the bar. The bar is removed at the end.
    """

    def __init__(self, total: int, enabled: bool = True, unit: str = "") -> None:
        self._total, self._done, self._text, self._unit = total, -1.0, "", unit
        self._began = time.monotonic()
        self._bar: Bar | None = None
        self._task: TaskID | None = None
        self._lock = threading.Lock()
        self._timer = threading.Timer(DELAY_S, self._show) if enabled and _is_terminal() else None

    def step(self, text: str) -> None:
        self._done = math.floor(self._done) + 1
        self.say(text)

    def part(self, fraction: float, text: str) -> None:
        """Show that `fraction` of the current piece, from 0 to 1, is done."""
        self._done = math.floor(self._done) + min(fraction, 0.999)
        self.say(text)

    def done(self, pieces: int, text: str) -> None:
        self._done = pieces
        self.say(text)

    @property
    def is_shown(self) -> bool:
        """Whether the bar is visible; if it is not, a text that is costly to compute can be skipped."""
        return self._bar is not None

    def say(self, text: str) -> None:
        with self._lock:
            self._text = one_line(text)
            if self._bar is not None and self._task is not None:
                completed = min(max(self._done, 0), self._total)
                self._bar.update(self._task, completed=completed, description=self._text, rate=self._rate())

    def _rate(self) -> str:
        pieces = math.floor(self._done)
        if not self._unit or pieces < 1:
            return ""
        return f"{60 * pieces / max(time.monotonic() - self._began, 1e-3):.3g} {self._unit} a minute"

    def _show(self) -> None:
        from rich.console import Console
        from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeElapsedColumn

        with self._lock:
            if self._timer is None:  # closed while we waited
                return
            description = TextColumn("{task.description}", markup=False)
            rate = [TextColumn("{task.fields[rate]}")] if self._unit else []
            columns = description, BarColumn(), MofNCompleteColumn(), TimeElapsedColumn(), *rate
            self._bar = Progress(*columns, console=Console(stderr=True), transient=True)
            done: Any = max(self._done, 0)  # rich accepts fractions, although its type hint says int
            self._task = self._bar.add_task(self._text, total=self._total, completed=done, rate=self._rate())
            self._bar.start()

    def __enter__(self) -> Self:
        if self._timer is not None:
            self._timer.daemon = True
            self._timer.start()
        return self

    def __exit__(self, *exc: object) -> None:
        if self._timer is not None:
            self._timer.cancel()
        with self._lock:
            self._timer = None
            if self._bar is not None:
                self._bar.stop()


def _is_terminal() -> bool:
    """Whether stderr is one, and can erase a line."""
    return sys.stderr is not None and sys.stderr.isatty() and os.environ.get("TERM") not in ("dumb", "unknown")
