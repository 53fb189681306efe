"""Where time goes in one process: chosen functions are timed, each without the others it calls."""

from __future__ import annotations

import functools
import importlib
import threading
import time
from collections import defaultdict
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any


class Spans:
    """Seconds by name: `main` on the thread that made it, exclusive of spans inside, and `aside` on other threads."""

    def __init__(self) -> None:
        self.main: dict[str, float] = defaultdict(float)
        self.aside: dict[str, float] = defaultdict(float)
        self._thread = threading.get_ident()
        self._local = threading.local()

    @contextmanager
    def span(self, name: str) -> Iterator[None]:
        inner = self._local.__dict__.setdefault("inner", [])
        inner.append(0.0)
        start = time.perf_counter()
        try:
            yield
        finally:
            elapsed = time.perf_counter() - start
            totals = self.main if threading.get_ident() == self._thread else self.aside
            totals[name] += elapsed - inner.pop()
            if inner:
                inner[-1] += elapsed

    def watch(self, name: str, place: str) -> None:
        """Time the function at `place`, "module:attribute" or "module:Class.attribute"."""
        owner, attribute = find(place)
        setattr(owner, attribute, self._timed(name, getattr(owner, attribute)))

    def _timed(self, name: str, function: Callable) -> Callable:
        @functools.wraps(function)
        def timed(*args, **kwargs):
            with self.span(name):
                return function(*args, **kwargs)

        return timed


def find(place: str) -> tuple[Any, str]:
    """The module or class, and the name in it, of "module:attribute" or "module:Class.attribute"."""
    module, _, path = place.partition(":")
    *owners, attribute = path.split(".")
    return functools.reduce(getattr, owners, importlib.import_module(module)), attribute
