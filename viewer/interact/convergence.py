"""The path-traced picture in the window: it starts when the view is at rest, and is traced in short slices of time."""

from __future__ import annotations

import math
import time
from collections.abc import Callable
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import moderngl
import numpy as np

from ..gpu.context import Context
from ..gpu.float_texture import read_texels
from ..gpu.programs import Programs
from ..image.display import DisplayPass
from ..scene.camera import Camera
from ..settings import MAX_SPP, STOPPING, Background, Settings, ignored
from .shown_film import Progress, ShownFilm
from .state import ViewState

if TYPE_CHECKING:
    from ..trace.denoise.fast import Combining
    from ..trace.paths.path_render import PathRender
    from ..trace.tracer import Tracer

REST_SECONDS = 0.15
"""Tracing starts when the view has not changed for so long."""
SLICE_SECONDS = 0.03
"""The time of tracing after which input events are handled."""
DEFAULT_STOPPING = {"spp": MAX_SPP, "error": 0.002}
"""The rules that end a picture if the settings have none."""
ENOUGH = 16
"""Samples a pixel whose noise is known well enough to end by it."""
COMPILING = 4
"""Iterations in which a scene's programs are used for the first time: two of each wavefront."""
_UNUSED_SETTINGS = ("exposure", "tonemap", "denoise", *ignored("path"))
"""The settings that do not change the samples: those of the display, and those that mode path ignores."""
_UNIT = 0


class Convergence:
    """Path traces the view of `state` as long as the state shows mode path. Nothing is prepared before that.

    `draw_guide` draws what `Tracer.begin` takes as its guide.
    """

    def __init__(self, context: Context, programs: Programs, state: ViewState,
                 draw_guide: Callable[[Camera, Settings, tuple[int, int]], np.ndarray | None]) -> None:
        self._context, self._programs, self._state = context, programs, state
        self._display = DisplayPass(context.gl, programs)
        self._tracer: Tracer | None = None
        self._combining: Combining | None = None
        self._draw_guide = draw_guide
        self._shown: ShownFilm | None = None
        self._view: tuple[Camera, tuple[int, int]] | None = None
        self._key: tuple[object, ...] | None = None
        self._announced_meshes: object = None
        self._prepared_meshes: object = None
        self._begins_at: float | None = None
        self._compiled = 0.0
        """Seconds of tracing that its programs took to compile."""
        self._begun_for = "off"
        """The denoiser that the film has layers and parts for."""

    @property
    def _path_render(self) -> PathRender | None:
        return None if self._shown is None else self._shown.render

    @property
    def picture(self) -> moderngl.Texture | None:
        """As `ShownFilm.picture`; None if nothing is traced."""
        return None if self._shown is None else self._shown.picture

    @property
    def denoised(self) -> str:
        """What `picture` is denoised by."""
        return "off" if self._shown is None else self._shown.denoised

    @property
    def progress(self) -> Progress | None:
        return None if self._shown is None else self._shown.progress

    @property
    def _rests(self) -> bool:
        return self._state.paused or self.is_done

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
        if self._view is None or (self._shown is None and self._state.paused):
            return math.inf
        if self._shown is None:
            return REST_SECONDS if self._begins_at is None else max(self._begins_at - time.monotonic(), 0.0)
        is_shown = not (self._shown.is_filtering or self._shown.is_due(self._state.settings.denoise, self._rests))
        return math.inf if self._rests and is_shown else 0.0

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
            has_picture = self.picture is not None or (self._shown is not None and self._shown.is_filtering)
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
        if self._shown is not None:
            self._shown.render.release()
        self._shown = self._view = self._key = None

    def step(self) -> bool:
        """Continue tracing for about SLICE_SECONDS. Returns whether there is something new to show.

        Raises the errors of `viewer.trace.tracer.Tracer.begin`.
        """
        if self._begins_at is None:  # REST_SECONDS count from here, after the frame was drawn, which may take longer
            self._begins_at = time.monotonic() + REST_SECONDS
        if self.seconds_until_work > 0:
            return False
        if self._shown is None:
            meshes = self._state.scene.meshes
            is_announced, self._announced_meshes = self._announced_meshes is meshes, meshes
            if is_announced:  # "Preparing ..." is on screen by now; preparing the scene may take long
                self._begin()
                self._prepared_meshes = meshes
            return True
        if self._shown.is_filtering:
            return self._shown.filter(SLICE_SECONDS)
        if not self._rests:
            self._shown.render.step(SLICE_SECONDS)
        denoise, rests = self._state.settings.denoise, self._rests
        return self._shown.is_due(denoise, rests) and self._shown.update(denoise, rests, self.is_done)

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
        guide = self._draw_guide(camera, settings, size)
        render = tracer.begin(self._state.scene, camera, settings, size, guide=guide, is_interactive=True)
        self._shown = ShownFilm(self._context, render, self._combining, guide)
        for _ in range(COMPILING if self._prepared_meshes is not self._state.scene.meshes else 0):
            render.step(0.0)
        self._compiled = render.seconds

    @property
    def _lacks_something(self) -> bool:
        """Whether the denoiser needs layers that are not traced, or a guide that is not drawn."""
        wanted = self._state.settings.denoise
        lacks = wanted == "raster" if self._begun_for == "fast" else wanted != "off" and self._begun_for == "off"
        return self._path_render is not None and lacks

    def release(self) -> None:
        self.discard()
        for thing in (self._combining, self._tracer, self._display):
            if thing is not None:
                thing.release()
