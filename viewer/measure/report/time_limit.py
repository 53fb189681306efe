"""Which methods there is time to measure, predicted from what those measured before took."""

from __future__ import annotations

from collections.abc import Sequence

from ...trace.paths.schedule import LEAST
from .ladder import Method
from .pareto import BUDGETS_MS
from .store import Record
from .timing import Effort

Measured = tuple[Method, Record]
LONGEST_S = 0.95 * BUDGETS_MS[-1] / 1e3
"""What a picture may take to be recommended for the longest time, with a margin."""


def reason_against(method: Method, measured: Sequence[Measured], seconds_left: float, effort: Effort) -> str:
    """Why there is no time for `method` after those `measured`; "" where there is.

    The prediction is from methods that differ in the number of samples or lights alone. The first method of a family
    is measured in any case, except for denoised ones.
    """
    alike = [(other, record) for other, record in measured if other.family == method.family]
    alike = alike or [(other, record) for other, record in measured if other.name == method.name]
    if not method.is_traced:
        return _unless_in_time(_growth(method, alike[-1][0]) * alike[-1][1].seconds, seconds_left) if alike else ""
    target = method.changes.get("error")
    if target is not None:
        pilots = [record for other, record in measured if other.name == "path" and record.facts["spp"] >= LEAST]
        if not pilots:
            return f"the {LEAST} samples per pixel after which an error may end a picture take too long here"
        # The error falls with the root of the number of samples.
        factor = max((pilots[-1].facts["estimated_error"] / target) ** 2, LEAST / pilots[-1].facts["spp"])
        once = factor * _seconds(pilots[-1])
    elif alike:
        once = method.changes["spp"] / alike[-1][1].facts["spp"] * _seconds(alike[-1][1])
    elif method.name == "path":
        return ""
    else:
        once = 0.0
    return _unless_in_time(once if once > effort.once_s else effort.least * once, seconds_left)


def longest(methods: Sequence[Method], measured: Sequence[Measured], seconds_left: float) -> Method | None:
    """Of path-traced methods that differ in samples alone, the one with most samples that takes LONGEST_S at most.

    Predicted from the last of them that was measured. None where that has as many, where none of them was measured, and
    where it takes more than is left.
    """
    done = [record for method, record in measured if method in methods]
    if not done:
        return None
    spp, seconds_per_sample = done[-1].facts["spp"], _seconds(done[-1]) / done[-1].facts["spp"]
    fitting = [method for method in methods if spp < method.changes["spp"] <= LONGEST_S / seconds_per_sample]
    return fitting[-1] if fitting and fitting[-1].changes["spp"] * seconds_per_sample <= seconds_left else None


def ends_before_adapting(method: Method, measured: Sequence[Measured]) -> bool:
    """Whether an adaptive picture would reach its error with the first LEAST samples: it is that picture once more."""
    target = method.changes.get("error")
    pilots = [record for other, record in measured if other.name == "path" and record.facts["spp"] == LEAST]
    return target is not None and bool(pilots) and pilots[0].facts["estimated_error"] <= target


def _growth(method: Method, before: Method) -> float:
    """How many times as many lights of the environment cast shadows."""
    lights, fewer = (other.changes.get("environment_shadows", "off") for other in (method, before))
    return int(lights) / int(fewer) if lights.isdigit() and fewer.isdigit() else 1.0


def _seconds(record: Record) -> float:
    return record.facts["time_ms"]["median"] / 1e3


def _unless_in_time(seconds: float, seconds_left: float) -> str:
    if seconds <= seconds_left:
        return ""
    return f"it would take {_rounded(seconds)}, more than is left" if seconds else "no time is left for it"


def _rounded(seconds: float) -> str:
    return f"{seconds:.2g} s" if seconds < 100 else f"{seconds / 60:.0f} min"
