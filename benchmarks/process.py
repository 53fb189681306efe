"""Run one program as a user would: from nothing to a picture on disk, with its wall time and peak memory."""

from __future__ import annotations

import json
import os
import resource
import subprocess
import tempfile
import time
from collections.abc import Mapping, Sequence
from pathlib import Path

Run = dict[str, object]
"""What became of one run of a program."""

_KEPT = ("PATH", "LANG", "LD_LIBRARY_PATH")
_POLL = 0.002


def run(command: Sequence[str], picture: Path, size: tuple[int, int], home: Path, folder: Path,
        timeout: float = 300.0, more: Mapping[str, str] | None = None) -> Run:
    """Runs `command` in `folder`, with `home` for HOME and the XDG folders and no other settings of this user.

    `more` are further variables of its environment. Returns wall_s, processor_s (of all its threads and of the
    processes that it has waited for), rss_mb (the largest resident set of the process), load (of the machine, one
    minute), and what the program printed as its last line of JSON; or `error`, also where the picture is missing or
    blank.
    """
    picture.unlink(missing_ok=True)
    with tempfile.TemporaryFile() as out, tempfile.TemporaryFile() as err:
        start = time.perf_counter()
        process = subprocess.Popen(command, stdout=out, stderr=err, env=_environment(home) | dict(more or {}),
                                   cwd=folder)
        try:
            status, usage, peak_kb = _wait(process, start + timeout)
        finally:
            if process.returncode is None:  # this one is being stopped
                process.kill()
                process.wait()
        wall = time.perf_counter() - start
        if usage is None:
            return {"error": f"over {timeout:g} s"}
        if status:
            return {"error": f"status {status}: {' | '.join(_tail(err, 3))}"}
        problem = _blank(picture, size)
        if problem:
            return {"error": problem}
        said = [line for line in _tail(out, 20) if line.startswith("{")]
    reported = json.loads(said[-1]) if said else {}
    return {**reported, "wall_s": round(wall, 4), "processor_s": round(usage.ru_utime + usage.ru_stime, 4),
            "rss_mb": round(peak_kb / 1024, 1), "load": round(os.getloadavg()[0], 2)}


def _environment(home: Path) -> dict[str, str]:
    kept = {name: os.environ[name] for name in _KEPT if name in os.environ}
    folders = {f"XDG_{kind}_HOME": str(home / kind.lower()) for kind in ("CACHE", "DATA", "CONFIG", "STATE")}
    return {**kept, **folders, "HOME": str(home), "TMPDIR": str(home), "XDG_RUNTIME_DIR": str(home)}


def _wait(process: subprocess.Popen, deadline: float) -> tuple[int, resource.struct_rusage | None, int]:
    """(exit status, what it used, peak resident set in KiB); None where the process had to be killed."""
    peak = 0
    while True:
        peak = high_water_mark(process.pid) or peak
        pid, status, usage = os.wait4(process.pid, os.WNOHANG)
        if pid:
            process.returncode = os.waitstatus_to_exitcode(status)
            return process.returncode, usage, peak or usage.ru_maxrss
        if time.perf_counter() > deadline:
            process.kill()
            process.wait()
            return process.returncode, None, peak
        time.sleep(_POLL)


def high_water_mark(pid: int) -> int | None:
    """The most memory the process has held so far, in KiB, where Linux tells.

    It never falls, so the last look before the end will do; what wait4 tells counts this process too, of which the
    other is a copy until it starts its program.
    """
    try:
        status = Path(f"/proc/{pid}/status").read_text()
    except OSError:
        return None
    found = [line.split()[1] for line in status.splitlines() if line.startswith("VmHWM:")]
    return int(found[0]) if found else None


def _tail(file, lines: int) -> list[str]:
    file.seek(0)
    return file.read().decode(errors="replace").strip().splitlines()[-lines:]


def _blank(picture: Path, size: tuple[int, int]) -> str:
    """Why the picture is none: some programs save an empty one and exit with status 0."""
    from PIL import Image

    if not picture.is_file():
        return "no picture"
    with Image.open(picture) as image:
        if image.size != size:
            return f"the picture is {image.size[0]}x{image.size[1]}, not {size[0]}x{size[1]}"
        if all(low == high for low, high in image.convert("RGB").getextrema()):
            return "the picture is blank"
    return ""
