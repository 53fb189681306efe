"""Where the address space is too small for a driver, one line says so, and nothing waits or dies."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

from needs import needs

RENDER = """
import resource, sys
resource.setrlimit(resource.RLIMIT_AS, (350 << 20,) * 2)
from viewer.cli import main
main(["render", "assets/demo.glb", "-o", sys.argv[1], "--size", "8"])
"""


@needs("linux")
def test_says_that_there_is_too_little(tmp_path: Path) -> None:
    command = [sys.executable, "-c", RENDER, tmp_path / "x.png"]
    done = subprocess.run(command, capture_output=True, text=True, timeout=60)
    assert (done.returncode, done.stdout) == (3, "")
    assert done.stderr.count("\n") == 1 and "out of memory" in done.stderr and "ulimit -v" in done.stderr
    assert not list(tmp_path.iterdir())
