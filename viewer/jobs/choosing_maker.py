"""The picture maker of pictures with a time budget or an error to reach."""

from __future__ import annotations

from pathlib import Path

from ..base.progress import Progress
from ..base.signals import Stopped, postponed
from ..budget.chooser import Chooser
from ..image.image import Image
from ..raster.renderer import Renderer
from ..scene.camera import Camera
from ..scene.scene import Scene
from ..trace.tracer import Tracer
from .picture_maker import PictureMaker, RenderRequest


class ChoosingMaker(PictureMaker):
    def __init__(self, request: RenderRequest) -> None:
        super().__init__(request)
        self._chooser: Chooser | None = None

    def make(self, scene: Scene, camera: Camera, path: Path, progress: Progress) -> Image:
        """As `PictureMaker.make`. The choice is printed.

        The time budget starts after the device has been opened.
        """
        request = self._request
        if self._chooser is None:
            context = request.open()
            self._renderer = Renderer(context, request.use_cache, request.measure)
            self._tracer = Tracer(context, request.use_cache)
            self._chooser = Chooser(context, self._renderer, self._tracer)

        def report(fraction: float, seconds_left: float) -> None:
            progress.part(fraction, f"{path.name}: {seconds_left:.0f} s left")

        renderer, tracer = self._renderer, self._tracer
        assert renderer is not None and tracer is not None
        renderer.times.clear()
        with postponed() as stop_request:
            following = request.following(scene, camera) if request.following is not None else None
            image, choice = self._chooser.make(scene, camera, request.settings, request.size, request.layers, report,
                                               lambda: stop_request.number is not None, following)
        self.stopped = stop_request.number
        if self.stopped is not None and choice.samples == 0:
            raise Stopped(self.stopped)
        if self.stopped is None and not request.quiet:  # a stopped one has a message, which includes the choice
            request.tell(f"{path}: {choice}")
        self.summary = str(choice)
        self.stats = {"choice": choice.to_json(), "prepare_s": dict(renderer.times),
                      "pass_ms": dict(renderer.pass_ms), **image.stats, "stopped": self.stopped is not None}
        self.texture_bytes = max(renderer.texture_bytes, tracer.texture_bytes)
        return image
