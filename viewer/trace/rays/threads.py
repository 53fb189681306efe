"""Threads that trace rays: Embree lets Python go on while it traces."""

from __future__ import annotations

import os
from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor, wait
from functools import cache

from ...base.cores import core_count


@cache
def ray_threads() -> ThreadPoolExecutor:
    """As many as Mesa's software renderer is given, which is less than the cores where --jobs shares them."""
    given = os.environ.get("LP_NUM_THREADS", "")
    return ThreadPoolExecutor(max(int(given), 1) if given.isdecimal() else core_count(), "rays")


def in_threads(trace: Callable[[int], None], begins: Sequence[int]) -> None:
    """Call `trace` for each of `begins`."""
    if len(begins) < 2:
        for begin in begins:
            trace(begin)
        return
    tasks = [ray_threads().submit(trace, begin) for begin in begins]
    try:
        for task in tasks:
            task.result()
    finally:  # after Ctrl-C, too, whoever catches it may release the scene, and no thread may read it then
        for task in tasks:
            task.cancel()
        wait(tasks)
