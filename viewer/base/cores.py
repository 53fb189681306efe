"""The cores of this machine."""

from __future__ import annotations

import os


def core_count() -> int:
    """How many cores this process may use: containers and queues may leave it fewer than the machine has."""
    if hasattr(os, "sched_getaffinity"):
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1
