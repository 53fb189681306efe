"""What tests call in another process."""

from __future__ import annotations

import os
import sys
import time

import numpy as np


def double(data: bytes, **arguments: float) -> dict[str, np.ndarray]:
    numbers = np.frombuffer(data, np.uint8)
    return {"doubled": numbers.reshape(-1, 2) * 2.0, "none": np.zeros((0, 3), np.uint32),
            "given": np.array([arguments.get("number", 0)])}


def refuse(data: bytes) -> dict[str, np.ndarray]:
    raise ValueError("is not to my taste")


def misbehave(data: bytes, how: str) -> dict[str, np.ndarray]:
    """Crash, hang, compute, print, take memory, or answer with too much of it."""
    if how == "crash":
        os.abort()
    if how == "hang":
        time.sleep(1e6)
    while how == "compute":
        pass
    if how == "print":
        os.write(1, b"a library's words\n")
        print("and a script's", file=sys.stdout, flush=True)
    if how == "take":
        np.ones(1 << 33, np.uint8)
    return {"answer": np.zeros(1 << 24, np.uint8) if how == "answer" else np.zeros(3)}
