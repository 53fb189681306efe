"""Makes the best picture in a time, or one of a given error in little time."""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Collection
from dataclasses import replace

from ..estimate.layers import traced_layers, with_layers
from ..gpu.context import Context
from ..image.image import Image
from ..raster.layers import Following
from ..raster.renderer import Renderer
from ..scene.camera import Camera
from ..scene.scene import Scene
from ..settings import Settings
from ..trace.paths.run import Report, run
from ..trace.tracer import Tracer
from .choice import Choice
from .making import Making
from .pace import Pace

FILTERING = 0.1
"""Of a time budget: what is left for a filter that the user has asked for."""


class Chooser:
    """Draws and traces with one context, and remembers how long what it did took."""

    def __init__(self, context: Context, renderer: Renderer, tracer: Tracer,
                 clock: Callable[[], float] = time.perf_counter) -> None:
        self._context, self._renderer, self._tracer, self._clock = context, renderer, tracer, clock
        self._pace = Pace()

    def make(self, scene: Scene, camera: Camera, settings: Settings, size: tuple[int, int],
             layers: Collection[str] = (), report: Report | None = None,
             wants_to_stop: Callable[[], bool] = lambda: False,
             following: Following | None = None) -> tuple[Image, Choice]:
        """The picture, and how it came about. `settings.mode` does not count; the time budget begins with this call.

        With `layers` it is path traced. `following` is that of `viewer.estimate.layers.with_layers`.

        The first time `wants_to_stop` is true, what there is becomes the picture. Raises UsageError where nothing can
        be chosen from, and as `Renderer.draw` and `Tracer.begin`.
        """
        started = self._clock()
        raster, traced = settings.check_open()
        choice = Choice(settings.time_budget, settings.error)
        if raster is None or layers:
            traced = traced or replace(settings, mode="path")
            image = self._traced(scene, camera, traced, size, layers, choice, started, report, wants_to_stop)
            if layers:
                image = with_layers(image, self._renderer, scene, camera, traced, layers, following)
        else:
            making = Making(self._renderer, self._tracer, self._pace, choice, scene, camera, size, self._clock,
                            started, report, wants_to_stop)
            image = making.image(raster, traced)
        choice.seconds = self._clock() - started
        return image, choice

    def _traced(self, scene: Scene, camera: Camera, settings: Settings, size: tuple[int, int],
                layers: Collection[str], choice: Choice, started: float, report: Report | None,
                wants_to_stop: Callable[[], bool]) -> Image:
        """Where the settings leave mode path alone."""
        path_render = self._tracer.begin(scene, camera, settings, size, traced_layers(layers, scene, settings))
        try:
            is_filtered = settings.denoise != "off"
            run(path_render, started, report, wants_to_stop, FILTERING * (settings.time_budget or 0) * is_filtered)
            choice.method = f"path traced, denoised ({settings.denoise})" if is_filtered else "path traced"
            choice.samples = path_render.samples
            choice.error = None if is_filtered or math.isinf(path_render.error) else path_render.error
            return path_render.image()
        finally:
            path_render.release()
