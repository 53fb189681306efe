"""Memory that one thread has left free serves the others, and goes back to the system."""

from __future__ import annotations

import subprocess
import sys

from needs import needs

pytestmark = needs("glibc")

COMMON = """
import threading
from viewer.base.heap import trim_heap, share_one_heap

def resident_mb():
    return int(open("/proc/self/statm").read().split()[1]) * 4096 / 1e6

kept = []

def fill():
    blocks = [bytearray(60_000) for _ in range(2000)]  # 120 MB in pieces that are not mapped one by one
    kept.append(blocks[::50])  # so that what is free between them stays in the heap
    return resident_mb()

def in_a_thread():
    thread = threading.Thread(target=fill)
    thread.start()
    thread.join()

resident_at_first = resident_mb()
"""


def megabytes(code: str) -> float:
    done = subprocess.run([sys.executable, "-c", COMMON + code], capture_output=True, text=True, check=True)
    return float(done.stdout)


def test_what_is_free_goes_back():
    assert megabytes("fill(); before = resident_mb(); trim_heap(); print(before - resident_mb())") > 80


def test_what_a_thread_left_free_serves_another():
    code = "in_a_thread(); print(fill() - resident_at_first)"
    assert megabytes(code) > 200  # a heap for each
    assert megabytes("share_one_heap(); " + code) < 150
