"""Makes pictures by the method that suits the time there is, or the error they may have."""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Collection
from dataclasses import replace

from ..gpu.context import Context
from ..image.image import Image
from ..plan.media import has_media
from ..raster.renderer import Renderer
from ..scene.camera import Camera
from ..scene.scene import Scene
from ..settings import Settings
from ..trace.paths.run import Report
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
LEAST_NOVELTY = 0.1
WORTH = 0.9
"""Of the error expected of a picture that is there: what is not expected to be so much better is not begun."""
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
        choice = Choice(found, choose(found, left, target), budget, target, has_media=has_media(scene, settings))
        making = Making(self._renderer, self._tracer, calibration, View(scene, camera, size, layers), started, choice)
        path = next((one for one in found if isinstance(one, TracedCandidate)), None)
        course = best_course(found, left) if left is not None else None
        if target is not None and path is not None and path.fits(left):
            image = making.until_right(path, target, worth_trying(found, path, target), report, wants_to_stop)
        elif course is not None and target is None:
            image = making.along(course, report, wants_to_stop)
            while budget is not None and choice.is_drawn and not wants_to_stop():  # what took less than was thought
                self._learn(scene, settings, size, making, ready)
                ready = self._ready_for(scene)
                choice.found, left = self.weigh(scene, settings, size), budget - (time.perf_counter() - started)
                course = best_course(choice.found, left, choice.taken)
                if course is None or course.error > WORTH * choice.taken.error:
                    break
                image = making.along(course, report, wants_to_stop, image)
        elif isinstance(choice.taken, TracedCandidate):
            image = making.until_right(choice.taken, 0.0, (), report, wants_to_stop)
        else:
            image = making.drawn(choice.taken)
        choice.seconds = time.perf_counter() - started
        self._learn(scene, settings, size, making, ready)
        self._remember()
        return image, choice

    def weigh(self, scene: Scene, settings: Settings, size: tuple[int, int],
              layers: Collection[str] = (), ready: Ready | None = None) -> list[Candidate]:
        """What there is to choose from for such a picture, now, or when so much is `ready`."""
        self._names(scene)
        assert self._scene is not None
        load = replace(self._scene[2], pixels=size[0] * size[1])
        return candidates(self.calibrate(), load, scene, settings, ready or self._ready_for(scene), bool(layers))

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
            ready = replace(ready, holds_raster=False, drawn=frozenset(), weight=1.0, novelty=1.0)
        if not self._tracer.holds(scene):
            ready = replace(ready, holds_path=False)
        return replace(ready, compiled=_titles(self._compiled, name), kept=_titles(self._known, name))

    def _names(self, scene: Scene) -> str:
        if self._scene is None or self._scene[0] is not scene:
            plan = plain_plan(scene)
            self._scene = scene, surfaces(plan), Load.of(scene, (0, 0), plan, self._use_cache)
        return self._scene[1]

    def _learn(self, scene: Scene, settings: Settings, size: tuple[int, int], making: Making, before: Ready) -> None:
        """From what was made when so much was ready as `before` says."""
        drawn, traced = making.titles
        now = replace(before, has_raster=before.has_raster or bool(drawn), has_path=before.has_path or bool(traced),
                      drawn=before.drawn | drawn, holds_raster=self._renderer.holds(scene),
                      holds_path=self._tracer.holds(scene))
        if making.drawing is not None:
            title, slowdown = making.drawing.candidate.title, max(making.drawing.slowdown, 1.0)
            seen = making.drawing.seconds / slowdown

            def expected(kept: frozenset[str]) -> float:
                ready = replace(before, pace=1.0, novelty=1.0, kept=kept)
                return next(one.seconds for one in self.weigh(scene, settings, size, ready=ready) if one.title == title)

            least, most = expected(before.kept | {title}), expected(before.kept - {title})
            if title in before.drawn:  # a picture and no preparing
                weight = before.weight * min(max(seen / max(least, 1e-6), 1 / MOST_WEIGHT), MOST_WEIGHT)
                now = replace(now, weight=weight)
            elif title not in before.compiled | before.kept and most > least:
                now = replace(now, novelty=min(max((seen - least) / (most - least), LEAST_NOVELTY), 1.0))
            now = replace(now, pace=math.sqrt(before.pace * min(slowdown, MOST_PACE)))
            making.drawing = None
        self._ready = now
        self._compiled |= frozenset(f"{self._names(scene)} {title}" for title in drawn | traced)

    def _remember(self) -> None:
        """What the driver keeps from now on."""
        if self._known is not None and not self._compiled <= self._known:
            self._known |= self._compiled
            if self._use_cache:
                store_known(self._context.renderer, self._known)


def _titles(names: frozenset[str], surfaces: str) -> frozenset[str]:
    """Of the methods that go with `surfaces`."""
    return frozenset(title for first, _, title in (name.partition(" ") for name in names) if first == surfaces)
