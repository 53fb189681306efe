"""What passes take: each by itself, also where one is drawn in parts within another."""

from __future__ import annotations

import time

import pytest
from shapes import constant, orthographic, scene, sphere

from viewer.raster.renderer import Renderer
from viewer.raster.stopwatch import Stopwatch
from viewer.settings import Settings


class Clock:
    """Also stands for OpenGL, which it waits for."""

    now = 0.0

    def finish(self) -> None:
        pass


def test_a_pass_counts_without_those_in_it(monkeypatch):
    clock = Clock()
    monkeypatch.setattr(time, "perf_counter", lambda: clock.now)
    watch = Stopwatch(clock, measures_passes=True)  # type: ignore[arg-type]
    with watch.drawing("surfaces"):
        for seconds in (1, 2):
            clock.now += 10
            with watch.drawing("background"):
                clock.now += seconds
    assert watch.pass_ms == pytest.approx({"surfaces": 20e3, "background": 3e3})


def test_each_frame_has_times_of_its_own_passes(context):
    """Behind deferred surfaces the background is drawn with them, and is a pass all the same."""
    model, camera = scene(sphere(), environment=constant()), orthographic(height=3.0)
    renderer = Renderer(context, measure=True)
    for antialias, deferred in (("deferred-4", {"deferred surfaces"}), ("none", {"surfaces"})):
        renderer.draw(model, camera, Settings.of(antialias=antialias), (16, 16))
        assert set(renderer.pass_ms) == deferred | {"background", "resolve"}
    renderer.release()
