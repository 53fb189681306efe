"""Makes pictures by the method that suits the time there is, or the error they may have."""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Collection
from dataclasses import replace

from ..gpu.context import Context
from ..image import Image
from ..raster.renderer import Renderer
from ..scene.camera import Camera
from ..scene.scene import Scene
from ..settings import Settings
from ..trace.run import Report
from ..trace.tracer import Tracer
from .calibration import Calibration, load_calibration, store_calibration
from .candidates import Candidate, Ready, TracedCandidate, candidates
from .choice import Choice
from .contention import Stopwatch
from .cost import Load, plain_plan
from .course import best_course, choose, worth_trying
from .known import load_known, store_known, surfaces
from .making import Making, View

MOST_PACE = 10.0
"""Other work on the device may slow it down so many times."""
MOST_WEIGHT = 4.0
"""One picture may show its scene to be so many times as slow, or fast, as was thought."""


class Chooser:
    """Draws and traces with one context, by what is known of it: measured when it is first needed. `watch` has seen
    this process at work: how busy the machine is."""

    def __init__(self, context: Context, renderer: Renderer, tracer: Tracer, use_cache: bool = True,
                 watch: Stopwatch | None = None) -> None:
        self._context, self._renderer, self._tracer, self._use_cache = context, renderer, tracer, use_cache
        self._watch = watch or Stopwatch()
        self._calibration: Calibration | None = None
        self._known: frozenset[str] | None = None
        self._compiled: frozenset[str] = frozenset()
        self._scene: tuple[Scene, str, Load] | None = None
        self._ready = Ready()

    def calibrate(self, say: Callable[[str], None] = lambda _: None) -> Calibration:
        """What is known of the device; told by `say` when it has to be measured, which takes some ten seconds."""
        if self._calibration is None and self._use_cache:
            self._calibration = load_calibration(self._context.renderer)
        if self._calibration is None:
            from .start import measure

            say(f"measuring how fast {self._context.renderer} is{', once' if self._use_cache else ''}")
            self._calibration = measure(self._context)
            self._context.make_current()
            if self._use_cache:
                store_calibration(self._context.renderer, self._calibration)
        return self._calibration

    def make(self, scene: Scene, camera: Camera, settings: Settings, size: tuple[int, int],
             layers: Collection[str] = (), report: Report | None = None,
             wants_to_stop: Callable[[], bool] = lambda: False) -> tuple[Image, Choice]:
        """The picture, and how it came about. `settings.mode` does not count; its time budget begins with this call,
        unless the device has to be measured first.

        Raises UsageError where nothing can be chosen from, and what the ways of making pictures raise.
        """
        calibration = self.calibrate()
        started = time.perf_counter()
        ready = self._ready_for(scene)
        found = self.weigh(scene, settings, size, layers)
        budget, target = settings.time_budget, settings.error
        left = None if budget is None else max(budget - (time.perf_counter() - started), 0.0)
        choice = Choice(found, choose(found, left, target), budget, target)
        making = Making(self._renderer, self._tracer, calibration, View(scene, camera, size, layers), started, choice)
        path = next((one for one in found if isinstance(one, TracedCandidate)), None)
        course = best_course(found, left) if left is not None else None
        if target is not None and path is not None and path.fits(left):
            image = making.until_right(path, target, worth_trying(found, path, target), report, wants_to_stop)
        elif course is not None and target is None:
            image = making.along(course, report, wants_to_stop)
        elif isinstance(choice.taken, TracedCandidate):
            image = making.until_right(choice.taken, 0.0, (), report, wants_to_stop)
        else:
            image = making.drawn(choice.taken)
        choice.seconds = time.perf_counter() - started
        self._learn(scene, making, ready)
        return image, choice

    def weigh(self, scene: Scene, settings: Settings, size: tuple[int, int],
              layers: Collection[str] = ()) -> list[Candidate]:
        """What there is to choose from for such a picture, now."""
        self._names(scene)
        assert self._scene is not None
        load = replace(self._scene[2], pixels=size[0] * size[1])
        return candidates(self.calibrate(), load, scene, settings, self._ready_for(scene), needs_layers=bool(layers))

    def _ready_for(self, scene: Scene) -> Ready:
        """What need not be prepared for a picture of `scene`. The first time, it takes a program to find out."""
        calibration = self.calibrate()
        if self._known is None:
            from .start import first_program

            forgotten = calibration.is_forgotten(first_program(self._context))
            self._known = frozenset() if forgotten or not self._use_cache else load_known(self._context.renderer)
            pace = min(max(self._watch.slowdown, 1.0), MOST_PACE)
            self._ready = replace(self._ready, pace=pace)
        ready, name = self._ready, self._names(scene)
        if not self._renderer.holds(scene):
            ready = replace(ready, holds_raster=False, drawn=frozenset(), weight=1.0)
        if not self._tracer.holds(scene):
            ready = replace(ready, holds_path=False)
        return replace(ready, compiled=_titles(self._compiled, name), kept=_titles(self._known, name))

    def _names(self, scene: Scene) -> str:
        if self._scene is None or self._scene[0] is not scene:
            plan = plain_plan(scene)
            self._scene = scene, surfaces(plan), Load.of(scene, (0, 0), plan, self._use_cache)
        return self._scene[1]

    def _learn(self, scene: Scene, making: Making, before: Ready) -> None:
        drawn, traced = making.titles
        pace, weight = before.pace, before.weight
        if making.drawn_seconds is not None:
            expected, seen = making.drawn_seconds
            if drawn <= before.drawn:  # a picture and no preparing
                weight *= min(max(seen / making.slowdown / max(expected / pace, 1e-6), 1 / MOST_WEIGHT), MOST_WEIGHT)
            pace = math.sqrt(pace * min(max(making.slowdown, 1.0), MOST_PACE))
        self._ready = Ready(before.has_raster or bool(drawn), before.has_path or bool(traced), before.drawn | drawn,
                            self._renderer.holds(scene), self._tracer.holds(scene), pace=pace, weight=weight)
        names = frozenset(f"{self._names(scene)} {title}" for title in drawn | traced)
        self._compiled |= names
        if self._known is not None and not names <= self._known:
            self._known |= names
            if self._use_cache:
                store_known(self._context.renderer, self._known)


def _titles(names: frozenset[str], surfaces: str) -> frozenset[str]:
    """Of the methods that go with `surfaces`."""
    return frozenset(title for first, _, title in (name.partition(" ") for name in names) if first == surfaces)
