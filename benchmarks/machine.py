"""What the figures were measured on."""

from __future__ import annotations

import os
import platform
import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from viewer.base.signals import Stopped

from . import shot
from .process import Run
from .programs import OURS
from .summary import Rounds


@contextmanager
def until_stopped() -> Iterator[None]:
    """Ctrl-C, or `timeout`, ends the block and no more: what was measured by then can be told."""
    def stop(number: int, frame: object) -> None:
        signal.signal(number, signal.SIG_IGN)
        raise Stopped(number)

    before = {number: signal.signal(number, stop) for number in (signal.SIGINT, signal.SIGTERM)}
    try:
        yield
    except Stopped as stopped:
        time.sleep(0.1)  # `timeout` sends the signal twice, to the process and to its group
        print(f"{stopped}: what was measured by then is kept", file=sys.stderr)
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)


def by_processor_time() -> str:
    """From now on, time.perf_counter counts the processor time of all threads of this process, so that others' work
    disturbs little; also in modules that have imported it by name. Returns, for a table, what its seconds are."""
    clock = time.perf_counter
    for module in list(sys.modules.values()):
        if getattr(module, "perf_counter", None) is clock:
            module.perf_counter = time.process_time
    return "of processor time"


def facts(named: dict[str, Run], phases: dict[str, Rounds]) -> dict[str, object]:
    """The machine, its load while measuring, and the renderer and versions that the programs named."""
    loads = [run["load"] for rounds in phases.values() for several in rounds.values() for run in several
             if "load" in run]
    return here() | {
        "load average": f"{min(loads)} to {max(loads)}" if loads else "unknown",
        "renderer": named.get(OURS, {}).get("renderer", "unknown"),
        "versions": ", ".join(f"{name} {run['version']}" for name, run in named.items() if "version" in run),
    }


def here() -> dict[str, object]:
    """This machine, this moment and this commit."""
    return {
        "date": time.strftime("%Y-%m-%d %H:%M"),
        "processor": f"{_processor()}, {len(os.sched_getaffinity(0))} cores",
        "system": f"{platform.system()} {platform.machine()}, Python {platform.python_version()}",
        "commit": _commit(),
    }


def _processor() -> str:
    information = Path("/proc/cpuinfo")
    lines = information.read_text().splitlines() if information.is_file() else []
    names = [line.split(":", 1)[1].strip() for line in lines if line.startswith("model name")]
    return names[0] if names else platform.processor()


def _commit() -> str:
    asked = subprocess.run(["git", "describe", "--always", "--dirty"], cwd=shot.REPOSITORY, capture_output=True,
                           text=True)
    return asked.stdout.strip() or "unknown"
