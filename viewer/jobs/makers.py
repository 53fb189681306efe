"""The ways a `RenderJob` makes its pictures, each with what it keeps from one model to the next."""

from __future__ import annotations

import time
from abc import ABC, abstractmethod
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Protocol

from ..base.progress import Progress
from ..base.signals import Stopped, Wish, postponed
from ..image.image import Image
from ..scene.camera import Camera
from ..scene.scene import Scene
from ..settings import Settings

if TYPE_CHECKING:
    from ..gpu.context import Context
    from ..raster.renderer import Renderer
    from ..trace.tracer import Tracer


@dataclass
class Order:
    """What the pictures have in common; `open` opens the context, once."""

    open: Opener
    settings: Settings
    size: tuple[int, int]
    layers: Sequence[str]
    use_cache: bool
    measure: bool
    quiet: bool = True
    chooses: bool = False
    """The method is chosen for each picture, by its time budget or error; `settings.mode` does not count."""


class Opener(Protocol):
    def __call__(self) -> Context: ...


class Studio(ABC):
    """Makes pictures with one OpenGL context, opened with the first."""

    def __init__(self, order: Order) -> None:
        self._order = order
        self.facts: dict[str, object] = {}
        """Of the last picture: what `--stats` tells of it."""
        self.told = ""
        """Of the last picture: what `-v` tells of it, in a line."""
        self.texture_bytes = 0
        """About what the scene's textures take on the GPU."""
        self.stopped: int | None = None
        """The number of the signal by which somebody stopped the last picture, which is what there was by then."""

    @abstractmethod
    def make(self, scene: Scene, camera: Camera, path: Path, progress: Progress) -> Image:
        """The picture that goes to `path`. `progress` has been told of the model.

        Raises ContextError, InputError, UsageError.
        """


def make_studio(order: Order) -> Studio:
    if order.chooses:
        from ..budget.studio import ChoosingStudio

        return ChoosingStudio(order)
    return PathStudio(order) if order.settings.mode == "path" else RasterStudio(order)


class RasterStudio(Studio):
    def __init__(self, order: Order) -> None:
        super().__init__(order)
        self._renderer: Renderer | None = None

    def make(self, scene: Scene, camera: Camera, path: Path, progress: Progress) -> Image:
        """As `Studio.make`."""
        from ..raster.decoding import decode_ahead
        from ..raster.renderer import Renderer

        order = self._order
        ahead = decode_ahead(scene, order.settings)  # the processor has other things to do in the meantime
        if self._renderer is None:
            self._renderer = Renderer(order.open(), use_cache=order.use_cache, measure=order.measure)
        renderer = self._renderer
        renderer.expect(ahead)
        renderer.times.clear()
        renderer.pass_ms.clear()
        is_linear = path.suffix.lower() == ".exr"
        image = (renderer.render if is_linear else renderer.display)(scene, camera, order.settings, order.size)
        assert renderer.plan is not None
        self.told = "preparing: " + ", ".join(f"{name} {value:.3f} s" for name, value in renderer.times.items())
        self.facts = {"prepare_s": dict(renderer.times), "pass_ms": dict(renderer.pass_ms),
                      "plan": renderer.plan.to_json()}
        self.texture_bytes = renderer.texture_bytes
        return image


class PathStudio(Studio):
    def __init__(self, order: Order) -> None:
        super().__init__(order)
        self._tracer: Tracer | None = None

    def make(self, scene: Scene, camera: Camera, path: Path, progress: Progress) -> Image:
        """As `Studio.make`. A first signal to stop ends it with the picture as it is by then."""
        from ..trace.paths.run import how_far, run
        from ..trace.tracer import Tracer

        order = self._order
        started = time.perf_counter()
        if self._tracer is None:
            self._tracer = Tracer(order.open(), use_cache=order.use_cache)
        exposure = self._tracer.begin(scene, camera, order.settings, order.size, order.layers)
        prepared = time.perf_counter() - started

        def report(fraction: float, seconds_left: float) -> None:
            if progress.is_shown:
                words = f"{exposure.samples:.3g} spp, error {exposure.error:.2g}, {seconds_left:.0f} s left"
                progress.part(fraction, f"{path.name}: {words}")

        try:
            with postponed() as wish:
                run(exposure, started, report, wants_to_stop=lambda: wish.number is not None)
            self.stopped = _answered(wish, exposure.samples)
            image = exposure.image()
            self.facts = {"prepare_s": {"scene": prepared}, **image.stats, "stopped": self.stopped is not None}
            self.texture_bytes = self._tracer.texture_bytes
            self.told = f"{how_far(exposure)}, {exposure.rays / 1e6:.3g} million rays by {exposure.plan.intersector}"
        finally:
            exposure.release()
        return image


def _answered(wish: Wish, samples: float) -> int | None:
    """The signal that stopped a picture; raises Stopped where there is no picture yet."""
    if wish.number is not None and samples == 0:
        raise Stopped(wish.number)
    return wish.number
