"""Path tracing in the window, driven by real events."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np

import viewer
from viewer.errors import UsageError
from viewer.image.image import Image
from viewer.scene.camera import Camera
from viewer.settings import Settings

from .conftest import PLAIN
from .test_window import OTHER, SAME, flip

SIZE = (160, 150)
PATHS = replace(PLAIN, mode="path", spp=4)
BELOW = slice(90, None)
"""Rows below the lines that tell how far it is, and the names of a split's sides."""


def rendered(scene, settings: Settings, camera: Camera | None = None) -> np.ndarray:
    camera = camera or scene.framing_camera(SIZE[0] / SIZE[1])
    # Of no use there, but a window's settings are for all its modes.
    settings = replace(settings, antialias="auto") if settings.mode == "path" else replace(settings, spp=None)
    return viewer.render(scene, SIZE, camera, **vars(settings)).srgb[..., :3]


def is_done(hands) -> bool:
    return hands.window.picture.paths.is_done and hands.window.picture.seconds_until_work > 1


def test_begins_with_the_raster_converges_and_lets_the_camera_go(open_window, scene):
    hands = open_window(scene, replace(PATHS, mode="pbr"), SIZE)
    window, paths = hands.window, hands.window.picture.paths
    raster, traced = rendered(scene, PLAIN), rendered(scene, PATHS)
    assert flip(raster[BELOW], traced[BELOW]) > OTHER
    hands.window.do("path")
    assert paths.picture is None and flip(hands.screen()[BELOW], raster[BELOW]) < SAME
    hands.until(lambda: is_done(hands))
    assert flip(hands.screen()[BELOW], traced[BELOW]) < SAME
    hands.drag((80, 70), (104, 82))
    window.orbit.orbit(0.01, 0.0)
    assert flip(hands.screen()[BELOW], rendered(scene, PLAIN, window.orbit.camera)[BELOW]) < SAME
    hands.until(lambda: is_done(hands))
    assert flip(hands.screen()[BELOW], rendered(scene, PATHS, window.orbit.camera)[BELOW]) < SAME
    hands.key("1")
    assert flip(hands.screen(), rendered(scene, PLAIN, window.orbit.camera)) < SAME


def test_split_with_the_raster_and_a_saved_picture(open_window, scene, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    hands = open_window(scene, replace(PATHS, denoise="fast"), SIZE)
    hands.key("9")
    hands.until(lambda: is_done(hands))
    samples = hands.window.picture.paths.progress
    hands.drag((80, 70), (60, 70))
    assert hands.window.state.split == 60 / 160 and hands.window.picture.paths.progress is samples
    raster, traced = rendered(scene, PLAIN), rendered(scene, replace(PATHS, denoise="fast"))
    screen, margin = hands.screen(), 12
    assert flip(screen[BELOW, :60 - margin], raster[BELOW, :60 - margin]) < SAME
    assert flip(screen[BELOW, 60 + margin:], traced[BELOW, 60 + margin:]) < SAME
    hands.key("s")
    saved = Image.open(Path(f"{scene.name}-1.png")).srgb[..., :3]
    assert flip(saved[:, :60], raster[:, :60]) < SAME and flip(saved[:, 60:], traced[:, 60:]) < SAME
    from PIL import Image as Pillow

    with Pillow.open(f"{scene.name}-1.png") as file:
        assert file.text == {"samples": "4 a pixel", "denoised": "fast"}


def test_keys_pause_and_filter(open_window, scene):
    hands = open_window(scene, replace(PATHS, spp=5000), SIZE)
    paths = hands.window.picture.paths
    hands.until(lambda: paths.picture is not None)
    hands.key("space")
    hands.until(lambda: hands.window.picture.seconds_until_work > 1)
    progress = paths.progress
    for _ in range(3):
        hands.window.step(0.02)
    assert paths.progress is progress and "paused" in paths.status()
    hands.key("n")
    hands.key("space")
    hands.until(lambda: paths.denoised == "fast" and paths.picture is not None)
    assert "paused" not in paths.status() and "denoised" in paths.status()


def test_reloaded_shaders_trace_it_anew(open_window, scene):
    hands = open_window(scene, PATHS, SIZE)
    hands.until(lambda: is_done(hands))
    before = hands.screen()
    hands.window.do("reload")
    hands.window._draw()
    assert hands.window.picture.paths.picture is None
    hands.until(lambda: is_done(hands))
    hands.window.state.message = ""
    assert np.abs(hands.screen()[BELOW].astype(int) - before[BELOW]).max() <= 1


def test_what_cannot_be_traced_is_drawn_by_the_raster_with_a_message(open_window, scene, monkeypatch):
    def fail(*_, **__):
        raise UsageError("no room for paths")

    monkeypatch.setattr("viewer.trace.tracer.Tracer.begin", fail)
    hands = open_window(scene, PATHS, SIZE)
    state = hands.window.state
    hands.until(lambda: state.message)
    assert state.is_error and state.message == "no room for paths" and state.modes == ("pbr",)
    state.message = ""
    assert flip(hands.screen(), rendered(scene, PLAIN)) < SAME
