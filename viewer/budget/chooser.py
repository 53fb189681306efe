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
from .choice import Choice, Ready, candidates, choose, stand_in, worth_trying
from .making import Making, View

MOST_PACE = 3.0
"""Other work on the device may slow it down so many times."""


class Chooser:
    """Draws and traces with one context, by what is known of it: measured when it is first needed."""

    def __init__(self, context: Context, renderer: Renderer, tracer: Tracer, use_cache: bool = True) -> None:
        self._context, self._renderer, self._tracer, self._use_cache = context, renderer, tracer, use_cache
        self._calibration: Calibration | None = None
        self.ready = Ready()

    def calibrate(self, say: Callable[[str], None] = lambda _: None) -> Calibration:
        """What is known of the device; told by `say` when it has to be measured, which takes some seconds."""
        if self._calibration is None and self._use_cache:
            self._calibration = load_calibration(self._context.renderer)
        if self._calibration is None:
            from .calibrate import calibrate
            from .start import measure_start

            say(f"measuring how fast {self._context.renderer} is{', once' if self._use_cache else ''}")
            self._calibration = calibrate(self._context, measure_start(self._context.backend))
            self.ready = replace(self.ready, has_raster=True, has_path=True)
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
        ready = self.ready
        if not self._renderer.holds(scene):
            ready = replace(ready, drawn=frozenset(), holds_raster=False)
        if not self._tracer.holds(scene):
            ready = replace(ready, traced=frozenset(), holds_path=False)
        found = candidates(calibration, scene, size, settings, ready, needs_layers=bool(layers))
        budget, target = settings.time_budget, settings.error
        choice = Choice(found, choose(found, budget, target), budget, target)
        making = Making(self._renderer, self._tracer, calibration, View(scene, camera, size, layers), started, choice)
        path = next((one for one in found if one.is_traced), None)
        if target is not None and path is not None and path.fits(budget):
            image = making.until_right(path, target, worth_trying(found, path, target), report, wants_to_stop)
        elif budget is not None and choice.taken.is_traced:
            rival = stand_in(found, budget, choice.taken)
            image = making.within(budget, choice.taken, rival, report, wants_to_stop)
        else:
            image = making.drawn(choice.taken)
        choice.seconds = time.perf_counter() - started
        drawn, traced = making.titles
        pace = _pace(ready.pace, choice) if not traced else ready.pace
        self.ready = Ready(ready.has_raster or bool(drawn), ready.has_path or bool(traced),
                            ready.drawn | drawn, ready.traced | traced,
                            self._renderer.holds(scene), self._tracer.holds(scene), pace)
        return image, choice


def _pace(before: float, choice: Choice) -> float:
    """Half way to what the last picture of the raster says, which took its own time."""
    seen = before * choice.seconds / max(choice.taken.seconds, 1e-6)
    return math.sqrt(before * min(max(seen, 1 / MOST_PACE), MOST_PACE))
