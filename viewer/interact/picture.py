"""The picture in the window. It is drawn when something changes, refined at rest, and saved on request."""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Sequence
from dataclasses import replace
from pathlib import Path

import moderngl
import numpy as np

from ..errors import ViewerError
from ..estimate.mixture import draw_guide
from ..image.enlarged import Enlarged
from ..image.image import Image
from ..plan.legend import legend
from ..plan.media import has_media
from ..quality import DETERMINED
from ..raster.renderer import Renderer
from ..scene.camera import Camera
from ..settings import Background, Settings
from .convergence import SLICE_SECONDS, Convergence
from .free_path import free_path
from .orbit import OrbitController
from .pace import FrameSize
from .rest_error import RestError
from .shots import on_screen, parts, shots, shots_of_quality
from .state import ViewState

MOST_PHOTONS = 1024
"""A pixel, of a picture at rest."""
REST_SECONDS = 0.3
"""A picture that has not changed for so long is drawn again as a still picture, if that takes more samples."""


class Picture:
    """The picture of `state` from the camera of `orbit`, as `renderer` last drew it and as `paths` traces it."""

    def __init__(self, renderer: Renderer, state: ViewState, orbit: OrbitController) -> None:
        self._renderer, self._state, self._orbit = renderer, state, orbit
        self.paths = Convergence(renderer.context, renderer.programs, state, self._draw_guide)
        self.error = RestError(renderer.context, renderer.programs, self.paths.tracer)
        self._prepares_error = False
        self._enlarged = Enlarged(renderer.context.gl, renderer.programs)
        self._frame = FrameSize()
        self._drawn: tuple[object, ...] | None = None
        self._drawn_from: tuple[object, ...] | None = None
        """The camera of the picture, and its scene."""
        self._drawn_at = 0.0
        self._drawn_as: tuple[object, ...] = ()
        self._good: dict[str, dict[str, object]] | None = None

    @property
    def size(self) -> tuple[int, int]:
        """In pixels: while the picture moves, perhaps less than what it is shown at."""
        return self._frame.size

    @property
    def is_refined(self) -> bool:
        """Whether the picture has the quality of a still picture, its size, its samples, and its rays and steps in
        media. In mode path its size is enough, as long as the path-traced picture is to replace it."""
        has_paths = self.paths.picture is not None or not self.paths.is_done
        is_path = self._state.modes == ("path",) and has_paths
        return self._frame.is_whole and (is_path or self._drawn_as == self._as_drawn(still=True))

    @property
    def wants_refinement(self) -> bool:
        """Whether it shall be refined now: it is not, and it has been at rest long enough."""
        if not self._frame.is_whole:
            return self._frame.seconds_until_still <= 0
        return not self.is_refined and time.monotonic() - self._drawn_at > REST_SECONDS

    @property
    def seconds_until_work(self) -> float:
        """The seconds until there is something to do without user input; infinite if there is nothing."""
        if not self._frame.is_whole:
            return max(self._frame.seconds_until_still, 0.0)
        measures = self._has_error and not self.error.is_done
        waits = REST_SECONDS if not self.is_refined else 0.0 if measures or self._lacks_photons else math.inf
        return min(self.paths.seconds_until_work, waits)

    def status(self) -> str:
        """The state of path tracing, or the error of the picture, in one line for the user; empty if there is none."""
        if self.paths.status():
            return "\n".join([self.paths.status(), *filter(None, [self.error.status()])])
        if lines := legend(self._state.scene, self._orbit.camera, self._state.settings):
            return "\n".join(lines)
        if not self._prepares_error:
            each = self._renderer.photons_each
            return f"{each:.0f} of {self._most_photons} photons a pixel" if self._lacks_photons and each >= 1 else ""
        return self.error.status() or "Preparing to trace paths …"

    @property
    def left_out(self) -> Sequence[str]:
        """What the plan of the current picture has left out, in lines."""
        return self.paths.left_out or (self._renderer.plan.left_out if self._renderer.plan else ())

    def update(self, whole: tuple[int, int]) -> bool:
        """Draw the picture if something has changed: at `whole` pixels, or fewer while it moves, if frames take too
        long. Returns whether it has.

        If it cannot be drawn, the last state that could be drawn is restored, with a message. If there is none, the
        error is raised.
        """
        state, camera = self._state, self._orbit.camera
        size = self._frame.begin(whole, self._moves(camera))
        settings = on_screen(state)
        wanted = self._wanted(settings, size)
        self.paths.follow(camera, size)
        still = wanted == self._drawn and self._frame.is_whole and self.wants_refinement
        if wanted == self._drawn and not still:
            return False
        try:
            self._draw(settings, size, still)
        except (ViewerError, moderngl.Error, MemoryError) as error:
            self._go_back(error)
            return self.update(whole)
        self._drawn_from = state.scene, *camera.key
        self._drawn, self._drawn_at, self._drawn_as = wanted, time.monotonic(), self._as_drawn(still)
        self._forget_error()
        self._good = {"state": state.shown(), "orbit": dict(vars(self._orbit))}
        return True

    def _wanted(self, settings: Settings, size: tuple[int, int]) -> tuple[object, ...]:
        """All that a picture of `size` pixels depends on, as far as it is drawn and not only displayed."""
        # The display pass composites a background colour.
        background: Background = "env" if settings.background == "env" else "none"
        exposure = settings.exposure if settings.grid == "on" else 0.0  # the grid is as bright in all
        shading = replace(settings, exposure=exposure, tonemap="none", background=background)
        return (self._state.scene, shots(self._state, shading, size), self._state.quality, *self._orbit.camera.key,
                size, self._renderer.programs.generation)

    def _moves(self, camera: Camera) -> bool:
        """Whether the next picture follows the last one in a movement. A new scene does not, which takes long once."""
        if self._drawn_from is None:
            return False
        scene, *key = self._drawn_from
        return self._state.playback.is_playing or (scene is self._state.scene and tuple(key) != camera.key)

    def was_shown(self) -> None:
        """All the work is done that shows what `update` has drawn."""
        self._frame.shown()

    def converge(self) -> bool:
        """Continue path tracing for a slice of time. Returns whether there is something new to show.

        A picture with fewer pixels is not traced, since a whole one soon replaces it. If the scene cannot be traced,
        mode pbr is shown instead, with a message.
        """
        if not self._frame.is_whole:
            return False
        try:
            if self.paths.step():
                self._forget_error()
                return True
            return self._add_photons() or self._measure()
        except (ViewerError, moderngl.Error, MemoryError) as error:
            self._state.say(str(error) or "out of memory", is_error=True)
            self._state.tells_error = False
            if self._state.shows("path"):
                self._state.show_mode("pbr")
            self.paths.discard()
            return True

    @property
    def _most_photons(self) -> int:
        """A pixel, of a picture at rest. One whose error is told stays as `render` makes it."""
        return self._state.settings.photons if self._state.tells_error else MOST_PHOTONS

    @property
    def _lacks_photons(self) -> bool:
        """Not before paths, which take turns with them, have something to show."""
        awaits_paths = self._state.shows("path") and self.paths.picture is None and not self._state.paused
        return self.is_refined and not awaits_paths and self._renderer.photons_each < self._most_photons

    def _add_photons(self) -> bool:
        """Go on to trace photons for the picture at rest. Returns whether there are new ones to show."""
        if not self._lacks_photons:
            return False
        goal = min(max(2 * self._renderer.photons_each, 1.0), self._most_photons)  # a small round first, to show some
        return self._renderer.add_photons(SLICE_SECONDS, goal)

    def _draw_guide(self, camera: Camera, settings: Settings, size: tuple[int, int]) -> np.ndarray | None:
        """As `viewer.estimate.mixture.draw_guide`. After it, the renderer has another picture than that of the view."""
        guide = draw_guide(self._renderer, self._state.scene, camera, settings, size)
        if guide is not None:
            self._drawn = None
        return guide

    @property
    def _has_error(self) -> bool:
        """Whether the error of the picture at rest shall be told. One of paths rests once it is done, or paused."""
        state, is_traced = self._state, self._state.settings.mode == "path"
        rests = self.paths.seconds_until_work == math.inf and (self.paths.is_done or self.paths.picture is not None)
        return state.tells_error and state.has_error and (rests or not is_traced)

    def _measure(self) -> bool:
        """Go on to measure the error of the picture at rest. Returns whether there is something new to show."""
        state = self._state
        is_whole = self.is_refined and not self._lacks_photons
        if not (self._has_error and is_whole and self._drawn is not None):
            return self._forget_error()
        if time.monotonic() - self._drawn_at < REST_SECONDS:
            return False
        if not self._prepares_error:  # "Preparing ..." is shown first; preparing the scene may take long
            self._prepares_error = True
            return True
        if not self.error.is_begun:
            picture = self.paths if self.paths.picture is not None else self._renderer
            self.error.begin(picture.read_radiance(), state.scene, self._orbit.camera, state.at_rest, self.size)
            return True
        return self.error.step()

    def _forget_error(self) -> bool:
        """Returns whether something was shown that is not any more."""
        had, self._prepares_error = self._prepares_error, False
        self.error.discard()
        return had

    def present(self, framebuffer: moderngl.Framebuffer) -> None:
        """Show it over all of the viewport of `framebuffer`."""
        if framebuffer.viewport[2:] != self.size:
            self._enlarged.draw(self.size, self._present_as_drawn, framebuffer)
        else:
            self._present_as_drawn(framebuffer)

    def _present_as_drawn(self, framebuffer: moderngl.Framebuffer) -> None:
        if self._state.shows_error and self.error.has_map:
            self.error.present(framebuffer)
        else:
            self._present(on_screen(self._state), framebuffer)

    def shown(self) -> np.ndarray:
        """What `present` shows at `size` pixels: (H, W, 3) uint8, row 0 at the top."""
        return self._read(self.present, self.size)[..., :3]

    def release(self) -> None:
        self._enlarged.release()
        self.error.release()
        self.paths.release()

    def save(self, size: tuple[int, int]) -> None:
        """Save the picture as PNG in the current folder, under a free name, and show a message."""
        settings = self._state.settings
        try:
            path = free_path(Path.cwd(), Path(self._state.scene.name).stem)
            self.paths.follow(self._orbit.camera, size)
            if not self._is_all_paths(size):
                if self._drawn != self._wanted(settings, size) or self._drawn_as != self._as_drawn(still=True):
                    self._drawn = None
                    self._forget_error()
                    self._draw(settings, size, still=True)
                self._renderer.add_photons(math.inf, settings.photons)
            image = Image.from_srgb(self._read(lambda framebuffer: self._present(settings, framebuffer), size))
            image.attributes.update(self.paths.attributes)
            image.save(path)
        except ViewerError as error:
            self._state.say(str(error), is_error=True)
        except OSError as error:  # of `cwd` alone: the folder is gone
            self._state.say(f"the picture is not saved: the current folder: {error.strerror}", is_error=True)
        else:
            self._state.say(f"Saved {path}")

    def _draw(self, settings: Settings, size: tuple[int, int], still: bool) -> None:
        for shot, part in shots_of_quality(self._state, settings, size, still):
            self._renderer.draw(self._state.scene, self._orbit.camera, shot, size, still=still, part=part,
                                keeps_photons=still)

    def _present(self, settings: Settings, framebuffer: moderngl.Framebuffer) -> None:
        size = framebuffer.viewport[2:]
        if not self._is_all_paths(size):
            self._renderer.present(settings, framebuffer)
        if self.paths.picture is not None:
            for mode, part in parts(self._state, size):
                if mode == "path":
                    framebuffer.scissor = part  # type: ignore[assignment]  # None means all of it
                    self.paths.present(settings, framebuffer)
                    framebuffer.scissor = None  # type: ignore[assignment]

    def _is_all_paths(self, size: tuple[int, int]) -> bool:
        """Whether the path-traced picture covers everything, so that the raster need not be shown."""
        return self.paths.picture is not None and all(mode == "path" for mode, _ in parts(self._state, size))

    def _read(self, present: Callable[[moderngl.Framebuffer], None], size: tuple[int, int]) -> np.ndarray:
        """What `present` draws, (H, W, 4) uint8, row 0 at the top."""
        color = self._renderer.context.gl.renderbuffer(size, 4)
        framebuffer = self._renderer.context.gl.framebuffer([color])
        present(framebuffer)
        pixels = np.frombuffer(framebuffer.read(components=4), np.uint8).reshape(size[1], size[0], 4)
        framebuffer.release()
        color.release()
        return np.ascontiguousarray(pixels[::-1])

    def _as_drawn(self, still: bool) -> tuple[object, ...]:
        """Of each shot the samples of a pixel, rays and steps where there are media, whether there are photons, and
        what qualities differ in."""
        device, scene, result = (self._renderer.context.is_software, still), self._state.scene, []
        for shot, part in shots_of_quality(self._state, self._state.settings, self.size, still):
            media = shot.media_rays_and_steps(*device) if has_media(scene, shot) else ()
            values = tuple(getattr(shot, name) for name in sorted(DETERMINED - {"antialias"}))
            has_photons = still and part is None and shot.mode == "pbr" and shot.caustics == "photons"
            result.append((shot.samples(*device), shot.supersampling, *media, has_photons, *values))
        return tuple(result)

    def _go_back(self, error: Exception) -> None:
        """Restore the last state that could be drawn, and show the error. Raises it if there is no such state, or if
        drawing that state has failed, too."""
        if self._good is None:
            raise error
        self._state.say(str(error) or "out of memory", is_error=True)
        vars(self._state).update(self._good["state"])
        vars(self._orbit).update(self._good["orbit"])
        self._drawn = self._good = None
