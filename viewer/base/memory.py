"""How much memory this process takes."""

from __future__ import annotations

import os
import sys
from contextlib import suppress
from pathlib import Path


def memory_mb() -> dict[str, float | None]:
    """The resident set in MB: now (`rss_mb`) and at its largest (`peak_rss_mb`). What the system does not report is
    None."""
    now, peak = _resident(), _peak()
    if now is not None and peak is not None:
        peak = max(peak, now)  # Linux brings the peak up to date only now and then
    return {"rss_mb": now, "peak_rss_mb": peak}


def _resident() -> float | None:
    with suppress(OSError):  # not Linux
        return int(Path("/proc/self/statm").read_text().split()[1]) * os.sysconf("SC_PAGE_SIZE") / (1 << 20)
    return None


def _peak() -> float | None:
    try:
        import resource
    except ImportError:  # Windows
        return None
    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    return peak / (1 << 20 if sys.platform == "darwin" else 1 << 10)
