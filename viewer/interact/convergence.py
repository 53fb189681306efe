"""The path-traced picture in the window: begun when the view rests, gone on with in slices, looked at now and then."""

from __future__ import annotations

import math
import time
from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

import moderngl

from ..gpu.context import Context
from ..gpu.programs import Programs
from ..image.display import DisplayPass
from ..scene.camera import Camera
from ..settings import MAX_SPP, STOPPING, Background, Settings, ignored
from .state import ViewState

if TYPE_CHECKING:
    from ..trace.denoise.wavelet import Wavelet
    from ..trace.paths.path_render import PathRender
    from ..trace.tracer import Tracer

REST_SECONDS = 0.15
"""A view that has not changed for so long is traced."""
SLICE_SECONDS = 0.03
"""Of tracing between two looks at mouse and keyboard."""
LOOK_SHARE = 0.2
"""Of the time that goes into estimating the error, filtering and showing, at most."""
LOOK_SECONDS = 0.1, 2.0
"""Between two looks: the first ones, and the last ones of a picture that hardly changes any more."""
CONVERGED = 0.01
"""Relative error from which on samples are shown as they are: what noise is left, nobody sees."""
UNTIL = {"spp": MAX_SPP, "error": 0.002}
"""When a picture is done, where the settings do not say."""
_UNIT = 0
_NOT_TRACED = ("exposure", "tonemap", "denoise", *ignored("path"))
"""Settings on which the samples do not depend: those of the display, and those that mode path ignores."""


@dataclass(frozen=True)
class Progress:
    """As of the last look: mean samples a pixel, seconds of work, rays, estimated relative error."""

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
    """Traces what `state` shows as long as it shows a path-traced picture; nothing is prepared before.

    `picture` (RGBA32F, associated alpha) is there from the moment on that every pixel has a sample.
    """

    def __init__(self, context: Context, programs: Programs, state: ViewState) -> None:
        self.picture: moderngl.Texture | None = None
        self.is_denoised = False
        """Whether the picture is, so far as there is one."""
        self.progress: Progress | None = None
        self._context, self._programs, self._state = context, programs, state
        self._display = DisplayPass(context.gl, programs)
        self._tracer: Tracer | None = None
        self._wavelet: Wavelet | None = None
        self._path_render: PathRender | None = None
        self._view: tuple[Camera, tuple[int, int]] | None = None
        self._key: tuple[object, ...] | None = None
        self._announced: object = None
        self._prepared: object = None
        self._begins_at: float | None = None
        self._has_layers = False
        self._filter: Iterator[None] | None = None
        self._looked: tuple[float, str] = 0.0, ""
        self._look_at = 0.0
        self._look_cost = 0.0

    @property
    def is_done(self) -> bool:
        """Whether nothing will be added to the picture."""
        if self._path_render is None:
            return False
        budget = self._settings().time_budget
        return self._path_render.is_done or (budget is not None and self._path_render.seconds >= budget)

    @property
    def left_out(self) -> tuple[str, ...]:
        return self._path_render.plan.left_out if self._path_render is not None else ()

    @property
    def attributes(self) -> dict[str, str]:
        """What a file has to say of the picture, as `PathRender.attributes`."""
        if self._path_render is None or self.picture is None:
            return {}
        return self._path_render.attributes("fast" if self.is_denoised else "off")

    @property
    def patience(self) -> float:
        """Seconds until it has something to do; none now, endless while there is nothing."""
        if self._view is None or (self._path_render is None and self._state.paused):
            return math.inf
        if self._path_render is None:
            return REST_SECONDS if self._begins_at is None else max(self._begins_at - time.monotonic(), 0.0)
        rests = self._state.paused or self.is_done
        return math.inf if rests and self._filter is None and not self._wants_look else 0.0

    def status(self) -> str:
        """What to tell of it, one line; empty where nothing is traced."""
        if self._view is None:
            return ""
        if self._path_render is None and not self._state.paused:
            return "" if self.patience or self._prepared is self._state.scene.meshes else "Preparing to trace paths …"
        parts = [str(self.progress)] if self.progress else ["First samples …"] if self._path_render else []
        if self.picture is not None and self.is_denoised:
            parts.append("denoised")
        if self._state.paused:
            parts.append("paused")
        elif self.is_done:
            parts.append("done")
        text = ", ".join(parts)
        return text[0].upper() + text[1:]

    def follow(self, camera: Camera, size: tuple[int, int]) -> None:
        """What to trace from now on. What differs from what there was begins anew, when it has rested."""
        if not self._state.shows("path"):
            self.leave()
            return
        key = (self._state.scene, self._settings(), camera.pose.tobytes(), camera.fov_y, camera.height, size,
               self._programs.generation)
        if key != self._key or self._lacks_layers:
            self.leave()
            self._key, self._view = key, (camera, size)
            self._begins_at = None

    def leave(self) -> None:
        """Forget the picture; what was prepared for the scene stays."""
        if self._path_render is not None:
            self._path_render.release()
        self._path_render = self._view = self._key = self._filter = self.picture = self.progress = None

    def step(self) -> bool:
        """Go on for about SLICE_SECONDS; whether there is something new to show.

        Raises what `viewer.trace.tracer.Tracer.begin` does.
        """
        if self._begins_at is None:  # from when the frame is drawn, which may take longer than a rest
            self._begins_at = time.monotonic() + REST_SECONDS
        if self.patience > 0:
            return False
        if self._path_render is None:
            meshes = self._state.scene.meshes
            is_told, self._announced = self._announced is meshes, meshes
            if is_told:  # on screen, for it may take its time
                self._begin()
                self._prepared = meshes
            return True
        if self._filter is not None:
            return self._go_on_filtering()
        if not (self._state.paused or self.is_done):
            self._path_render.step(SLICE_SECONDS)
        return self._wants_look and self._look()

    def present(self, settings: Settings, framebuffer: moderngl.Framebuffer) -> None:
        """Draw the picture into `framebuffer`, as displayed."""
        assert self.picture is not None
        self._display.draw(self.picture, settings, framebuffer, _UNIT)

    def _settings(self) -> Settings:
        """Those of the samples, whatever the display makes of them."""
        settings, plain = self._state.settings, Settings()
        background: Background = "env" if settings.background == "env" else "none"
        ends: dict[str, Any] = {} if any(getattr(settings, name) is not None for name in STOPPING) else UNTIL
        return replace(settings, mode="path", background=background, **ends,
                       **{name: getattr(plain, name) for name in _NOT_TRACED})

    def _begin(self) -> None:
        from ..trace.denoise.wavelet import Wavelet
        from ..trace.tracer import Tracer

        assert self._view is not None
        if self._tracer is None:
            self._tracer = Tracer(self._context, programs=self._programs)
            self._wavelet = Wavelet(self._context, self._programs)
        self._has_layers = self._state.settings.denoise != "off"
        layers = ("albedo", "normal") if self._has_layers else ()
        camera, size = self._view
        self._path_render = self._tracer.begin(self._state.scene, camera, self._settings(), size, layers)
        self._looked, self._look_at, self._look_cost = (0.0, ""), 0.0, 0.0

    @property
    def _lacks_layers(self) -> bool:
        """Whether there are no layers and they are wanted now."""
        return self._path_render is not None and not self._has_layers and self._state.settings.denoise != "off"

    @property
    def _wants_look(self) -> bool:
        assert self._path_render is not None
        if self._path_render.seconds >= self._look_at:
            return True
        is_new = self._looked != (self._path_render.seconds, self._state.settings.denoise)
        return is_new and (self._state.paused or self.is_done or self._looked[1] != self._state.settings.denoise)

    def _look(self) -> bool:
        """See how far the picture has come, and show it as soon as it is whole."""
        from ..trace.paths.film import relative_error

        path_render = self._path_render
        assert path_render is not None
        start = time.perf_counter()
        tiles = path_render.film.tile_errors()
        self._looked = path_render.seconds, self._state.settings.denoise
        self._look_cost = time.perf_counter() - start
        is_whole = self.is_done or bool((tiles[..., 2] >= tiles[..., 3]).all())
        if is_whole:
            samples = float(tiles[..., 2].sum(dtype=float) / tiles[..., 3].sum(dtype=float))
            self.progress = Progress(samples, path_render.seconds, path_render.rays, relative_error(tiles))
            radiance = path_render.radiance
            if self._state.settings.denoise != "off" and self.progress.error > CONVERGED:
                assert self._wavelet is not None
                self._filter = self._wavelet.steps(path_render.film)
            else:
                self.picture, self.is_denoised = radiance, False
        self._plan_look()
        return self._filter is None and is_whole

    def _go_on_filtering(self) -> bool:
        """Some passes of the filter; whether they were the last ones."""
        assert self._filter is not None and self._wavelet is not None
        start = time.perf_counter()
        while time.perf_counter() - start < SLICE_SECONDS:
            if next(self._filter, "end") == "end":
                self._filter, self.picture, self.is_denoised = None, self._wavelet.result, True
                break
            self._context.gl.finish()  # or a slow device would be given all passes at once
        self._look_cost += time.perf_counter() - start
        self._plan_look()
        return self._filter is None

    def _plan_look(self) -> None:
        assert self._path_render is not None
        first, last = LOOK_SECONDS
        seconds = self._path_render.seconds
        pause = max(first, min(seconds / 20, last), self._look_cost * (1 / LOOK_SHARE - 1))
        self._look_at = seconds + pause

    def release(self) -> None:
        self.leave()
        for thing in (self._wavelet, self._tracer, self._display):
            if thing is not None:
                thing.release()


def _short(number: float) -> str:
    """Two digits, and all of those before the point."""
    return f"{number:.2g}" if number < 10 else f"{number:.0f}"
