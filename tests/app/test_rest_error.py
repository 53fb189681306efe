"""The error of the picture in the window, without a window."""

from __future__ import annotations

import re
import time
from collections.abc import Iterator
from dataclasses import replace

import numpy as np
import pytest
import shapes
from waiting import wait_until

from viewer.estimate.mixture import draw_guide
from viewer.estimate.paths import path_settings
from viewer.gpu.context import Context
from viewer.interact import convergence, picture
from viewer.interact.orbit import OrbitController
from viewer.interact.picture import Picture
from viewer.interact.state import ViewState
from viewer.raster.renderer import Renderer
from viewer.scene.light import Light
from viewer.scene.material import Material
from viewer.settings import Settings

SIZE = (48, 36)
WINDOW = Settings(denoise="fast", spp=2, bounces=1, clamp=1.0, background="none")
"""Settings of mode path are those of a window that shows it, too, and no business of the error."""


class Rest:
    """A picture at rest, and a framebuffer to show it in."""

    def __init__(self, context: Context, scene) -> None:
        self.state = ViewState(scene, WINDOW)
        self.orbit = OrbitController(scene, SIZE[0] / SIZE[1])
        self.renderer = Renderer(context)
        self.picture = Picture(self.renderer, self.state, self.orbit)
        self._target = context.gl.framebuffer([context.gl.renderbuffer(SIZE, 4)])

    def step(self) -> None:
        self.picture.update(SIZE)
        self.picture.converge()

    def shown(self) -> np.ndarray:
        self.picture.present(self._target)
        return np.frombuffer(self._target.read(components=4), np.uint8).reshape(*SIZE[::-1], 4)[::-1].astype(int)


@pytest.fixture
def rest(context, scene, monkeypatch) -> Iterator[Rest]:
    monkeypatch.setattr(picture, "REST_SECONDS", 0.0)
    made = Rest(context, scene)
    yield made
    made.picture.release()
    made.renderer.release()


def test_it_is_told_shown_and_forgotten(rest):
    rest.step()
    rest.step()
    assert rest.picture.is_refined and rest.picture.seconds_until_work == np.inf and rest.picture.status() == ""
    plain = rest.shown()
    rest.state.toggle_error()
    assert rest.picture.seconds_until_work == 0
    rest.step()
    assert rest.picture.status() == "Preparing to trace paths …"
    rest.step()
    assert rest.picture.status() == "Tracing paths to tell the error …"
    wait_until(lambda: rest.picture.error.error is not None, rest.step)
    error = rest.picture.error.error
    assert error.low <= error.relmse <= error.high and error.samples >= 4
    assert re.fullmatch(r"[\d.]+ % from the truth \(([\d.]+ to|at most) [\d.]+ %\), \d+ samples a pixel",
                        rest.picture.status())
    assert np.array_equal(rest.shown(), plain)
    rest.state.toggle_error(shows=True)
    seen, expected = rest.shown(), rest.picture.error.error.map_image().srgb.astype(int)
    assert np.abs(seen - expected).max() <= 1 and not np.array_equal(seen, plain)
    samples = error.samples
    wait_until(lambda: rest.picture.error.error.samples > samples, rest.step)
    rest.orbit.orbit(0.3, 0.0)
    rest.picture.update(SIZE)  # another picture, whose error is not known
    assert rest.picture.error.error is None and not rest.picture.error.has_map
    wait_until(lambda: rest.picture.error.error is not None, rest.step)
    rest.state.toggle_error()
    rest.step()
    assert rest.picture.error.error is None and rest.picture.status() == ""
    assert rest.picture.seconds_until_work == np.inf


def test_of_a_traced_picture_once_it_is_done(rest, monkeypatch):
    """By other samples than those of the picture."""
    monkeypatch.setattr(convergence, "REST_SECONDS", 0.0)
    rest.state.show_view("path")
    rest.state.toggle_error()
    paths, error = rest.picture.paths, rest.picture.error

    def step() -> None:
        rest.step()
        assert paths.is_done or not error.is_begun

    wait_until(lambda: error.error is not None, step)
    told, (traced, measured) = error.error, rest.picture.status().split("\n")
    assert traced == paths.status() and traced.startswith("2 samples a pixel, ") and "from the truth" in measured
    assert paths.denoised == "fast" and np.array_equal(error._raster, paths.read_radiance())
    assert told.low <= told.relmse <= told.high and told.relmse > 0
    rest.state.toggle_denoise()
    wait_until(lambda: paths.denoised == "off", rest.step)
    assert not error.is_begun, "it is another picture"


def test_where_paths_are_too_few_the_picture_that_waited_for_them_is_shown(rest, monkeypatch):
    """And not a draft, which is all that a moving picture has."""
    monkeypatch.setattr(convergence, "REST_SECONDS", 0.0)
    monkeypatch.setattr(convergence, "SLICE_SECONDS", 0.0)
    guides: list[np.ndarray] = []

    def keep(*arguments):
        guides.append(draw_guide(*arguments))
        return guides[-1]

    monkeypatch.setattr(picture, "draw_guide", keep)
    rest.state.settings = replace(WINDOW, mode="path", denoise="raster", spp=None, time_budget=1e-3)
    wait_until(lambda: rest.picture.paths.is_done and rest.picture.is_refined, rest.step)
    assert rest.picture.status().endswith("too few to mix with the real-time picture, which is shown")
    assert np.allclose(rest.renderer.read_radiance()[..., :3], guides[-1], rtol=2e-3, atol=1e-5)


@pytest.fixture
def glass(context, monkeypatch) -> Iterator[Rest]:
    """A ball of glass below a lamp, with photons."""
    monkeypatch.setattr(picture, "REST_SECONDS", 0.0)
    clear = Material(metallic=0.0, perceptual_roughness=0.0, transmission=1.0, thickness=1.0)
    model = shapes.scene((shapes.plate(half=3), shapes.facing_floor()),
                         (shapes.sphere(1, 24), shapes.moved((0, 1.2, 0), 0.4)), materials=(shapes.WHITE, clear),
                         lights=(Light("point", intensity=10.0, position=(0.2, 2.4, 0.1)),))
    made = Rest(context, model)
    made.state.settings = replace(WINDOW, caustics="photons", photons=2)
    yield made
    made.picture.release()
    made.renderer.release()


def test_photons_gather_at_rest(glass, monkeypatch):
    monkeypatch.setattr(picture, "MOST_PHOTONS", 6)
    glass.picture.update(SIZE)
    assert not glass.picture.is_refined and glass.renderer.photons_each == np.inf
    plain = glass.shown()
    seen = []
    while glass.picture.seconds_until_work == 0 or not glass.picture.is_refined:
        glass.step()
        if glass.picture.is_refined:
            seen.append(glass.picture.status())
    assert "1 of 6 photons a pixel" in seen and seen[-1] == ""
    assert glass.renderer.photons_each >= 6
    lit = (glass.shown() - plain)[..., :3]
    assert lit.mean() > 0.5 and np.median(lit) == 0
    each = glass.renderer.photons_each
    glass.state.toggle_error()  # a picture whose error is told has no more than it has, and keeps these
    wait_until(lambda: glass.picture.error.error is not None, glass.step)
    assert glass.renderer.photons_each == each
    glass.orbit.orbit(0.3, 0.0)
    glass.picture.update(SIZE)
    assert glass.renderer.photons_each == np.inf
    wait_until(lambda: glass.picture.error.is_begun, glass.step)
    assert 2 <= glass.renderer.photons_each < 3


def test_photons_of_the_raster_wait_for_the_paths_beside_it(glass, monkeypatch):
    """These have photons, too, and take turns with the raster's once they have something to show."""
    monkeypatch.setattr(picture, "MOST_PHOTONS", 3)
    monkeypatch.setattr(convergence, "SLICE_SECONDS", 0.0)
    glass.state.settings = replace(glass.state.settings, denoise="off")
    glass.state.show_view("path_split")
    seen: set[float] = set()
    while glass.picture.paths.picture is None:
        seen.add(glass.renderer.photons_each)
        glass.step()
    assert seen == {0, np.inf}
    wait_until(lambda: glass.renderer.photons_each >= 3, glass.step)


def test_no_slice_waits_for_the_estimate(rest, monkeypatch):
    def slow(*arguments):
        time.sleep(0.4)
        raise AssertionError("not needed")

    monkeypatch.setattr("viewer.interact.rest_error.raster_error", slow)
    rest.state.toggle_error()
    wait_until(lambda: rest.picture.error.is_begun, rest.step)
    paths = rest.picture.error._paths
    wait_until(lambda: rest.picture.error._future is not None, rest.step)
    seconds = paths.seconds
    rest.step()
    assert paths.seconds > seconds and not rest.picture.error._future.done()
    rest.picture.error.discard()  # and its outcome with it


def test_only_of_one_mode(rest):
    state = rest.state
    for view in ("split", "path_split"):
        state.show_view(view)
        state.toggle_error()
        assert not state.tells_error and "one mode" in state.message
    state.show_view("phong")
    state.toggle_error(shows=True)
    assert state.tells_error and state.shows_error
    state.toggle_error()
    assert not state.tells_error and not state.shows_error


def test_paths_are_not_those_that_the_window_shows():
    assert path_settings(WINDOW) == Settings(mode="path", background="none")
