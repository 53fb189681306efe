"""Runs a progressive render until its samples, its error or its time limit is reached."""

from __future__ import annotations

import time
from collections.abc import Callable
from typing import TYPE_CHECKING

from ...settings import Settings

if TYPE_CHECKING:
    from .path_render import PathRender

SLICE_S = 0.2
"""Longest time between two checks whether to stop."""
REPORT_S = 0.5

Report = Callable[[float, float], None]
"""Called with the fraction of the work that is done, from 0 to 1, and an estimate of the remaining seconds."""


def run(path_render: PathRender, started: float, report: Report | None = None,
        wants_to_stop: Callable[[], bool] = lambda: False, reserve: float = 0.0) -> None:
    """Trace samples until the settings are met or `wants_to_stop()` is true.

    The time budget began at `started`, by time.perf_counter. `reserve` seconds of it are left for what follows. The
    budget may be exceeded until every pixel has a sample, and there are photons if any are asked for; and by half an
    iteration.
    """
    budget = path_render.settings.time_budget
    end = float("inf") if budget is None else started + budget - reserve
    reported, slice_s = started, 0.0
    while not path_render.is_done and not wants_to_stop():
        now = time.perf_counter()
        if now + slice_s / 2 >= end and path_render.is_whole:
            return
        is_near = end - now < 2 * SLICE_S
        path_render.step(0.0 if is_near else SLICE_S)
        slice_s = time.perf_counter() - now if is_near else 0.0
        if report is not None and time.perf_counter() - reported > REPORT_S:
            reported = time.perf_counter()
            fraction = _fraction(path_render, reported - started)
            report(fraction, (reported - started) * (1 / max(fraction, 1e-6) - 1))


def how_far(path_render: PathRender) -> str:
    """The progress as text: `12.3 of 64 samples a pixel, estimated error 0.08`."""
    settings, samples, error = path_render.settings, path_render.samples, path_render.error
    told = f"{samples:.3g}" if samples < 999.5 else f"{samples:.0f}"
    goal = f" of {settings.most_spp}" if _ends_by_samples(settings) else ""
    estimate = f", estimated error {error:.2g}" if error < float("inf") else ""
    return f"{told}{goal} samples a pixel{estimate}"


def _ends_by_samples(settings: Settings) -> bool:
    return settings.spp is not None or (settings.time_budget is None and settings.error is None)


def _fraction(path_render: PathRender, seconds: float) -> float:
    """The fraction of work done by the condition that is nearest to being met.

    The error falls with the root of the samples.
    """
    settings = path_render.settings
    parts = [path_render.samples / settings.most_spp]
    if settings.time_budget is not None:
        parts.append(seconds / settings.time_budget)
    if settings.error is not None:
        parts.append((settings.error / max(path_render.error, 1e-30)) ** 2)
    return min(max(parts), 1.0)
