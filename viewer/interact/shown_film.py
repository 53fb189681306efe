"""What is shown of a path-traced picture while it converges: its samples, or what denoising makes of them."""

from __future__ import annotations

import math
import time
from collections.abc import Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING

import moderngl
import numpy as np

from ..gpu.context import Context

if TYPE_CHECKING:
    from ..trace.denoise.fast import Combining
    from ..trace.paths.path_render import PathRender

UPDATE_FRACTION = 0.2
"""The most of the time that is used for updates: estimating the error and showing the picture; and as much for
denoising it."""
UPDATE_SECONDS = 0.1, 2.0
"""The time between two updates: at first, and later, when the picture hardly changes any more."""
CONVERGED = 0.01
"""Below this relative error the samples are shown without denoising, since the noise is no longer visible."""


@dataclass(frozen=True)
class Progress:
    """The state at the last update: mean samples per pixel, seconds of work, rays, estimated relative error."""

    samples: float
    seconds: float
    rays: int
    error: float

    def __str__(self) -> str:
        parts = [f"{_short(self.samples)} samples a pixel", f"{self.seconds:.0f} s"]
        if math.isfinite(self.error):
            parts.append(f"error {_short(100 * self.error)} %")
        if self.rays:
            parts.append(f"{_short(self.rays / self.seconds / 1e6)} million rays/s")
        return ", ".join(parts)


class ShownFilm:
    """What is shown of `render`, whose `guide` is that of `Tracer.begin`.

    `picture` (RGBA32F, associated alpha) is None until every pixel has a sample; to be mixed with the raster's, two.
    `denoised` is what it is denoised by, and `progress` is that of the last update.
    """

    def __init__(self, context: Context, render: PathRender, combining: Combining, guide: np.ndarray | None) -> None:
        self.render = render
        self.picture: moderngl.Texture | None = None
        self.denoised = "off"
        self.progress: Progress | None = None
        self._context, self._combining, self._guide = context, combining, guide
        self._filter: Iterator[None] | None = None
        self._shown_of: tuple[float, str] = 0.0, ""
        """The seconds of tracing that are in `picture`, and the denoiser that was asked for."""
        self._update_at = self._filter_at = 0.0
        self._filter_cost = 0.0

    @property
    def is_filtering(self) -> bool:
        """Whether a denoising filter has begun, which `filter` continues."""
        return self._filter is not None

    def is_due(self, denoise: str, rests: bool) -> bool:
        """Whether it is time for an update, or the picture has to be made now, whatever that costs: the render `rests`,
        or another denoiser is asked for."""
        return self.render.seconds >= self._update_at or self._lacks_picture(denoise, rests)

    def _lacks_picture(self, denoise: str, rests: bool) -> bool:
        wanted = self.render.seconds, denoise
        return wanted != self._shown_of and (rests or denoise != self._shown_of[1])

    def update(self, denoise: str, rests: bool, is_done: bool) -> bool:
        """Estimate the error, and show the picture if every pixel has a sample. Returns whether there is a new one, or
        new words for the status. Denoising takes long where the CPU draws, so the words do not wait for it."""
        from ..trace.paths.film import relative_error

        render = self.render
        start, is_due = time.perf_counter(), self._lacks_picture(denoise, rests)
        tiles = render.film.tile_errors()
        cost = time.perf_counter() - start
        is_whole = is_done or bool((tiles[..., 2] >= tiles[..., 3]).all())
        if is_whole:
            samples = float(tiles[..., 2].sum(dtype=float) / tiles[..., 3].sum(dtype=float))
            self.progress = Progress(samples, render.seconds, render.rays, relative_error(tiles))
            radiance = render.radiance
            if denoise == "off" or self.progress.error <= CONVERGED:
                self.picture, self.denoised = radiance, "off"
                self._shown_of = render.seconds, denoise
            elif denoise == "raster" and not (render.film.is_split or render.is_done):
                self._shown_of = render.seconds, denoise  # the raster's picture is better
            elif is_due or render.seconds >= self._filter_at:
                guide = None if denoise == "fast" else self._guide
                self._filter, self._filter_cost = self._combining.steps(render.film, guide), 0.0
                self._shown_of = render.seconds, denoise
        first, last = UPDATE_SECONDS
        pause = max(first, min(render.seconds / 20, last), cost * (1 / UPDATE_FRACTION - 1))
        self._update_at = render.seconds + pause
        return self._filter is None and is_whole

    def filter(self, seconds: float) -> bool:
        """Run passes of the denoising filter for about this time. Returns whether it is finished."""
        assert self._filter is not None
        start = time.perf_counter()
        while time.perf_counter() - start < seconds:
            if next(self._filter, "end") == "end":
                self._filter, self.picture = None, self._combining.result
                self.denoised = "fast" if self._shown_of[1] == "fast" else self.render.denoised
                break
            self._context.gl.finish()  # otherwise all passes would be queued at once on a slow device
        self._filter_cost += time.perf_counter() - start
        self._filter_at = self.render.seconds + self._filter_cost * (1 / UPDATE_FRACTION - 1)
        return self._filter is None


def _short(number: float) -> str:
    """The number with two significant digits, or all digits before the point."""
    return f"{number:.2g}" if number < 10 else f"{number:.0f}"
