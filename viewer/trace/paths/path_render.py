"""One picture as it converges: waves of paths that take turns, so that one is shaded while another is traced."""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Collection
from dataclasses import dataclass
from typing import TYPE_CHECKING

import moderngl
import numpy as np

from ...image.display import DisplayPass
from ...image.image import Image
from ...settings import Settings
from ..layout import TILE
from ..plan import TracePlan
from ..rays.intersect import Answer, Intersector
from .film import Film, relative_error
from .layers import read_layers
from .schedule import Schedule
from .wavefront import Wave

if TYPE_CHECKING:
    from ..denoise.denoiser import Denoiser
    from .passes import Passes

SOFTWARE_SIDE, DEVICE_SIDE = 16, 32
"""Most blocks of a wave along each side, where a processor draws and elsewhere."""
DEVICE_LOOKS = 4
"""How often a graphics card shades a wave between two looks at which of its blocks are done: to look is to wait."""


@dataclass
class _Lane:
    """A wave, and what its rays met while it waits to be shaded."""

    wave: Wave
    answer: Answer | None = None
    shaded: int = 0

    @property
    def is_busy(self) -> bool:
        return bool(self.wave.is_busy.any())


class Exposure:
    """See `viewer.trace.tracer.Tracer.begin`, which makes them."""

    def __init__(self, passes: Passes, intersector: Intersector, plan: TracePlan, film: Film, schedule: Schedule,
                 settings: Settings, display: DisplayPass, layers: Collection[str],
                 denoiser: Denoiser | None) -> None:
        self.plan = plan
        self.film = film
        self.settings = settings
        self.rays = 0
        """Traced so far, shadow rays among them."""
        self.seconds = 0.0
        """Of work in `step`."""
        self._passes, self._intersector, self._schedule, self._display = passes, intersector, schedule, display
        self._expected = 0
        context = passes.context
        columns = SOFTWARE_SIDE if context.is_software else DEVICE_SIDE
        self._looks = 1 if context.is_software else DEVICE_LOOKS
        rows = min(math.ceil(math.prod(film.tiles) * settings.most_spp / columns / 2), columns)
        self._lanes = [_Lane(Wave(context.gl, columns, rows, plan.has_transmission, "layers" in plan.programs))
                       for _ in range(2)]
        self._flush: Callable[[], None] = context.function("glFlush")
        self._layers, self._denoiser = layers, denoiser
        self._is_developed = False
        self._shown: moderngl.Texture | None = None

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
        if first.shaded % self._looks == 0:
            self._refill(first.wave)
        rays = self._intersector.fetch(first.wave) if first.is_busy else None
        if second.answer is not None:
            self._intersector.store(second.wave, second.answer)
            second.answer = None
            self._passes.shade(second.wave)
            second.shaded += 1
            self._flush()
        if rays is not None:
            first.answer = self._intersector.trace(rays)
            self.rays += first.answer.rays or 0
        self._lanes = [second, first]

    def _refill(self, wave: Wave) -> None:
        """Take in what blocks have done, and give them new work, when some have."""
        if wave.is_busy.any():
            done = np.flatnonzero(wave.is_busy & ~self._passes.find_alive(wave))
            self._take_in(wave, done)
        if self._schedule.done:
            return
        free = np.flatnonzero(~wave.is_busy)
        if not len(free):
            return
        is_last = not any(lane.is_busy for lane in self._lanes)
        work = self._schedule.next(len(free), is_last)
        if work:
            blocks = free[: len(work)]
            wave.assign(blocks, work)
            self._passes.begin(wave, blocks)

    def _take_in(self, wave: Wave, blocks: np.ndarray) -> None:
        if not len(blocks):
            return
        self.film.add(wave, blocks)
        wave.is_busy[blocks] = False
        tiles, samples = wave.work[blocks, :2].astype(np.int64), wave.work[blocks, 3].astype(np.int64)
        inside = np.minimum(np.array(self.film.size) - TILE * tiles, TILE)
        self._expected += int((inside.prod(axis=1) * samples).sum())
        self._is_developed, self._shown = False, None

    @property
    def radiance(self) -> moderngl.Texture:
        """The mean so far, RGBA32F, row 0 at the bottom, associated alpha."""
        if not self._is_developed:
            self._passes.context.make_current()
            self.film.develop()
            self._is_developed = True
        return self.film.radiance

    @property
    def shown(self) -> moderngl.Texture:
        """`radiance`, denoised where the settings ask for that."""
        radiance = self.radiance
        if self._denoiser is None:
            return radiance
        if self._shown is None:
            self._shown = self._denoiser.filter(self.film)
        return self._shown

    def present(self, framebuffer: moderngl.Framebuffer) -> None:
        """Draw what there is into `framebuffer`, as displayed."""
        self._display.draw(self.shown, self.settings, framebuffer, 0)

    def image(self) -> Image:
        """What there is, as `viewer.raster.renderer.Renderer.render` gives it, with the layers asked for.

        Its `stats` tell how good it is, its `attributes` what was done to it.
        """
        width, height = self.film.size
        linear = np.frombuffer(self.shown.read(), np.float32).reshape(height, width, 4)[::-1].copy()
        if isinstance(self.settings.background, tuple):
            linear += (1 - linear[..., 3:]) * np.array([*self.settings.background, 1], np.float32)
        target = self._display.target((width, height))
        self.present(target)
        shown = np.frombuffer(target.read(components=4), np.uint8).reshape(height, width, 4)[::-1]
        return Image(linear, np.ascontiguousarray(shown), self.stats(), read_layers(self.film, self._layers),
                     self.attributes(self.settings.denoise))

    def stats(self) -> dict[str, object]:
        """How far the picture has come and what it took; JSON-able."""
        error = self.error
        return {
            "plan": self.plan.to_json(), "intersector": self.plan.intersector, "spp": self.samples,
            "samples": round(self.samples * self.film.size[0] * self.film.size[1]), "bad_samples": self.bad_samples,
            "estimated_error": error if np.isfinite(error) else None, "rays": self.rays, "trace_s": self.seconds,
            "rays_per_s": self.rays / self.seconds if self.seconds else None, "denoised": self.settings.denoise,
        }

    def attributes(self, denoised: str) -> dict[str, str]:
        """What a file has to say of the picture, `denoised` like that: what is not what the samples said."""
        settings = self.settings
        attributes = {"samples": f"{self.samples:g} a pixel"}
        if denoised != "off":
            attributes["denoised"] = denoised
        if settings.clamp > 0:
            attributes["clamped"] = f"indirect light to luminance {settings.clamp:g} (biased)"
        return attributes

    def release(self) -> None:
        self._passes.context.make_current()
        self._passes.context.gl.screen.use()  # moderngl goes back to the framebuffer last used, be it gone
        for lane in self._lanes:
            lane.wave.release()
        self.film.release()
