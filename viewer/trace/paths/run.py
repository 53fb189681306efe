"""A picture from its first sample to its last, or to where the time ends."""

from __future__ import annotations

import time
from collections.abc import Callable
from typing import TYPE_CHECKING

from ...settings import Settings

if TYPE_CHECKING:
    from .path_render import Exposure

SLICE_S = 0.2
"""How soon a wish to stop is heard."""
REPORT_S = 0.5

Report = Callable[[float, float], None]
"""Told how much of the work is done, from 0 to 1, and about how many seconds it will still take."""


def run(exposure: Exposure, started: float, report: Report | None = None,
        wants_to_stop: Callable[[], bool] = lambda: False, reserve: float = 0.0) -> None:
    """Let the picture converge until its settings are met or somebody `wants_to_stop`.

    The time budget began at `started`, by time.perf_counter, and `reserve` seconds of it are kept for what comes after.
    It may be exceeded: until every pixel has a sample, and by half a slice of work.
    """
    budget = exposure.settings.time_budget
    end = float("inf") if budget is None else started + budget - reserve
    reported, slice_s = started, 0.0
    while not exposure.is_done and not wants_to_stop():
        now = time.perf_counter()
        if now + slice_s / 2 >= end and exposure.film.tile_errors()[..., 2].min() > 0:
            return
        is_near = end - now < 2 * SLICE_S
        exposure.step(0.0 if is_near else SLICE_S)
        slice_s = time.perf_counter() - now if is_near else 0.0
        if report is not None and time.perf_counter() - reported > REPORT_S:
            reported = time.perf_counter()
            fraction = _fraction(exposure, reported - started)
            report(fraction, (reported - started) * (1 / max(fraction, 1e-6) - 1))


def how_far(exposure: Exposure) -> str:
    """`12.3 of 64 samples a pixel, estimated error 0.08`."""
    settings, error = exposure.settings, exposure.error
    goal = f" of {settings.most_spp}" if _ends_by_samples(settings) else ""
    estimate = f", estimated error {error:.2g}" if error < float("inf") else ""
    return f"{exposure.samples:.3g}{goal} samples a pixel{estimate}"


def _ends_by_samples(settings: Settings) -> bool:
    return settings.spp is not None or (settings.time_budget is None and settings.error is None)


def _fraction(exposure: Exposure, seconds: float) -> float:
    """By the rule that is nearest to being met; the error falls with the root of the samples."""
    settings = exposure.settings
    parts = [exposure.samples / settings.most_spp]
    if settings.time_budget is not None:
        parts.append(seconds / settings.time_budget)
    if settings.error is not None:
        parts.append((settings.error / max(exposure.error, 1e-30)) ** 2)
    return min(max(parts), 1.0)
