"""Settings of the C library's memory allocator."""

from __future__ import annotations

import ctypes
from contextlib import suppress

_ARENA_MAX = -8  # M_ARENA_MAX of glibc's malloc.h


def share_one_heap() -> None:
    """Make all threads allocate from one heap, if the C library is glibc. Call it before the threads start that shall.

    By default glibc gives each thread a heap of its own, and no thread can use the free memory in another's heap. Two
    threads decode images and a third uploads them, so this costs 30 MB at the peak and the time to allocate them.
    """
    with suppress(AttributeError, OSError, TypeError):
        ctypes.CDLL(None).mallopt(_ARENA_MAX, 1)


def trim_heap() -> None:
    """Return the free memory of the heap to the system, if the C library is glibc."""
    with suppress(AttributeError, OSError, TypeError):
        ctypes.CDLL(None).malloc_trim(0)
