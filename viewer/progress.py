"""A progress bar on stderr for what takes longer than a second, on a terminal only."""

from __future__ import annotations

import sys
import threading

DELAY_S = 1.0


class Progress:
    """`step` begins the next of `total` pieces of work, `say` changes the words beside the bar."""

    def __init__(self, total: int, enabled: bool = True) -> None:
        self._total, self._done, self._text = total, -1, ""
        self._bar = None
        self._lock = threading.Lock()
        self._timer = threading.Timer(DELAY_S, self._show) if enabled and sys.stderr.isatty() else None

    def step(self, text: str) -> None:
        self._done += 1
        self.say(text)

    def say(self, text: str) -> None:
        with self._lock:
            self._text = text
            if self._bar is not None:
                self._bar.update(self._task, completed=max(self._done, 0), description=text)

    def _show(self) -> None:
        from rich.console import Console
        from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeElapsedColumn

        with self._lock:
            if self._timer is None:  # closed while we waited
                return
            columns = TextColumn("{task.description}"), BarColumn(), MofNCompleteColumn(), TimeElapsedColumn()
            self._bar = Progress(*columns, console=Console(stderr=True), transient=True)
            self._task = self._bar.add_task(self._text, total=self._total, completed=max(self._done, 0))
            self._bar.start()

    def __enter__(self) -> Progress:
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
