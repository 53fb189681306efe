"""The error of the picture in the window, measured by paths while it is at rest."""

from __future__ import annotations

import math
from collections.abc import Callable
from concurrent.futures import Future, ThreadPoolExecutor
from typing import TYPE_CHECKING

import moderngl
import numpy as np

from ..estimate.paths import PathGroups
from ..estimate.raster_error import RasterError, percent, raster_error, shown_map
from ..gpu.context import Context
from ..gpu.programs import Programs
from ..image.display import DisplayPass
from ..scene.camera import Camera
from ..scene.color import srgb_to_linear
from ..scene.scene import Scene
from ..settings import Settings
from .convergence import SLICE_SECONDS

if TYPE_CHECKING:
    from ..trace.tracer import Tracer

SURE = 1.05
"""Tracing ends when the upper end of the interval is this many times the lower one."""
MOST_SAMPLES = 4096
_UNIT = 0


class RestError:
    """Measures the error of one picture of the raster after the other, in slices of time.

    `begin` takes a picture and `step` goes on; what follows from the paths is worked out on another thread, so that no
    input waits for it. `map` is where the picture is wrong, as a texture, None before there is an estimate. `tracer`
    makes the path tracer, or returns it.
    """

    def __init__(self, context: Context, programs: Programs, tracer: Callable[[], Tracer]) -> None:
        self.error: RasterError | None = None
        self._context, self._tracer = context, tracer
        self._display = DisplayPass(context.gl, programs)
        self._paths: PathGroups | None = None
        self._raster = np.zeros((0, 0, 4), np.float32)
        self._worker = ThreadPoolExecutor(1, "error")
        self._future: Future[RasterError] | None = None
        self._told_of = 0.0
        self._map: moderngl.Texture | None = None

    @property
    def is_begun(self) -> bool:
        return self._paths is not None

    @property
    def is_done(self) -> bool:
        """Whether it is as sure as it gets."""
        return self.error is not None and (self.error.samples >= MOST_SAMPLES or (
            self.error.low > 0 and math.sqrt(self.error.high / self.error.low) < SURE))

    def begin(self, raster: np.ndarray, scene: Scene, camera: Camera, settings: Settings,
              size: tuple[int, int]) -> None:
        """Begin with a picture of `size`, linear radiance (H, W, 4) without a colour laid behind it. Raises as
        `Tracer.begin`."""
        self.discard()
        self._paths = PathGroups.of_raster(self._tracer(), scene, camera, settings, size)
        self._raster = self._paths.of(raster)

    def step(self) -> bool:
        """Trace for about SLICE_SECONDS. Returns whether there is something new to show."""
        paths = self._paths
        if paths is None:
            return False
        if self._future is not None and self._future.done():
            self.error, self._future = self._future.result(), None
            self._show(paths.spread(self.error.map))
            return True
        if not self.is_done:
            paths.step(SLICE_SECONDS)
            if self._future is None and paths.is_enough and paths.samples >= max(1.25 * self._told_of, 1):
                self._told_of = paths.samples
                self._future = self._worker.submit(raster_error, self._raster, paths.groups, paths.shows_model,
                                                   paths.samples, paths.seconds, (), 1 - 1 / paths.every**2)
        return False

    def status(self) -> str:
        """The error in one line for the user; empty if none is measured."""
        if self._paths is None:
            return ""
        if self.error is None:
            return "Tracing paths to tell the error …"
        return (f"{percent(self.error.relative)} % from the truth ({self.error.interval}), "
                f"{self.error.samples:.0f} samples a pixel")

    def present(self, framebuffer: moderngl.Framebuffer) -> None:
        """Draw the map of the error into `framebuffer`."""
        assert self._map is not None
        self._display.draw(self._map, Settings(tonemap="none"), framebuffer, _UNIT)

    @property
    def has_map(self) -> bool:
        return self._map is not None

    def _show(self, error: np.ndarray) -> None:
        """Make the map a texture of linear colours, which the display pass shows as they were."""
        shown = shown_map(error).srgb / np.float32(255)
        pixels = np.concatenate([srgb_to_linear(shown[..., :3]), shown[..., 3:]], axis=-1)[::-1]
        self._context.make_current()
        if self._map is not None:
            self._map.release()
        self._map = self._context.gl.texture(error.shape[::-1], 4, np.ascontiguousarray(pixels, np.float32), dtype="f4")

    def discard(self) -> None:
        """Forget the picture, for another has taken its place."""
        if self._paths is not None:
            self._paths.release()
        if self._map is not None:
            self._map.release()
        self._paths = self._map = self.error = self._future = None
        self._told_of = 0.0

    def release(self) -> None:
        self.discard()
        self._worker.shutdown(cancel_futures=True)
        self._display.release()
