"""The picture in the window: drawn when something in it changes, refined at rest, saved when asked."""

from __future__ import annotations

import time
from dataclasses import replace
from pathlib import Path

import moderngl

from ..errors import ViewerError
from ..image import Image
from ..raster.renderer import Renderer
from ..settings import Settings
from .orbit import OrbitController
from .state import ViewState, free_path

REST_SECONDS = 0.3
"""A picture that has not changed for so long is drawn again with the samples of one that is kept, if those are more."""


class Picture:
    """What `renderer` last drew of `state` seen from `orbit`."""

    def __init__(self, renderer: Renderer, state: ViewState, orbit: OrbitController) -> None:
        self._renderer, self._state, self._orbit = renderer, state, orbit
        self._drawn: tuple[object, ...] | None = None
        self._drawn_at = 0.0
        self._samples = 0
        self._good: dict[str, dict[str, object]] | None = None

    @property
    def is_refined(self) -> bool:
        """Whether the picture has the samples of one that is kept."""
        return self._samples == self._wanted_samples(still=True)

    @property
    def wants_refinement(self) -> bool:
        """Whether it has rested long enough to be refined, and is not."""
        return not self.is_refined and time.monotonic() - self._drawn_at > REST_SECONDS

    def update(self, size: tuple[int, int]) -> bool:
        """Draw what changed, at `size` pixels; whether anything had.

        What cannot be drawn gives way to what was there before, with a message; where nothing was, its error is raised.
        """
        state, camera = self._state, self._orbit.camera
        settings = state.on_screen()
        background = "env" if settings.background == "env" else "none"  # a colour is laid behind by the display pass
        shading = replace(settings, exposure=0.0, tonemap="none", background=background)
        wanted = (state.scene, shading, state.split, camera.pose.tobytes(), camera.fov_y, camera.height, size,
                  self._renderer.programs.generation)
        still = wanted == self._drawn and self.wants_refinement
        if wanted == self._drawn and not still:
            return False
        try:
            self._draw(settings, size, still)
        except (ViewerError, moderngl.Error, MemoryError) as error:
            self._go_back(error)
            return self.update(size)
        self._drawn, self._drawn_at, self._samples = wanted, time.monotonic(), self._wanted_samples(still)
        self._good = {"state": state.shown(), "orbit": dict(vars(self._orbit))}
        return True

    def present(self, framebuffer: moderngl.Framebuffer) -> None:
        self._renderer.present(self._state.on_screen(), framebuffer)

    def save(self, size: tuple[int, int]) -> None:
        """Save it as PNG in the current folder, under a name that is free, and say so."""
        settings = self._state.settings
        try:
            path = free_path(Path.cwd(), Path(self._state.scene.name).stem)
            self._draw(settings, size, still=True)
            Image.from_srgb(self._renderer.read_display(settings)).save(path)
        except (ViewerError, OSError) as error:
            self._state.say(str(error), is_error=True)
        else:
            self._state.say(f"Saved {path.name}")
        self._drawn = None

    def _draw(self, settings: Settings, size: tuple[int, int], still: bool) -> None:
        for shot, part in self._state.shots(settings, size):
            self._renderer.draw(self._state.scene, self._orbit.camera, shot, size, still=still, part=part)

    def _wanted_samples(self, still: bool) -> int:
        return self._state.settings.samples(self._renderer.context.is_software, still)

    def _go_back(self, error: Exception) -> None:
        """To what could be drawn last, saying why; where that is what now fails, there is nothing left to show."""
        if self._good is None:
            raise error
        self._state.say(str(error) or "out of memory", is_error=True)
        vars(self._state).update(self._good["state"])
        vars(self._orbit).update(self._good["orbit"])
        self._drawn = self._good = None
