"""Threads that trace rays, and what may happen to them."""

from __future__ import annotations

import os
import subprocess
import sys

import pytest

FORKED = """
import os, signal
from viewer.trace.rays.threads import in_threads
assert in_threads(str, range(3)) == ["0", "1", "2"]
if not os.fork():
    signal.alarm(10)
    assert in_threads(str, range(3)) == ["0", "1", "2"]
    os._exit(7)
print(os.waitstatus_to_exitcode(os.wait()[1]))
"""


@pytest.mark.parametrize("threads", ["", "1", "0", "garbage", "-3"])
def test_a_fork_has_threads_of_its_own(threads):
    done = subprocess.run([sys.executable, "-c", FORKED], env=os.environ | {"LP_NUM_THREADS": threads}, check=True,
                          capture_output=True, text=True, timeout=60)
    assert done.stdout == "7\n", done.stderr
