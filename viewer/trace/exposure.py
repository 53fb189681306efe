"""One picture as it converges: waves of paths that take turns, so that one is shaded while another is traced."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING

import moderngl
import numpy as np

from ..image import Image
from ..raster.display import DisplayPass
from ..settings import Settings
from .film import Film, relative_error
from .intersect import Answer, Intersector
from .plan import TracePlan
from .schedule import Schedule
from .wave import TILE, Wave, Work

if TYPE_CHECKING:
    from .passes import Passes

WAVE_COLUMNS = 16
MAX_WAVE_ROWS = 16


@dataclass
class _Lane:
    """A wave, what its rays met while it waits to be shaded, and how many of its samples are done."""

    wave: Wave
    query: moderngl.Query
    answer: Answer | None = None
    expected: int = 0
    finished: int = 0
    is_counting: bool = False

    @property
    def is_busy(self) -> bool:
        return self.expected > 0


class Exposure:
    """See `viewer.trace.tracer.Tracer.begin`, which makes them."""

    def __init__(self, passes: Passes, intersector: Intersector, plan: TracePlan, film: Film, schedule: Schedule,
                 settings: Settings, display: DisplayPass, rows: int) -> None:
        self.plan = plan
        self.film = film
        self.settings = settings
        self.rays = 0
        """Traced so far, shadow rays among them."""
        self.seconds = 0.0
        """Of work in `step`."""
        self._passes, self._intersector, self._schedule, self._display = passes, intersector, schedule, display
        self._expected = 0
        gl = passes.context.gl
        self._lanes = [_Lane(Wave(gl, WAVE_COLUMNS, rows, "layers" in plan.programs), gl.query(samples=True))
                       for _ in range(2)]
        self._flush: Callable[[], None] = passes.context.function("glFlush")
        self._is_developed = False

    @property
    def is_done(self) -> bool:
        """Whether all samples that were asked for are in the film."""
        return self._schedule.done and not any(lane.is_busy for lane in self._lanes)

    @property
    def samples(self) -> float:
        """Mean samples a pixel in the film."""
        tiles = self.film.tile_errors().astype(np.float64)
        return float(tiles[..., 2].sum() / tiles[..., 3].sum())

    @property
    def error(self) -> float:
        """The estimated relative error, `viewer.trace.film.relative_error`."""
        return relative_error(self.film.tile_errors())

    @property
    def bad_samples(self) -> int:
        """Samples in the film's pixels that were not finite and are left out."""
        return self._expected - round(float(self.film.tile_errors()[..., 2].sum(dtype=np.float64)))

    def step(self, seconds: float) -> None:
        """Go on for about so long, and a slice of work at least; each is well under 0.1 s where a GPU draws."""
        start = time.perf_counter()
        self._passes.context.make_current()
        while not self.is_done:
            self._slice()
            if time.perf_counter() - start >= seconds:
                break
        self.seconds += time.perf_counter() - start

    def _slice(self) -> None:
        """The first wave's rays are traced while the second is shaded; then they change places.

        All that is read from the device is read before the shading is handed to it, for a read waits for all of that.
        """
        first, second = self._lanes
        rays = None
        if first.is_busy:
            rays = self._intersector.fetch(first.wave)
            self._count(first)
            if first.finished == first.expected:
                self._take_in(first)
                rays = None
        if not first.is_busy and not self._schedule.done:
            self._begin(first)
            if first.is_busy:
                rays = self._intersector.fetch(first.wave)
        if second.answer is not None:
            self._intersector.store(second.wave, second.answer)
            second.answer = None
            self._passes.shade(second.wave, second.query)
            second.is_counting = True
            self._flush()
        if rays is not None:
            first.answer = self._intersector.trace(rays)
            self.rays += first.answer.rays or 0
        self._lanes = [second, first]

    def _count(self, lane: _Lane) -> None:
        if lane.is_counting:
            lane.finished += lane.query.samples
            lane.is_counting = False

    def _begin(self, lane: _Lane) -> None:
        wave = lane.wave
        work = self._schedule.next(wave.columns * wave.rows, is_last=not any(lane.is_busy for lane in self._lanes))
        lane.expected, lane.finished = sum(self._pixels(item) * item.samples for item in work), 0
        if work:
            wave.begin(work)
            self._passes.begin(wave)

    def _pixels(self, work: Work) -> int:
        """Of the picture in a tile."""
        width, height = (min(TILE, size - TILE * tile) for size, tile in zip(self.film.size, work[:2], strict=False))
        return width * height

    def _take_in(self, lane: _Lane) -> None:
        self.film.add(lane.wave)
        self._expected += lane.expected
        self._is_developed = False
        lane.expected = 0

    @property
    def radiance(self) -> moderngl.Texture:
        """The mean so far, RGBA32F, row 0 at the bottom, associated alpha."""
        if not self._is_developed:
            self._passes.context.make_current()
            self.film.develop()
            self._is_developed = True
        return self.film.radiance

    def present(self, framebuffer: moderngl.Framebuffer) -> None:
        """Draw what there is into `framebuffer`, as displayed."""
        self._display.draw(self.radiance, self.settings, framebuffer, 0)

    def image(self) -> Image:
        """What there is, as `viewer.raster.renderer.Renderer.render` gives it."""
        radiance = self.radiance
        linear = self.film.read_radiance()
        if isinstance(self.settings.background, tuple):
            linear += (1 - linear[..., 3:]) * np.float32([*self.settings.background, 1])
        target = self._display.target(radiance.size)
        self.present(target)
        width, height = radiance.size
        shown = np.frombuffer(target.read(components=4), np.uint8).reshape(height, width, 4)[::-1]
        return Image(linear, np.ascontiguousarray(shown), {"plan": self.plan.to_json()})

    def release(self) -> None:
        self._passes.context.make_current()
        for lane in self._lanes:
            lane.wave.release()
        self.film.release()
