"""The picture makers of the command line: the raster, the path tracer, and the one that chooses between them."""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from ..base.progress import Progress
from ..base.signals import Stopped, postponed
from ..image.image import LINEAR_WRITABLE, Image
from ..scene.camera import Camera
from ..scene.scene import Scene
from ..settings import Settings
from .picture_maker import PictureMaker, RenderRequest

if TYPE_CHECKING:
    import numpy as np

    from ..raster.renderer import Renderer
    from ..scene.decoding import Decoder
    from ..trace.paths.part import Part


def make_picture_maker(request: RenderRequest) -> PictureMaker:
    if request.chooses:
        from .choosing_maker import ChoosingMaker

        return ChoosingMaker(request)
    if request.settings.mode != "path":
        return RasterMaker(request)
    return PathMaker(request)


class RasterMaker(PictureMaker):
    @property
    def has_renderer(self) -> bool:
        return self._renderer is not None

    def expect(self, ahead: Decoder) -> None:
        """Take a decoder that has begun with the images of the next scene. There has to be a renderer."""
        assert self._renderer is not None
        self._renderer.expect(ahead)

    def make(self, scene: Scene, camera: Camera, path: Path, progress: Progress) -> Image:
        """As `PictureMaker.make`."""
        from ..plan.legend import legend
        from ..raster.sampled_images import decode_ahead

        request = self._request
        settings = request.quality.applied(request.settings)
        if self._renderer is None:
            ahead = decode_ahead(scene, settings)  # other threads decode while this one imports and opens OpenGL
            from ..raster.renderer import Renderer

            self._renderer = Renderer(request.open(), use_cache=request.use_cache, measure=request.measure)
            self._renderer.expect(ahead)
        renderer = self._renderer
        renderer.times.clear()
        self.error = None
        is_linear = path.suffix.lower() in LINEAR_WRITABLE
        image = (renderer.render if is_linear else renderer.display)(scene, camera, settings, request.size)
        assert renderer.plan is not None
        if request.layers:
            image = add_layers(image, renderer, scene, camera, settings, request)
        plan: Any = image.stats.get("plan") or renderer.plan.to_json()
        told = request.quality.facts(settings)
        lines = legend(scene, camera, settings)
        self.summary = "; ".join([*lines, *(f"{name} {value}" for name, value in told.items()), renderer.summary])
        self.stats = {"prepare_s": dict(renderer.times), "pass_ms": dict(renderer.pass_ms),
                      "plan": told | plan, **({"legend": list(lines)} if lines else {}),
                      **renderer.caustic_stats()}
        self.texture_bytes = renderer.texture_bytes
        return image

    def tell_error(self, scene: Scene, camera: Camera, path: Path, progress: Progress) -> None:
        """Find out the `error` of the picture that was made last, which is in its file by now.

        The first signal to stop ends it, without a figure if it comes too early for one. Raises as `make`.
        """
        from ..estimate.measure import measure_error
        from ..trace.tracer import Tracer

        request, renderer, seconds = self._request, self._renderer, self._request.tell_error
        assert renderer is not None and seconds is not None
        if self._tracer is None:
            self._tracer = Tracer(request.open(), use_cache=request.use_cache)
        progress.part(0.0, f"{path.name}: tracing paths for its error, {seconds:g} s")
        with postponed() as stop_request:
            self.error = measure_error(self._tracer, renderer.read_radiance(), scene, camera, request.settings,
                                       request.size, seconds, lambda: stop_request.number is not None)
        self.stopped = stop_request.number
        if self.stopped is not None:
            when = "before its error was known" if self.error is None else "while its error was measured"
            self.summary = f"the picture, {when}"
        if self.error is not None:
            self.stats["estimated_error"] = self.error.to_json()


class PathMaker(PictureMaker):
    def __init__(self, request: RenderRequest) -> None:
        super().__init__(request)
        self.given: Sequence[Part] = ()
        """Samples that others have traced, which `make` takes instead of tracing them."""
        self.given_stopped: int | None = None
        """The number of the signal that ended these early."""

    def make(self, scene: Scene, camera: Camera, path: Path, progress: Progress) -> Image:
        """As `PictureMaker.make`. The first signal to stop ends the picture early, with the samples so far."""
        from ..estimate.layers import traced_layers
        from ..trace.ground import above_ground, with_ground
        from ..trace.paths.run import how_far, run
        from ..trace.tracer import Tracer

        request = self._request
        started = time.perf_counter()
        if self._tracer is None:
            self._tracer = Tracer(request.open(), use_cache=request.use_cache)
        layers = traced_layers(request.layers, scene, request.settings)
        path_render = self._tracer.begin(scene, camera, above_ground(request.settings), request.size, layers,
                                         guide=self._guide(scene, camera))
        prepared = time.perf_counter() - started

        def report(fraction: float, seconds_left: float) -> None:
            if progress.is_shown:
                state = f"{path_render.samples:.3g} spp, error {path_render.error:.2g}, {seconds_left:.0f} s left"
                progress.part(fraction, f"{path.name}: {state}")

        try:
            with postponed() as stop_request:
                if self.given:
                    path_render.take(self.given)
                else:
                    run(path_render, started, report, wants_to_stop=lambda: stop_request.number is not None)
            self.stopped = self.given_stopped if stop_request.number is None else stop_request.number
            if self.stopped is not None and not path_render.is_whole:
                raise Stopped(self.stopped)
            image = with_ground(self._tracer, path_render.image(), scene, camera, request.settings)
            if request.layers:
                image = add_layers(image, self._raster(), scene, camera, request.settings, request)
            self.stats = {"prepare_s": {"scene": prepared}, **image.stats, "stopped": self.stopped is not None}
            self.texture_bytes = self._tracer.texture_bytes
            rays, intersector = path_render.rays, path_render.plan.intersector
            self.summary = f"{how_far(path_render)}, {rays / 1e6:.3g} million rays by {intersector}"
        finally:
            path_render.release()
        return image

    def part(self, scene: Scene, camera: Camera, samples: range, wants_to_stop: Callable[[], bool]) -> Part | None:
        """These samples of each pixel of the picture, from which `make` makes it where they are `given`. A denoiser
        filters it then, which needs the layers of first hits. Once `wants_to_stop` is true, it is what there is; None
        if that is nothing. Raises as `make`, and Stopped."""
        from ..estimate.layers import traced_layers
        from ..trace.ground import above_ground
        from ..trace.paths.part import Part
        from ..trace.paths.run import run
        from ..trace.tracer import Tracer

        request = self._request
        if self._tracer is None:
            self._tracer = Tracer(request.open(), use_cache=request.use_cache)
        settings = replace(above_ground(request.settings), spp=len(samples), denoise="off")
        layers = traced_layers(request.layers, scene, settings)
        if request.settings.denoise != "off":
            layers = *layers, "albedo"
        path_render = self._tracer.begin(scene, camera, settings, request.size, layers, first=samples.start)
        try:
            run(path_render, time.perf_counter(), wants_to_stop=wants_to_stop)
            if path_render.samples == 0:
                return None
            return Part(path_render.film.read(), path_render.rays, path_render.seconds, path_render.bad_samples)
        finally:
            path_render.release()

    def _guide(self, scene: Scene, camera: Camera) -> np.ndarray | None:
        request = self._request
        if request.settings.denoise != "raster":
            return None
        from ..estimate.mixture import draw_guide

        return draw_guide(self._raster(), scene, camera, request.settings, request.size)

    def _raster(self) -> Renderer:
        from ..raster.renderer import Renderer

        if self._renderer is None:
            self._renderer = Renderer(self._request.open(), use_cache=self._request.use_cache)
        return self._renderer


def add_layers(image: Image, renderer: Renderer, scene: Scene, camera: Camera, settings: Settings,
               request: RenderRequest) -> Image:
    """The picture with the layers that are requested."""
    from ..estimate.layers import with_layers

    following = request.following(scene, camera) if request.following is not None else None
    return with_layers(image, renderer, scene, camera, settings, request.layers, following)
