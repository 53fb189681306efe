"""import viewer: load, render, show; from several threads, and after a fork."""

from __future__ import annotations

import json
import os
import signal
import sys
import threading
from types import SimpleNamespace

import numpy as np
import pytest
from command_line import SCENES
from moderngl import InvalidObject
from needs import needs
from waiting import wait_until

import viewer
from viewer.quality import VARIABLE, Quality
from viewer.shared import shared_renderer

MODEL = SCENES / "unlit.glb"
SIZE = (32, 24)


@pytest.fixture(scope="module")
def scene():
    return viewer.load(MODEL)


def test_a_picture_is_light_and_display(scene):
    image = viewer.render(scene, SIZE)
    assert image.size == SIZE and np.asarray(image).shape == (24, 32, 4) and image.srgb[..., :3].std() > 10
    assert image._repr_png_().startswith(b"\x89PNG") and image.stats["plan"]["draws"] > 0
    assert np.array_equal(viewer.render(scene, SIZE).linear, image.linear)


def test_a_scene_that_nothing_lights_is_warned_of():
    scene = viewer.load(SCENES / "spheres.glb", environment=None)
    with pytest.warns(UserWarning, match="the picture will be black"):
        assert not viewer.render(scene, SIZE).srgb[..., :3].any()


@pytest.mark.parametrize("settings", [{}, {"mode": "path", "spp": 1}])
def test_stats_tell_the_times_and_the_plan(settings):
    scene = viewer.load(MODEL)
    first, second = (viewer.render(scene, SIZE, **settings).stats for _ in range(2))
    for stats in (first, second):
        assert json.loads(json.dumps(stats)) == stats and stats["plan"]["passes"]
        assert 0 <= sum(stats["prepare_s"].values()) <= stats["wall_s"]["render"] < 60
    assert sum(first["prepare_s"].values()) > 0
    if not settings:
        assert "compile and upload" not in second["prepare_s"]


def test_settings_and_camera_count(scene):
    plain = viewer.render(scene, SIZE)
    camera = viewer.Camera.orbit(scene.center, 3 * scene.radius, azimuth=2.0)
    others = [viewer.render(scene, SIZE, camera), viewer.render(scene, SIZE, tonemap="none"),
              viewer.render(scene, SIZE, background="#336699"), viewer.render(viewer.load(MODEL, "sky"), SIZE)]
    assert not any(np.array_equal(plain.srgb, other.srgb) for other in others)
    assert others[2].srgb[0, 0].tolist() == [51, 102, 153, 255]
    assert not viewer.render(viewer.load(MODEL, None), SIZE).linear[0, 0].any()


@pytest.mark.parametrize("arguments", [
    {"size": (0, 5)}, {"size": (5, -1)}, {"size": 5}, {"size": (1.5, 2)}, {"size": "12"}, {"size": (1, 2, 3)},
    {"size": (40000, 40000)}, {"mode": "paths"}, {"colour": "red"}, {"background": "red"}, {"exposure": float("inf")},
    {"backend": "vulkan"}, {"camera": "front"}, {"mode": "path", "aov": "depth"}, {"background": np.zeros(3)},
])
def test_wrong_arguments_are_usage_errors(scene, arguments):
    with pytest.raises(viewer.UsageError):
        viewer.render(scene, **({"size": SIZE} | arguments))


@pytest.mark.parametrize("call, words", [
    (lambda: viewer.load(None), "path is of type NoneType, not a path"),
    (lambda: viewer.load(MODEL, np.zeros((2, 4, 3))), "environment is of type ndarray, not a path"),
    (lambda: viewer.load(MODEL, scene=True), "scene is of type bool, not the number or the name of a scene"),
    (lambda: viewer.render(viewer.load(MODEL), SIZE, time=True), "time is of type bool, not a number of seconds"),
    (lambda: viewer.render(viewer.load(MODEL), SIZE, animation=False), "animation is of type bool, not an animation's"),
    (lambda: viewer.render(MODEL, SIZE), "scene is of type .*, not a Scene"),
    (lambda: viewer.show(MODEL, SIZE), "scene is of type .*, not a Scene"),
    (lambda: viewer.Image.open(None), "path is of type NoneType, not a path"),
    (lambda: viewer.call_glsl("bsdf/ggx.glsl", None), "function is of type NoneType, not the name of one"),
    (lambda: viewer.call_glsl("bsdf/ggx.glsl", "d_ggx", NoH=[1, [2]], s2=1, alpha=1), "^NoH: "),
])
def test_arguments_of_the_wrong_type_are_named(call, words):
    with pytest.raises(viewer.UsageError, match=words):
        call()


def test_bad_files_are_input_errors(tmp_path):
    (tmp_path / "bad.hdr").write_text("#?RADIANCE\n")
    with pytest.raises(viewer.InputError, match="no such file"):
        viewer.load(tmp_path / "none.glb")
    with pytest.raises(viewer.InputError, match="is not an environment"):
        viewer.load(MODEL, environment="moon")
    with pytest.raises(viewer.InputError, match="is not an environment: it is a folder"):
        viewer.load(MODEL, environment=tmp_path)
    with pytest.raises(viewer.InputError, match=r"bad\.hdr"):
        viewer.render(viewer.load(MODEL, environment=tmp_path / "bad.hdr"), SIZE)
    good = viewer.render(viewer.load(MODEL, environment="furnace"), SIZE)  # the renderer is none the worse for it
    assert np.isfinite(good.linear).all()


def test_each_thread_renders_with_a_context_that_goes_with_it(scene):
    expected = viewer.render(scene, SIZE).srgb
    pictures, contexts = [], []

    def work():
        pictures.append(viewer.render(scene, SIZE).srgb)
        contexts.append(shared_renderer().context)

    for _ in range(2):
        threads = [threading.Thread(target=work) for _ in range(2)]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
    assert len(pictures) == 4 and all(np.array_equal(picture, expected) for picture in pictures)
    own = shared_renderer().context
    assert len({id(context) for context in [own, *contexts]}) == 5
    # A thread may be joined a moment before what it held is gone.
    wait_until(lambda: all(isinstance(context.gl.mglo, InvalidObject) for context in contexts))
    assert np.array_equal(viewer.render(scene, SIZE).srgb, expected)


@needs("posix")
@pytest.mark.filterwarnings("ignore:.*multi-threaded.*fork:DeprecationWarning")
def test_after_a_fork_there_is_an_error_and_no_hang(scene):
    viewer.render(scene, SIZE)
    reading, writing = os.pipe()
    child = os.fork()
    if child == 0:
        signal.alarm(20)
        try:
            viewer.render(scene, SIZE)
            answer = "rendered"
        except viewer.ContextError as error:
            answer = str(error)
        os.write(writing, answer.encode())
        os._exit(0)
    os.close(writing)
    with os.fdopen(reading) as pipe:
        assert "forked" in pipe.read()
    assert os.waitpid(child, 0)[1] == 0


@pytest.mark.parametrize("shell", [None, SimpleNamespace()])
def test_elsewhere_show_opens_a_window(scene, monkeypatch, shell):
    monkeypatch.setitem(sys.modules, "IPython", SimpleNamespace(get_ipython=lambda: shell))
    monkeypatch.setattr("viewer.app.open_window", lambda *arguments, quality: opened.append((*arguments, quality)))
    opened: list[tuple] = []
    assert viewer.show(scene, SIZE, mode="phong", quality="high") is None
    given = Quality("high", frozenset({"mode"}))
    assert opened == [(scene, viewer.Settings(mode="phong", denoise="fast"), None, SIZE, given)]
    monkeypatch.delenv(VARIABLE, raising=False)
    viewer.show(scene, SIZE)
    viewer.show(scene, SIZE, time_budget=2.0)  # in mode path, and a key shows mode pbr
    plain, timed = opened[1:]
    assert timed[1].mode == "path" and timed[-1].point == plain[-1].point and timed[-1].reason == plain[-1].reason
