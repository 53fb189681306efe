"""The path-traced picture of the window, without one."""

from __future__ import annotations

import math
import subprocess
import sys
from collections.abc import Callable, Iterator
from dataclasses import replace

import numpy as np
import pytest
from waiting import PATIENCE_S, wait_until

from viewer.estimate.mixture import draw_guide
from viewer.gpu.context import Context
from viewer.gpu.programs import Programs
from viewer.interact import convergence, shown_film
from viewer.interact.convergence import Convergence
from viewer.interact.shown_film import Progress
from viewer.interact.state import ViewState
from viewer.raster.renderer import Renderer
from viewer.scene.camera import Camera
from viewer.settings import Settings
from viewer.trace.paths.schedule import LEAST
from viewer.trace.tracer import Tracer

SIZE = (72, 56)
PLAIN = Settings(mode="path", spp=3, background="none")


class Hand:
    """A view that rests, and time that passes."""

    def __init__(self, context: Context, scene) -> None:
        self.state = ViewState(scene, PLAIN)
        self.renderer = Renderer(context)
        self.paths = Convergence(context, Programs(context), self.state, lambda camera, settings, size: draw_guide(
            self.renderer, scene, camera, settings, size))
        self.camera, self.size = Camera.framing(scene.center, scene.radius, SIZE[0] / SIZE[1]), SIZE
        self._gl = context.gl

    def follow(self) -> None:
        self.paths.follow(self.camera, self.size)

    def until(self, condition: Callable[[], object]) -> None:
        def step() -> None:
            self.follow()
            self.paths.step()

        wait_until(condition, step)

    def rest(self) -> None:
        """Until there is nothing left to do."""
        self.follow()
        self.until(lambda: self.paths.seconds_until_work == np.inf)

    def shown(self) -> np.ndarray:
        """The picture as displayed, (H, W, 4) uint8, row 0 at the top."""
        target = self._gl.framebuffer([self._gl.renderbuffer(self.size, 4)])
        self.paths.present(self.state.settings, target)
        return np.frombuffer(target.read(components=4), np.uint8).reshape(*self.size[::-1], 4)[::-1].astype(int)


@pytest.fixture(scope="module")
def _hand(context, scene) -> Iterator[Hand]:
    hand = Hand(context, scene)
    yield hand
    hand.paths.release()
    hand.renderer.release()


@pytest.fixture
def hand(_hand, scene, monkeypatch) -> Hand:
    """Of a window just opened, but for what the tracer has prepared."""
    monkeypatch.setattr(convergence, "REST_SECONDS", 0.0)
    _hand.paths.discard()
    vars(_hand.state).update(vars(ViewState(scene, PLAIN)))
    _hand.camera, _hand.size = Camera.framing(scene.center, scene.radius, SIZE[0] / SIZE[1]), SIZE
    return _hand


def test_input_waits_for_few_paths_where_software_draws(hand, context, scene):
    """A step is at least a round of the wavefronts, whatever the time it is given."""
    hand.state.settings = replace(PLAIN, spp=1000)
    hand.follow()
    hand.until(lambda: hand.paths._path_render is not None)
    tracer = Tracer(context)
    alone = tracer.begin(scene, hand.camera, hand.state.settings, SIZE)
    inside, batch = (sum(math.prod(traced.wavefront.size) for traced in render._wavefronts)
                     for render in (hand.paths._path_render, alone))
    alone.release()
    tracer.release()
    assert inside == (batch / 4 if context.is_software else batch)


@pytest.mark.parametrize("denoise", ["off", "fast", "raster"])
def test_converges_to_what_render_makes(hand, context, scene, denoise):
    settings = hand.state.settings = replace(PLAIN, denoise=denoise)
    hand.rest()
    tracer = Tracer(context)
    guide = draw_guide(hand.renderer, scene, hand.camera, settings, SIZE)
    expected = tracer.render(scene, hand.camera, settings, SIZE, guide=guide)
    tracer.release()
    assert np.abs(hand.shown() - expected.srgb).max() <= 1  # sums in another order
    assert hand.paths.is_done and hand.paths.progress.samples == 3
    assert hand.paths.status().endswith("rays/s, done" if denoise == "off" else "denoised, done")
    assert hand.paths.attributes == expected.attributes


def test_nothing_is_shown_before_every_pixel_has_a_sample(hand, monkeypatch):
    monkeypatch.setattr(convergence, "SLICE_SECONDS", 0.0)
    monkeypatch.setattr(shown_film, "UPDATE_SECONDS", (0.0, 0.0))
    seen = []

    def condition() -> bool:
        if hand.paths._path_render is not None:
            seen.append((hand.paths.picture is not None, hand.paths._path_render.film.read_sums()[0][..., 3].min()))
        return hand.paths.is_done

    hand.until(condition)
    assert any(least == 0 for _, least in seen) and all(least > 0 for is_shown, least in seen if is_shown)


def test_it_waits_until_the_view_rests(hand, monkeypatch):
    monkeypatch.setattr(convergence, "REST_SECONDS", 1e3)
    hand.follow()
    assert not hand.paths.step() and 0 < hand.paths.seconds_until_work <= 1e3 and hand.paths.status() == ""


@pytest.mark.parametrize("mode", ["pbr", "phong"])
def test_other_modes_trace_nothing(hand, mode):
    hand.state.show_mode(mode)
    hand.follow()
    assert hand.paths.seconds_until_work == np.inf and not hand.paths.step() and hand.paths.status() == ""


def test_what_the_display_makes_of_the_samples_leaves_them(hand):
    hand.rest()
    progress, before = hand.paths.progress, hand.shown()
    for change in ({"exposure": 1.0}, {"tonemap": "none"}, {"background": (0.1, 0.2, 0.3)}, {"phong": "blinn-phong"}):
        hand.state.settings = replace(hand.state.settings, **change)
        hand.follow()
        assert hand.paths.picture is not None and hand.paths.progress is progress
    hand.state.show_split("pbr", "path")
    hand.state.split = 0.2
    hand.follow()
    assert hand.paths.progress is progress
    assert hand.shown().mean() > before.mean() + 10


@pytest.mark.parametrize("change", ["camera", "size", "scene", "bounces", "background", "programs"])
def test_what_changes_the_samples_begins_anew(hand, change):
    hand.rest()
    assert hand.paths.picture is not None
    if change == "camera":
        hand.camera = replace(hand.camera, fov_y=0.5)
    elif change == "size":
        hand.size = (40, 60)
    elif change == "scene":
        hand.state.set_lights(())
    elif change == "programs":
        assert hand.paths._programs.reload() is None
    elif change == "bounces":
        hand.state.settings = replace(PLAIN, bounces=1)
    else:
        hand.state.settings = replace(PLAIN, background="env")
    hand.follow()
    assert hand.paths.picture is None and hand.paths.progress is None
    hand.rest()
    assert hand.shown().shape == (*hand.size[::-1], 4)


def test_a_pause_keeps_the_picture_as_it_is(hand):
    hand.state.settings = replace(PLAIN, spp=1000)
    hand.until(lambda: hand.paths.picture is not None)
    hand.state.paused = True
    hand.rest()
    rays, picture = hand.paths._path_render.rays, hand.shown()
    assert not hand.paths.step() and hand.paths.status().endswith(", paused")
    assert hand.paths._path_render.rays == rays and np.array_equal(hand.shown(), picture)
    hand.camera = replace(hand.camera, fov_y=0.5)
    hand.follow()
    assert hand.paths.seconds_until_work == np.inf and hand.paths.status() == "Paused"
    hand.state.paused = False
    hand.until(lambda: hand.paths.picture is not None)


def test_the_filter_is_switched_off_without_beginning_anew(hand):
    hand.state.settings = replace(PLAIN, denoise="fast")
    hand.rest()
    progress, filtered = hand.paths.progress, hand.shown()
    hand.state.settings = PLAIN
    hand.rest()
    raw = hand.shown()
    assert hand.paths.denoised == "off" and hand.paths.progress.samples == progress.samples
    assert np.abs(raw - filtered).max() > 10
    hand.state.settings = replace(PLAIN, denoise="fast")
    hand.rest()
    assert hand.paths.denoised == "fast" and np.array_equal(hand.shown(), filtered)


def test_the_filter_begins_anew_where_it_has_no_albedo_to_go_by(hand):
    hand.rest()
    hand.state.settings = replace(PLAIN, denoise="fast")
    hand.follow()
    assert hand.paths.picture is None
    hand.rest()
    assert hand.paths.denoised == "fast"


def test_the_raster_is_drawn_once_it_is_asked_for(hand):
    """What was begun with it is filtered without it, too."""
    hand.state.settings = replace(PLAIN, denoise="fast")
    hand.rest()
    fast = hand.shown()
    hand.state.settings = replace(PLAIN, denoise="raster")
    hand.follow()
    assert hand.paths.picture is None
    hand.rest()
    assert hand.paths.denoised == "raster" and np.abs(hand.shown() - fast).max() > 2
    progress = hand.paths.progress
    hand.state.settings = replace(PLAIN, denoise="fast")
    hand.rest()
    assert hand.paths.progress.samples == progress.samples and hand.paths.denoised == "fast"
    assert np.array_equal(hand.shown(), fast)


def test_a_converged_picture_is_not_filtered(hand, monkeypatch):
    monkeypatch.setattr(shown_film, "CONVERGED", 1e3)
    hand.state.settings = replace(PLAIN, denoise="fast")
    hand.rest()
    assert hand.paths.denoised == "off" and hand.paths.picture is not None


def test_a_time_budget_ends_it(hand):
    hand.state.settings = replace(PLAIN, spp=None, time_budget=0.2)
    hand.rest()
    assert hand.paths.is_done and 0.2 <= hand.paths._path_render.seconds < 10 and hand.paths.picture is not None


def test_an_error_that_is_reached_ends_it(hand, monkeypatch):
    """Before, it went on to the samples without which no error ends a picture."""
    monkeypatch.setattr(shown_film, "UPDATE_SECONDS", (0.0, 0.0))
    hand.state.settings = replace(PLAIN, spp=None, error=0.5)
    hand.rest()
    assert convergence.ENOUGH <= hand.paths.progress.samples < LEAST and hand.paths.progress.error <= 0.5
    assert hand.paths.is_done and hand.paths.picture is not None and hand.paths.status().endswith("done")


def test_compiling_counts_for_no_time_budget(hand, monkeypatch):
    hand.paths._prepared_meshes = None
    hand.state.settings = replace(PLAIN, spp=None, time_budget=0.2)
    hand.until(lambda: hand.paths._path_render is not None)
    assert 0 < hand.paths._compiled == hand.paths._path_render.seconds and not hand.paths.is_done
    hand.rest()
    assert hand.paths._path_render.seconds >= hand.paths._compiled + 0.2


def test_a_time_budget_waits_for_a_sample_of_every_pixel(hand, monkeypatch):
    """As in `render`. Before, what was there was shown as done, and the rest of it black."""
    monkeypatch.setattr(convergence, "SLICE_SECONDS", 0.0)
    hand.state.settings = replace(PLAIN, spp=None, time_budget=1e-3)
    hand.rest()
    assert hand.paths.is_done and hand.paths._path_render.is_whole and hand.paths.progress.samples >= 1


def test_what_is_mixed_with_the_raster_leaves_its_picture_until_there_are_two_samples(hand, monkeypatch):
    """With fewer, the picture would be worse than it was before."""
    monkeypatch.setattr(convergence, "SLICE_SECONDS", 0.0)
    hand.state.settings = replace(PLAIN, spp=None, time_budget=1e-3, denoise="raster")
    hand.rest()
    assert hand.paths.is_done and hand.paths.picture is None and not hand.paths._path_render.film.is_split
    assert hand.paths.status().endswith("done: too few to mix with the real-time picture, which is shown")
    monkeypatch.setattr(convergence, "SLICE_SECONDS", 0.03)
    hand.state.settings = replace(PLAIN, spp=None, time_budget=1e6, denoise="raster")
    hand.follow()
    hand.until(lambda: hand.paths.picture is not None)
    assert hand.paths.denoised == "raster" and hand.paths._path_render.film.is_split


def test_words_do_not_wait_for_the_filter(hand, monkeypatch):
    """It takes seconds where the CPU draws, and far more on a busy one."""
    monkeypatch.setattr(shown_film, "UPDATE_SECONDS", (0.0, 0.0))
    hand.state.settings = replace(PLAIN, spp=1000, denoise="fast")
    hand.until(lambda: hand.paths.picture is not None)
    assert hand.paths._shown._filter_at > hand.paths._path_render.seconds
    hand.paths._shown._filter_at = np.inf
    filtered, words = hand.shown(), hand.paths.status()
    hand.until(lambda: hand.paths.status() != words)
    assert hand.paths.denoised == "fast" and np.array_equal(hand.shown(), filtered)
    hand.state.paused = True
    hand.rest()
    assert not np.array_equal(hand.shown(), filtered), "at rest the picture has all the samples"


def test_progress_in_words():
    assert str(Progress(3.25, 7.4, 9_000_000, 0.0312)) == (
        "3.2 samples a pixel, 7 s, error 3.1 %, 1.2 million rays/s")
    assert str(Progress(1234.0, 100.0, 0, float("inf"))) == "1234 samples a pixel, 100 s"
    assert str(Progress(2.0, 1.0, 0, 1.5)) == "2 samples a pixel, 1 s, error 150 %"


def test_the_window_needs_no_tracer_to_open():
    code = "import sys, viewer.app.window; sys.exit(any(name.startswith('viewer.trace') for name in sys.modules))"
    assert subprocess.run([sys.executable, "-c", code], timeout=PATIENCE_S).returncode == 0
