"""Threads that trace rays: Embree lets Python go on while it traces."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterable, Sequence
from concurrent.futures import ThreadPoolExecutor, wait
from functools import cache
from typing import TypeVar

from ...base.cores import core_count

T = TypeVar("T")
Found = TypeVar("Found")


@cache
def ray_threads() -> ThreadPoolExecutor:
    """As many as Mesa's software renderer is given, which is less than the cores where --jobs shares them."""
    given = os.environ.get("LP_NUM_THREADS", "")
    return ThreadPoolExecutor(max(int(given), 1) if given.isdecimal() else core_count(), "rays")


os.register_at_fork(after_in_child=ray_threads.cache_clear)  # a fork has none of its parent's threads, and would wait


def in_other_threads(trace: Callable[[T], Found], parts: Iterable[T]) -> Callable[[], list[Found]]:
    """Begin to call `trace` for each of `parts`. The result waits for what it finds, in their order."""
    tasks = [ray_threads().submit(trace, part) for part in parts]

    def finish() -> list[Found]:
        try:
            return [task.result() for task in tasks]
        finally:  # after Ctrl-C, too, whoever catches it may release the scene, and no thread may read it then
            for task in tasks:
                task.cancel()
            wait(tasks)

    return finish


def in_threads(trace: Callable[[T], Found], parts: Sequence[T]) -> list[Found]:
    """What `trace` finds for each of `parts`; without another thread if there is but one."""
    return [trace(part) for part in parts] if len(parts) < 2 else in_other_threads(trace, parts)()
