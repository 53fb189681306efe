"""How the C library hands out memory."""

from __future__ import annotations

import ctypes
from contextlib import suppress

_ARENA_MAX = -8  # M_ARENA_MAX of glibc's malloc.h


def share_one_heap() -> None:
    """Have all threads allocate from one heap, where the C library is glibc; before the second thread does.

    Each would get a heap of its own, and what one thread leaves free is lost to the others: with images decoded on two
    threads and uploaded by a third, 30 MB at the peak, and the time it takes the system to provide them.
    """
    with suppress(AttributeError, OSError, TypeError):
        ctypes.CDLL(None).mallopt(_ARENA_MAX, 1)


def give_back() -> None:
    """Return to the system what is free in the heap, where the C library is glibc."""
    with suppress(AttributeError, OSError, TypeError):
        ctypes.CDLL(None).malloc_trim(0)
