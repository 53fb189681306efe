"""A progressive render: one path-traced picture while it converges.

Two wavefronts of paths take turns, so that one is shaded while the other is traced.
"""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Collection, Sequence
from typing import TYPE_CHECKING

import moderngl
import numpy as np

from ...image.display import DisplayPass
from ...image.estimated_error import estimated_error
from ...image.image import Image
from ...settings import Settings
from ..layout import TILE
from ..plan import TracePlan
from ..rays.intersect import Intersector
from .film import Film, relative_error
from .layers import read_layers
from .part import Part
from .photon_render import PhotonRender
from .schedule import Schedule
from .sky import Sky
from .traced_wavefront import TracedWavefront, take_turn
from .wavefront import Wavefront, Work
from .wavefront_maker import WavefrontMaker

if TYPE_CHECKING:
    from ..denoise.denoiser import Denoiser
    from .passes import Passes
    from .photon_passes import PhotonPasses


REFILLS = 16
"""Most times that the schedule is asked for work at once, since much of it may be tiles that are not traced."""
LAST_INTERVAL = 16
"""Iterations of a wavefront, once all work was handed out, after which blocks that are done are added to the film."""


class PathRender:
    """A picture in progress, made by `viewer.trace.tracer.Tracer.begin`. `step` traces more samples."""

    def __init__(self, passes: Passes, intersector: Intersector, plan: TracePlan, film: Film, schedule: Schedule,
                 settings: Settings, display: DisplayPass, layers: Collection[str],
                 denoiser: Denoiser | None, photon_passes: PhotonPasses | None, guide: np.ndarray | None,
                 sky: Sky | None, is_interactive: bool, first: int) -> None:
        self.plan = plan
        self.film = film
        self.settings = settings
        self.rays = 0
        """Number of rays traced so far, including shadow rays."""
        self.seconds = 0.0
        """Time spent in `step`."""
        self._passes, self._intersector, self._schedule, self._display = passes, intersector, schedule, display
        self._expected_samples = 0
        context = passes.context
        maker = WavefrontMaker(context, plan, math.prod(film.tiles) * settings.most_spp, is_interactive)
        self._check_interval = maker.check_interval
        self._wavefronts = [TracedWavefront(maker.make("layers" in plan.programs, is_sorted=plan.is_sorted,
                                                         chooses=plan.chooses_pixels,
                                                         covered=None if sky is None else sky.covered))
                            for _ in range(2)]
        self._photons: PhotonRender | None = None
        if photon_passes is not None and film.photon_sums is not None:
            self._photons = PhotonRender(photon_passes, intersector, film.photon_sums, maker, first)
        self._last_interval = LAST_INTERVAL if self._photons is None else 1  # photons keep pace with the film
        self._flush: Callable[[], None] = context.function("glFlush")
        self._finish: Callable[[], None] = context.function("glFinish")
        self._sky = sky
        if sky is not None:
            passes.draw_sky(sky)
        self._layers, self._denoiser, self._guide = layers, denoiser, guide
        self._is_developed = False
        self._shown: moderngl.Texture | None = None

    @property
    def is_done(self) -> bool:
        """Whether the film has all the samples that were asked for."""
        return self._has_samples and not self._lacks_photons

    @property
    def is_whole(self) -> bool:
        """Whether every pixel has a sample, and the film photons if there are any."""
        return bool(self.film.tile_errors()[..., 2].min() > 0) and (self._photons is None or self.film.photons > 0)

    @property
    def _has_samples(self) -> bool:
        return self._schedule.done and not any(traced.is_busy for traced in self._wavefronts)

    @property
    def _lacks_photons(self) -> bool:
        """Whether the film has fewer photons than samples; it gets as many of both."""
        return self._photons is not None and self.film.photons < self._expected_samples

    @property
    def _photons_wanted(self) -> int:
        """How many the film should have now: one for each sample that was handed out. With a time budget, for each that
        is in the film, and at least one a pixel: many samples may be on their way, and the budget waits for the first
        round of photons."""
        if self.settings.time_budget is None or self._has_samples:
            return self._expected_samples
        return max(math.prod(self.film.size), self._film_samples)

    @property
    def lost_share(self) -> float:
        """As `PhotonRender.lost_share`; 0 without photons."""
        return 0.0 if self._photons is None else self._photons.lost_share

    @property
    def samples(self) -> float:
        """Mean number of samples per pixel in the film."""
        tiles = self.film.tile_errors().astype(np.float64)
        return float(tiles[..., 2].sum() / tiles[..., 3].sum())

    @property
    def error(self) -> float:
        """The estimated relative error, see `viewer.trace.paths.film.relative_error`."""
        return relative_error(self.film.tile_errors())

    @property
    def bad_samples(self) -> int:
        """Number of samples that were not finite and so were left out of the film."""
        return self._expected_samples - self._film_samples

    @property
    def _film_samples(self) -> int:
        """Of all pixels together."""
        return round(float(self.film.tile_errors()[..., 2].sum(dtype=np.float64)))

    def step(self, seconds: float) -> None:
        """Trace for about this time, and at least one iteration, which takes well under 0.1 s on a GPU."""
        start = time.perf_counter()
        self._passes.context.make_current()
        while not self.is_done:
            if self._photons is not None and self._photons.is_due(self._photons_wanted, self._has_samples):
                self._trace_photons(self._photons)
            else:
                self._iterate()
            if time.perf_counter() - start >= seconds:
                break
        self.seconds += time.perf_counter() - start

    def take(self, halves: Sequence[Part]) -> None:
        """Take the samples of `halves` instead of tracing them. Those of each are one part of a film that has parts."""
        self._passes.context.make_current()
        self.film.take(sum((half.sums for half in halves[1:]), halves[0].sums))
        for film, half in zip(self.film.parts, halves, strict=False):
            film.take(half.sums)
        self._expected_samples = self._film_samples + sum(half.bad for half in halves)
        self.rays, self.seconds = sum(half.rays for half in halves), sum(half.seconds for half in halves)

    def _trace_photons(self, photons: PhotonRender) -> None:
        before = photons.rays, self.film.photons
        photons.iterate(self._photons_wanted)
        self.rays += photons.rays - before[0]
        if self.film.photons > before[1]:
            self._is_developed, self._shown = False, None

    def _iterate(self) -> None:
        """Trace the rays of the first wavefront while the second is shaded; then swap the two."""
        first, second = self._wavefronts
        if self.plan.is_sorted:
            self._finish()  # while this thread waits in a read instead, Python lets no other go on tracing
        if first.iterations % self._check_interval == 0:
            self._refill(first)
        self.rays += take_turn(self._wavefronts, self._intersector, self._passes.shade, self._flush)
        second.wavefront.settle()

    def _refill(self, traced: TracedWavefront) -> None:
        """Add blocks that are done to the film, and give new work to blocks that have none.

        Where all work was handed out nothing waits for their places, and it takes less time to add many together.
        """
        wavefront = traced.wavefront
        if wavefront.is_busy.any():
            if wavefront.gathered is not None:
                wavefront.gathered.read()
            is_done = wavefront.is_busy & ~self._passes.find_alive(wavefront)
            if (not self._schedule.done or traced.iterations % self._last_interval == 0
                    or np.count_nonzero(is_done) == np.count_nonzero(wavefront.is_busy)):
                self._collect(wavefront, np.flatnonzero(is_done))
        if self._schedule.done:
            return
        room, free = wavefront.room, np.flatnonzero(~wavefront.is_busy)
        wanted: list[Work] = []
        for _ in range(REFILLS):
            is_last = not wanted and not any(traced.is_busy for traced in self._wavefronts)
            missing = min(len(free) - len(wanted), room // TILE**2)
            work = self._schedule.next(missing, is_last) if missing else []
            if not work:
                break
            begun = self._without_sky(work)
            wanted += begun
            room -= int(np.count_nonzero(wavefront.traced(begun)))
        if wanted:
            wanted.sort()  # by tiles: paths side by side then read the same triangles and texels, which caches keep
            blocks = free[: len(wanted)]
            wavefront.assign(blocks, wanted)
            self._passes.begin(wavefront, blocks)

    def _without_sky(self, work: list[Work]) -> list[Work]:
        """The work items that are to be traced; the others are added to the film at once."""
        if self._sky is None:
            return work
        bare: list[Work] = []
        others: list[Work] = []
        for item in work:
            is_bare = item.pixels is None and self._sky.is_bare[item.tile_y, item.tile_x]
            (bare if is_bare else others).append(item)
        if bare:
            self.film.add_sky(self._sky, bare)
            self._count(np.array([item[:4] for item in bare]))
        return others

    def _collect(self, wavefront: Wavefront, blocks: np.ndarray) -> None:
        if not len(blocks):
            return
        if wavefront.gathered is not None:
            wavefront.gathered.show(blocks)
        self.film.add(wavefront, blocks)
        wavefront.is_busy[blocks] = False
        self._count(wavefront.work[blocks], None if wavefront.chosen is None else wavefront.chosen[blocks])

    def _count(self, work: np.ndarray, chosen: np.ndarray | None = None) -> None:
        """Count the samples of work items, (N, 4), that are in the film; they are for the pixels `chosen` (N, TILE,
        TILE)."""
        tiles, samples = work[:, :2].astype(np.int64), work[:, 3].astype(np.int64)
        inside = np.minimum(np.array(self.film.size) - TILE * tiles, TILE)
        pixels = inside.prod(axis=1)
        if chosen is not None:
            pixels = np.minimum(pixels, chosen.sum(axis=(1, 2)))  # all, or only pixels inside
        self._expected_samples += int((pixels * samples).sum())
        self._schedule.collected = self._expected_samples
        self._is_developed, self._shown = False, None

    @property
    def radiance(self) -> moderngl.Texture:
        """The mean radiance so far, RGBA32F, row 0 at the bottom, associated alpha."""
        self._develop()
        return self.film.radiance

    def _develop(self) -> None:
        if not self._is_developed:
            self._passes.context.make_current()
            self.film.develop()
            self._is_developed = True

    def read_radiance(self) -> np.ndarray:
        """`radiance`, (H, W, 4) float32, row 0 at the top."""
        self._develop()
        return self.film.read_radiance()

    @property
    def shown(self) -> moderngl.Texture:
        """`radiance`, denoised if the settings ask for that."""
        radiance = self.radiance
        if self._denoiser is None:
            return radiance
        if self._shown is None:
            self._shown = self._denoiser.filter(self.film, self._guide)
        return self._shown

    def present(self, framebuffer: moderngl.Framebuffer) -> None:
        """Draw the picture so far into `framebuffer`, with exposure and tone curve."""
        self._display.draw(self.shown, self.settings, framebuffer, 0)

    def image(self) -> Image:
        """The picture so far, in linear radiance, with the layers asked for.

        Its `stats` are those of this object, its `attributes` say how it was processed.
        """
        width, height = self.film.size
        linear = np.frombuffer(self.shown.read(), np.float32).reshape(height, width, 4)[::-1].copy()
        if isinstance(self.settings.background, tuple):
            linear += (1 - linear[..., 3:]) * np.array([*self.settings.background, 1], np.float32)
        target = self._display.target((width, height))
        self.present(target)
        shown = np.frombuffer(target.read(components=4), np.uint8).reshape(height, width, 4)[::-1]
        return Image(linear, np.ascontiguousarray(shown), self.stats(), read_layers(self.film, self._layers),
                     self.attributes(self.denoised))

    def stats(self) -> dict[str, object]:
        """Statistics for JSON: samples, estimated error, rays and time."""
        error = self.error
        told = estimated_error(error * error, self.samples, self.seconds)
        return {
            "plan": self.plan.to_json(), "intersector": self.plan.intersector, "spp": self.samples,
            "samples": round(self.samples * self.film.size[0] * self.film.size[1]), "bad_samples": self.bad_samples,
            "estimated_error": told if math.isfinite(error) else None, "rays": self.rays, "trace_s": self.seconds,
            **(self._photons.stats() if self._photons else {}),
            "rays_per_s": self.rays / self.seconds if self.seconds else None, "denoised": self.denoised,
        }

    @property
    def denoised(self) -> str:
        """What `shown` is denoised by: `raster` needs samples in both parts of the film, and is `fast` before that."""
        kind = self.settings.denoise
        return "fast" if kind == "raster" and not self.film.is_split else kind

    def attributes(self, denoised: str) -> dict[str, str]:
        """Attributes of the picture's file: the samples, and whether it was `denoised` or clamped."""
        settings = self.settings
        attributes = {"samples": f"{self.samples:g} a pixel"}
        if denoised != "off":
            attributes["denoised"] = denoised
        if settings.clamp > 0:
            attributes["clamped"] = f"indirect light to luminance {settings.clamp:g} (biased)"
        return attributes

    def release(self) -> None:
        self._passes.context.make_current()
        self._passes.context.gl.screen.use()  # moderngl would return to the framebuffer used last, even a released one
        for traced in self._wavefronts:
            traced.wavefront.release()
        if self._photons is not None:
            self._photons.release()
        if self._sky is not None:
            self._sky.release()
        self.film.release()
