"""The path-traced picture in the window: it starts when the view is at rest, is traced in short slices of time, and is
shown at intervals as it converges."""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

import moderngl
import numpy as np

from ..gpu.context import Context
from ..gpu.float_texture import read_texels
from ..gpu.programs import Programs
from ..image.display import DisplayPass
from ..scene.camera import Camera
from ..settings import MAX_SPP, STOPPING, Background, Settings, ignored
from .state import ViewState

if TYPE_CHECKING:
    from ..trace.denoise.fast import Combining
    from ..trace.paths.path_render import PathRender
    from ..trace.tracer import Tracer

REST_SECONDS = 0.15
"""Tracing starts when the view has not changed for so long."""
SLICE_SECONDS = 0.03
"""The time of tracing after which input events are handled."""
UPDATE_FRACTION = 0.2
"""The most of the time that is used for updates: estimating the error and showing the picture; and as much for
denoising it."""
UPDATE_SECONDS = 0.1, 2.0
"""The time between two updates: at first, and later, when the picture hardly changes any more."""
CONVERGED = 0.01
"""Below this relative error the samples are shown without denoising, since the noise is no longer visible."""
DEFAULT_STOPPING = {"spp": MAX_SPP, "error": 0.002}
"""The rules that end a picture if the settings have none."""
ENOUGH = 16
"""Samples a pixel whose noise is known well enough to end by it."""
COMPILING = 4
"""Iterations in which a scene's programs are used for the first time: two of each wavefront."""
_UNUSED_SETTINGS = ("exposure", "tonemap", "denoise", *ignored("path"))
"""The settings that do not change the samples: those of the display, and those that mode path ignores."""
_UNIT = 0


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


class Convergence:
    """Path traces the view of `state` as long as the state shows mode path. Nothing is prepared before that.

    `picture` (RGBA32F, associated alpha) is None until every pixel has a sample; to be mixed with the raster's, two.
    `draw_guide` draws what `Tracer.begin` takes as its guide.
    """

    def __init__(self, context: Context, programs: Programs, state: ViewState,
                 draw_guide: Callable[[Camera, Settings, tuple[int, int]], np.ndarray | None]) -> None:
        self.picture: moderngl.Texture | None = None
        self.denoised = "off"
        """What `picture` is denoised by."""
        self.progress: Progress | None = None
        self._context, self._programs, self._state = context, programs, state
        self._display = DisplayPass(context.gl, programs)
        self._tracer: Tracer | None = None
        self._combining: Combining | None = None
        self._draw_guide = draw_guide
        self._guide: np.ndarray | None = None
        self._path_render: PathRender | None = None
        self._view: tuple[Camera, tuple[int, int]] | None = None
        self._key: tuple[object, ...] | None = None
        self._announced_meshes: object = None
        self._prepared_meshes: object = None
        self._begins_at: float | None = None
        self._compiled = 0.0
        """Seconds of tracing that its programs took to compile."""
        self._begun_for = "off"
        """The denoiser that the film has layers and parts for."""
        self._filter: Iterator[None] | None = None
        self._shown_of: tuple[float, str] = 0.0, ""
        """The seconds of tracing that are in `picture`, and the denoiser that was asked for."""
        self._update_at = self._filter_at = 0.0
        self._update_cost = self._filter_cost = 0.0

    @property
    def is_done(self) -> bool:
        """Whether the picture is finished: no more samples will be added."""
        render, settings = self._path_render, self._settings()
        return render is not None and (render.is_done or self._has_reached(settings.error)
                                       or self._has_taken(render, settings.time_budget))

    def _has_reached(self, error: float | None) -> bool:
        """Whether what the user reads is at most that."""
        told = self.progress
        return error is not None and told is not None and told.samples >= ENOUGH and told.error <= error

    def _has_taken(self, render: PathRender, budget: float | None) -> bool:
        """Whether time is over and the picture whole, or to be mixed with the raster's, which stays then."""
        is_over = budget is not None and render.seconds - self._compiled >= budget
        return is_over and (render.is_whole or self._state.settings.denoise == "raster")

    @property
    def left_out(self) -> tuple[str, ...]:
        return self._path_render.plan.left_out if self._path_render is not None else ()

    @property
    def attributes(self) -> dict[str, str]:
        """The texts to store in a file of the picture, as `PathRender.attributes` has them."""
        if self._path_render is None or self.picture is None:
            return {}
        return self._path_render.attributes(self.denoised)

    @property
    def seconds_until_work(self) -> float:
        """The seconds until `step` has something to do: 0 if it has now, infinite if it has nothing."""
        if self._view is None or (self._path_render is None and self._state.paused):
            return math.inf
        if self._path_render is None:
            return REST_SECONDS if self._begins_at is None else max(self._begins_at - time.monotonic(), 0.0)
        rests = self._state.paused or self.is_done
        return math.inf if rests and self._filter is None and not self._update_is_due else 0.0

    def status(self) -> str:
        """The state of the picture in one line for the user; empty if nothing is traced."""
        if self._view is None:
            return ""
        if self._path_render is None and not self._state.paused:
            is_prepared = self._prepared_meshes is self._state.scene.meshes
            return "" if self.seconds_until_work or is_prepared else "Preparing to trace paths …"
        parts = [str(self.progress)] if self.progress else ["First samples …"] if self._path_render else []
        if self.picture is not None and self.denoised != "off":
            parts.append("denoised")
        if self._state.paused:
            parts.append("paused")
        elif self.is_done:
            has_picture = self.picture is not None or self._filter is not None
            parts.append("done" if has_picture else "done: too few to mix with the real-time picture, which is shown")
        text = ", ".join(parts)
        return text[0].upper() + text[1:]

    def follow(self, camera: Camera, size: tuple[int, int]) -> None:
        """Set the view to trace. If it differs from the current one, tracing starts again after REST_SECONDS."""
        if not self._state.shows("path"):
            self.discard()
            return
        key = (self._state.scene, self._settings(), *camera.key, size, self._programs.generation)
        if key != self._key or self._lacks_something:
            self.discard()
            self._key, self._view = key, (camera, size)
            self._begins_at = None

    def discard(self) -> None:
        """Discard the picture. The tracer and what it has prepared for the scene stay."""
        if self._path_render is not None:
            self._path_render.release()
        self._path_render = self._view = self._key = self._filter = self.picture = self.progress = None

    def step(self) -> bool:
        """Continue tracing for about SLICE_SECONDS. Returns whether there is something new to show.

        Raises the errors of `viewer.trace.tracer.Tracer.begin`.
        """
        if self._begins_at is None:  # REST_SECONDS count from here, after the frame was drawn, which may take longer
            self._begins_at = time.monotonic() + REST_SECONDS
        if self.seconds_until_work > 0:
            return False
        if self._path_render is None:
            meshes = self._state.scene.meshes
            is_announced, self._announced_meshes = self._announced_meshes is meshes, meshes
            if is_announced:  # "Preparing ..." is on screen by now; preparing the scene may take long
                self._begin()
                self._prepared_meshes = meshes
            return True
        if self._filter is not None:
            return self._continue_filter()
        if not (self._state.paused or self.is_done):
            self._path_render.step(SLICE_SECONDS)
        return self._update_is_due and self._update()

    def tracer(self) -> Tracer:
        """The path tracer of the window, made when it is first needed."""
        from ..trace.tracer import Tracer

        if self._tracer is None:
            self._tracer = Tracer(self._context, programs=self._programs)
        return self._tracer

    def read_radiance(self) -> np.ndarray:
        """`picture`, (H, W, 4) float32, row 0 at the top."""
        assert self.picture is not None
        return read_texels(self.picture)[::-1]

    def present(self, settings: Settings, framebuffer: moderngl.Framebuffer) -> None:
        """Draw the picture into `framebuffer`, with exposure and tone map."""
        assert self.picture is not None
        self._display.draw(self.picture, settings, framebuffer, _UNIT)

    def _settings(self) -> Settings:
        """The settings to trace with. Settings that do not change the samples have their defaults."""
        settings, plain = self._state.settings, Settings()
        background: Background = "env" if settings.background == "env" else "none"
        ends: dict[str, Any] = {} if any(getattr(settings, name) is not None for name in STOPPING) else DEFAULT_STOPPING
        return replace(settings, mode="path", background=background, **ends,
                       **{name: getattr(plain, name) for name in _UNUSED_SETTINGS})

    def _begin(self) -> None:
        from ..trace.denoise.fast import Combining

        assert self._view is not None
        tracer = self.tracer()
        if self._combining is None:
            self._combining = Combining(self._context, self._programs)
        self._begun_for = self._state.settings.denoise
        camera, size = self._view
        settings = replace(self._settings(), denoise=self._begun_for)
        self._guide = self._draw_guide(camera, settings, size)
        render = self._path_render = tracer.begin(self._state.scene, camera, settings, size, guide=self._guide,
                                                  is_interactive=True)
        for _ in range(COMPILING if self._prepared_meshes is not self._state.scene.meshes else 0):
            render.step(0.0)
        self._compiled = render.seconds
        self._shown_of, self._update_at, self._filter_at = (0.0, ""), 0.0, 0.0

    @property
    def _lacks_something(self) -> bool:
        """Whether the denoiser needs layers that are not traced, or a guide that is not drawn."""
        wanted = self._state.settings.denoise
        lacks = wanted == "raster" if self._begun_for == "fast" else wanted != "off" and self._begun_for == "off"
        return self._path_render is not None and lacks

    @property
    def _update_is_due(self) -> bool:
        assert self._path_render is not None
        return self._path_render.seconds >= self._update_at or self._picture_is_due

    @property
    def _picture_is_due(self) -> bool:
        """Whether the picture has to be made now, whatever that costs: it rests, or another denoiser is asked for."""
        assert self._path_render is not None
        wanted = self._path_render.seconds, self._state.settings.denoise
        return wanted != self._shown_of and (self._state.paused or self.is_done or wanted[1] != self._shown_of[1])

    def _update(self) -> bool:
        """Estimate the error, and show the picture if every pixel has a sample. Returns whether there is a new one, or
        new words for the status. Denoising takes long where the CPU draws, so the words do not wait for it."""
        from ..trace.paths.film import relative_error

        path_render, denoise = self._path_render, self._state.settings.denoise
        assert path_render is not None
        start, is_due = time.perf_counter(), self._picture_is_due
        tiles = path_render.film.tile_errors()
        self._update_cost = time.perf_counter() - start
        is_whole = self.is_done or bool((tiles[..., 2] >= tiles[..., 3]).all())
        if is_whole:
            samples = float(tiles[..., 2].sum(dtype=float) / tiles[..., 3].sum(dtype=float))
            self.progress = Progress(samples, path_render.seconds, path_render.rays, relative_error(tiles))
            radiance = path_render.radiance
            if denoise == "off" or self.progress.error <= CONVERGED:
                self.picture, self.denoised = radiance, "off"
                self._shown_of = path_render.seconds, denoise
            elif denoise == "raster" and not (path_render.film.is_split or path_render.is_done):
                self._shown_of = path_render.seconds, denoise  # the raster's picture is better
            elif is_due or path_render.seconds >= self._filter_at:
                assert self._combining is not None
                guide = None if denoise == "fast" else self._guide
                self._filter, self._filter_cost = self._combining.steps(path_render.film, guide), 0.0
                self._shown_of = path_render.seconds, denoise
        self._schedule_update()
        return self._filter is None and is_whole

    def _continue_filter(self) -> bool:
        """Run some passes of the denoising filter. Returns whether it is finished."""
        assert self._filter is not None and self._combining is not None and self._path_render is not None
        start = time.perf_counter()
        while time.perf_counter() - start < SLICE_SECONDS:
            if next(self._filter, "end") == "end":
                self._filter, self.picture = None, self._combining.result
                self.denoised = "fast" if self._shown_of[1] == "fast" else self._path_render.denoised
                break
            self._context.gl.finish()  # otherwise all passes would be queued at once on a slow device
        self._filter_cost += time.perf_counter() - start
        self._filter_at = self._path_render.seconds + self._filter_cost * (1 / UPDATE_FRACTION - 1)
        return self._filter is None

    def _schedule_update(self) -> None:
        assert self._path_render is not None
        first, last = UPDATE_SECONDS
        seconds = self._path_render.seconds
        pause = max(first, min(seconds / 20, last), self._update_cost * (1 / UPDATE_FRACTION - 1))
        self._update_at = seconds + pause

    def release(self) -> None:
        self.discard()
        for thing in (self._combining, self._tracer, self._display):
            if thing is not None:
                thing.release()


def _short(number: float) -> str:
    """The number with two significant digits, or all digits before the point."""
    return f"{number:.2g}" if number < 10 else f"{number:.0f}"
