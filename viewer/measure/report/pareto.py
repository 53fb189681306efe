"""Choices among points: the Pareto front, the best for a time, and settings that cost time and save no error."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

BUDGETS_MS = (1000 / 30, 100.0, 1000.0, 10_000.0)
"""Times of a picture: 30 frames a second, a delay that is hardly noticed, one that is, and a wait."""
SAME = 0.02
"""Errors that differ by less than this share count as equal."""


def front(times: Sequence[float], errors: Sequence[float]) -> list[bool]:
    """Whether each point is on the Pareto front: none is as good in both time and error, and better in one."""
    order = sorted(range(len(times)), key=lambda k: (times[k], errors[k]))
    is_on = [False] * len(times)
    least = float("inf")
    for k in order:
        if errors[k] < least:
            is_on[k], least = True, errors[k]
    return is_on


def best_within(budget: float, times: Sequence[float], errors: Sequence[float]) -> int | None:
    """The point with the smallest error that takes at most `budget`, of equal ones the fastest; None if none does."""
    fitting = [k for k, time in enumerate(times) if time <= budget]
    return min(fitting, key=lambda k: (errors[k], times[k]), default=None)


@dataclass(frozen=True)
class Knob:
    """Two points that differ in one setting: `cheap` has no larger error than `dear`, and is faster."""

    setting: str
    cheap: int
    dear: int
    values: tuple[Any, Any]
    """Of the setting, at `cheap` and at `dear`."""
    saved: float
    """Share of the time of `dear`."""


def free_knobs(settings: Sequence[Mapping[str, Any]], times: Sequence[Mapping[str, float]],
               errors: Sequence[Sequence[float]], noise: Sequence[float]) -> list[Knob]:
    """Settings whose cheaper choice costs no error, those that save most time first.

    `settings` with the same names can be compared. `errors` has each point's error by several measures, because a
    picture of small error may still look wrong. By each of them the cheaper point's may exceed the other's by `noise`,
    the reference's floor, or by SAME of it. A point is faster if its p90 is below the other's median, and its median
    below the other's p10.
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
