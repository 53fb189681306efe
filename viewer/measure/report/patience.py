"""Which path-traced points are worth their time, by what the ones before them took."""

from __future__ import annotations

from collections.abc import Sequence

from ...trace.schedule import PILOT
from .ladder import Method
from .store import Record
from .timing import Effort

Rung = tuple[Method, Record]


def reason_against(method: Method, rungs: Sequence[Rung], seconds_left: float, effort: Effort) -> str:
    """Why not to measure `method` after `rungs`, by what those like it but for the samples took; "": do."""
    target = method.changes.get("error")
    if target is None:
        before = [record for other, record in rungs if other.name == method.name]
        factor = method.changes["spp"] / before[-1].facts["spp"] if before else 1.0
    else:
        before = [record for other, record in rungs if other.name == "path" and record.facts["spp"] >= PILOT]
        if not before:
            return f"{PILOT} samples a pixel, after which it begins to adapt, take too long here"
        reached = before[-1].facts["estimated_error"]
        factor = max((reached / target) ** 2, PILOT / before[-1].facts["spp"])
    once = factor * (before[-1].facts["time_ms"]["median"] / 1e3 if before else 0.0)
    wait = once if once > effort.once_s else effort.least * once
    if wait <= seconds_left:
        return ""
    return f"it would take {_rounded(wait)}, more than is left" if before else "no time is left for it"


def is_met_by_pilot(method: Method, rungs: Sequence[Rung]) -> bool:
    """Whether an adaptive picture would end before it adapts, as one more of PILOT samples a pixel."""
    target = method.changes.get("error")
    pilots = [record for other, record in rungs if other.name == "path" and record.facts["spp"] == PILOT]
    return target is not None and bool(pilots) and pilots[0].facts["estimated_error"] <= target


def _rounded(seconds: float) -> str:
    return f"{seconds:.2g} s" if seconds < 100 else f"{seconds / 60:.0f} min"
