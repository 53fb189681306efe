"""Choosing among points: the Pareto front, the best for a time, and what costs time for nothing."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

BUDGETS_MS = (1000 / 30, 100.0, 1000.0, 10_000.0)
"""30 frames a second, and what one waits for without noticing, with noticing, and once."""
SAME = 0.02
"""Errors that differ by less than this share of themselves are called the same."""


def front(times: Sequence[float], errors: Sequence[float]) -> list[bool]:
    """Whether each point is on the front: none is as fast and as right, and better in one of the two."""
    order = sorted(range(len(times)), key=lambda k: (times[k], errors[k]))
    is_on = [False] * len(times)
    least = float("inf")
    for k in order:
        if errors[k] < least:
            is_on[k], least = True, errors[k]
    return is_on


def best_within(budget: float, times: Sequence[float], errors: Sequence[float]) -> int | None:
    """The point of the least error, of those equal the fastest, that takes `budget` at most; None where none does."""
    fitting = [k for k, time in enumerate(times) if time <= budget]
    return min(fitting, key=lambda k: (errors[k], times[k]), default=None)


@dataclass(frozen=True)
class Knob:
    """Two points that differ in one setting: `cheap` is as right as `dear`, and faster."""

    setting: str
    cheap: int
    dear: int
    values: tuple[Any, Any]
    """Of the setting, at `cheap` and at `dear`."""
    saved: float
    """Share of the time of `dear`."""


def free_knobs(settings: Sequence[Mapping[str, Any]], times: Sequence[Mapping[str, float]],
               errors: Sequence[Sequence[float]], noise: Sequence[float]) -> list[Knob]:
    """Knobs that cost nothing in error when turned to the cheaper side, those that save most first.

    `settings` hold the same names where they can be compared. `errors` have each point's by several measures, and by
    none of them may it be larger than the other's by more than `noise`, the reference's floor, or SAME of itself: what
    is off by no more may still look wrong. A point is faster where the middle 80 % of its times, p10
    to p90, lie below the other's median, and its median below the other's p10.
    """
    knobs = []
    for cheap, few in enumerate(settings):
        for dear, many in enumerate(settings):
            changed = [name for name in few if few[name] != many.get(name)] if few.keys() == many.keys() else []
            is_same = all(a - b <= max(floor, SAME * b) for a, b, floor in zip(errors[cheap], errors[dear], noise))
            a, b = times[cheap], times[dear]
            if len(changed) == 1 and is_same and a["p90"] < b["median"] and a["median"] < b["p10"]:
                name = changed[0]
                knobs.append(Knob(name, cheap, dear, (few[name], many[name]), 1 - a["median"] / b["median"]))
    return sorted(knobs, key=lambda knob: -knob.saved)
