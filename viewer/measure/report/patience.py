"""Which points there is time for, by what the ones before them took."""

from __future__ import annotations

from collections.abc import Sequence

from ...trace.paths.schedule import PILOT
from .ladder import Method
from .pareto import BUDGETS_MS
from .store import Record
from .timing import Effort

Rung = tuple[Method, Record]
LONGEST_S = 0.95 * BUDGETS_MS[-1] / 1e3
"""What a picture may take that is to be recommended for the longest time, with some to spare."""


def reason_against(method: Method, rungs: Sequence[Rung], seconds_left: float, effort: Effort) -> str:
    """Why not to measure `method` after `rungs`, by what those like it but for the samples took; "": do.

    The first of a family is measured in any case, but for the denoised ones.
    """
    alike = [(other, record) for other, record in rungs if other.family == method.family]
    alike = alike or [(other, record) for other, record in rungs if other.name == method.name]
    if not method.is_traced:
        return _unless_in_time(_growth(method, alike[-1][0]) * alike[-1][1].seconds, seconds_left) if alike else ""
    target = method.changes.get("error")
    if target is not None:
        pilots = [record for other, record in rungs if other.name == "path" and record.facts["spp"] >= PILOT]
        if not pilots:
            return f"{PILOT} samples a pixel, after which it begins to adapt, take too long here"
        factor = max((pilots[-1].facts["estimated_error"] / target) ** 2, PILOT / pilots[-1].facts["spp"])
        once = factor * _seconds(pilots[-1])
    elif alike:
        once = method.changes["spp"] / alike[-1][1].facts["spp"] * _seconds(alike[-1][1])
    elif method.name == "path":
        return ""
    else:
        once = 0.0
    return _unless_in_time(once if once > effort.once_s else effort.least * once, seconds_left)


def longest(steps: Sequence[Method], rungs: Sequence[Rung], seconds_left: float) -> Method | None:
    """The path-traced one of `steps`, which differ in samples, that fills LONGEST_S best, by what the last of them
    among `rungs` took; None where that one does, or where it takes more than is left."""
    climbed = [record for method, record in rungs if method in steps]
    if not climbed:
        return None
    spp, rate = climbed[-1].facts["spp"], _seconds(climbed[-1]) / climbed[-1].facts["spp"]
    fitting = [method for method in steps if spp < method.changes["spp"] <= LONGEST_S / rate]
    return fitting[-1] if fitting and fitting[-1].changes["spp"] * rate <= seconds_left else None


def _growth(method: Method, before: Method) -> float:
    """How many times as many lights of the environment cast shadows."""
    lights, fewer = (other.changes.get("environment_shadows", "off") for other in (method, before))
    return int(lights) / int(fewer) if lights.isdigit() and fewer.isdigit() else 1.0


def _seconds(record: Record) -> float:
    return record.facts["time_ms"]["median"] / 1e3


def _unless_in_time(wait: float, seconds_left: float) -> str:
    if wait <= seconds_left:
        return ""
    return f"it would take {_rounded(wait)}, more than is left" if wait else "no time is left for it"


def is_met_by_pilot(method: Method, rungs: Sequence[Rung]) -> bool:
    """Whether an adaptive picture would end before it adapts, as one more of PILOT samples a pixel."""
    target = method.changes.get("error")
    pilots = [record for other, record in rungs if other.name == "path" and record.facts["spp"] == PILOT]
    return target is not None and bool(pilots) and pilots[0].facts["estimated_error"] <= target


def _rounded(seconds: float) -> str:
    return f"{seconds:.2g} s" if seconds < 100 else f"{seconds / 60:.0f} min"
