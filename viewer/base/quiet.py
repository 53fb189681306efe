"""Ignores Python's warnings in a block of code, on any number of threads at once."""

from __future__ import annotations

import threading
import warnings
from collections.abc import Iterator
from contextlib import contextmanager

_lock = threading.Lock()
_blocks = 0
_caught = warnings.catch_warnings()


@contextmanager
def without_warnings() -> Iterator[None]:
    """No warning is shown in the block, nor on other threads meanwhile.

    `warnings.catch_warnings` restores the filters that it found. Two threads whose blocks overlap would so leave
    "ignore" behind for good; here the last block restores what the first one found.
    """
    global _blocks, _caught
    with _lock:
        if _blocks == 0:
            _caught = warnings.catch_warnings()
            _caught.__enter__()
            warnings.simplefilter("ignore")
        _blocks += 1
    try:
        yield
    finally:
        with _lock:
            _blocks -= 1
            if _blocks == 0:
                _caught.__exit__(None, None, None)
