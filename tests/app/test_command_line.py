"""The command line that makes what a window shows: parsed again, it has the same settings, camera and light."""

from __future__ import annotations

import json
import math
import shlex
from dataclasses import fields, replace
from pathlib import Path
from statistics import median

import numpy as np
import pytest

import viewer
from viewer.app.tips import MEASURED, tip_of
from viewer.base.resources import resource_folder
from viewer.commands.pictures import render
from viewer.interact.command_line import command_line
from viewer.interact.model_files import ModelFiles
from viewer.interact.orbit import OrbitController
from viewer.interact.playback import Playback
from viewer.interact.state import ViewState
from viewer.jobs.assemble import make_environment, make_quality, make_scene, make_settings
from viewer.jobs.views import views_of
from viewer.quality import VARIABLE, Quality
from viewer.scene.camera import Camera
from viewer.scene.light import Light
from viewer.settings import Settings, ignored

MODEL = str(resource_folder("assets") / "scenes" / "lights.glb")
SIZE = (320, 200)


@pytest.fixture(scope="module")
def model():
    return viewer.load(MODEL)


def parsed(line: str):
    """Settings, scene and camera of a line, as `render` makes them."""
    name, command, *words = shlex.split(line)
    assert (name, command) == ("pbr-viewer", "render")
    options = dict(render.make_context("render", words).params)
    [path] = options.pop("models")
    settings = make_settings(options)
    scene = make_scene(path, make_environment(options), options)
    [view] = views_of(path, scene, options)
    return make_quality(options, settings, scene, SIZE).applied(settings), scene, view.camera, options


def used(settings: Settings) -> dict[str, object]:
    """The settings of its mode."""
    return {f.name: getattr(settings, f.name) for f in fields(settings) if f.name not in ignored(settings.mode)}


SETTINGS = {
    "plain": Settings(),
    "many": Settings(ndf="beckmann", fog=0.25, fog_albedo=(0.5, 0.25, 1.0), hair_melanin=(1.0, 0.5), exposure=-1.5,
                     tonemap="agx", background="none", show="normal", grid="on", ground="shadow", denoise="fast"),
    "phong": Settings(mode="phong", phong="blinn-phong", background_blur=2.5, weave="twill,wood"),
    "path": Settings(mode="path", spp=12, seed=3, denoise="fast", bounces=5, clamp=0.5, light_radius=0.125),
}


@pytest.mark.parametrize("name", SETTINGS)
def test_settings_come_back(model, name):
    state = ViewState(model, SETTINGS[name])
    line = command_line(state, OrbitController(model, 1.6), SIZE, ModelFiles(MODEL))
    settings, _, _, options = parsed(str(line))
    assert used(settings) == used(state.settings) and line.lost == ()
    assert (options["size"], options["output"]) == (SIZE, "lights.png")


def test_the_quality_comes_back_where_render_would_choose_another(model, monkeypatch):
    monkeypatch.setenv(VARIABLE, "high")
    state = ViewState(model, Settings(), quality=Quality("draft"))
    settings, *_ = parsed(str(command_line(state, OrbitController(model, 1.6), SIZE, ModelFiles(MODEL))))
    assert settings == state.at_rest


def test_an_empty_variable_names_no_quality(model, monkeypatch):
    monkeypatch.setenv(VARIABLE, "")
    empty = Quality.of(None, (), Settings(), model, SIZE)
    monkeypatch.delenv(VARIABLE)
    assert empty == Quality.of(None, (), Settings(), model, SIZE)


def test_the_quality_comes_back_with_what_was_chosen_beside_it(model):
    state = ViewState(model, Settings(), quality=Quality("high"))
    state.choose("refraction", "screen")
    state.choose("masking", "none")
    settings, *_ = parsed(str(command_line(state, OrbitController(model, 1.6), SIZE, ModelFiles(MODEL))))
    assert settings == state.at_rest and settings.reflections == "traced" and settings.refraction == "screen"


@pytest.mark.parametrize("changes", [{}, {"environment_shadows": "64"}, {"environment_shadows": "off"},
                                     {"ambient_occlusion": "gtao"}])
def test_fewer_lights_than_the_quality_has_by_its_name_come_back(model, changes):
    state = ViewState(model, Settings(), quality=Quality("standard", lights=16))
    for name, value in changes.items():
        state.choose(name, value)
    settings, *_ = parsed(str(command_line(state, OrbitController(model, 1.6), SIZE, ModelFiles(MODEL))))
    assert settings == state.at_rest
    assert settings.environment_shadows == changes.get("environment_shadows", "off" if changes else "16")


@pytest.mark.parametrize("view", ["turned", "top", "flat", "wide", "own"])
def test_the_camera_comes_back(model, view):
    own = Camera.orbit((0, 0, 0), 4.0, 1.0, 0.4)
    scene = replace(model, cameras=(own,))
    orbit = OrbitController(scene, SIZE[0] / SIZE[1], 0.7 if view == "wide" else math.pi / 4)
    orbit.look_from(0.3, math.pi / 2 if view == "top" else -0.2)
    orbit.pan(0.1, 0.2)
    orbit.dolly(0.7, scene.center)
    orbit.is_orthographic = view == "flat"
    if view == "own":
        orbit.follow(own, 2.0)
    line = command_line(ViewState(scene, Settings()), orbit, SIZE, ModelFiles(MODEL))
    if view == "own":
        assert "--camera 0" in str(line) and line.lost == ()
        return
    *_, camera, _ = parsed(str(line))
    assert np.allclose(camera.pose, orbit.camera.pose, rtol=0, atol=1e-9 * scene.radius)
    assert camera.fov_y == pytest.approx(orbit.camera.fov_y, rel=1e-10)
    assert camera.height == (None if orbit.camera.height is None else pytest.approx(orbit.camera.height, rel=1e-9))


def test_light_comes_back_and_what_cannot_be_said_is_named(model):
    sun = Light.from_angles(0.4, 0.9, 2.5)
    state = ViewState(replace(model, environment=replace(viewer.load(MODEL, "sky").environment, rotation=0.5,
                                                         intensity=2.0)), Settings(background=(0.0, 1.0, 1.0)))
    state.set_lights((*state.scene.lights, sun))
    line = command_line(state, OrbitController(model, 1.6), SIZE, ModelFiles(MODEL))
    settings, scene, *_ = parsed(str(line))
    environment = scene.environment
    assert line.lost == () and settings.background == (0.0, 1.0, 1.0)
    assert (environment.name, environment.intensity) == ("sky", 2.0) and environment.rotation == pytest.approx(0.5)
    assert len(scene.lights) == len(state.scene.lights) and scene.lights[-1].intensity == 2.5
    assert np.allclose(scene.lights[-1].direction, sun.direction, atol=1e-9)
    state.set_lights(state.scene.lights[1:])
    state.toggle_furnace()
    line = command_line(state, OrbitController(model, 1.6), SIZE, ModelFiles())
    assert line.lost == ("the white furnace", "changes of the file's lights", "the model, which has no file")


def test_an_animation_an_environments_file_and_the_files_words_are_there(model, tmp_path):
    from viewer.image.image import Image

    Image.from_srgb(np.zeros((4, 8, 3), np.uint8)).save(tmp_path / "a map.png")
    lit = viewer.load(MODEL, tmp_path / "a map.png")
    state = ViewState(lit, Settings(mode="path"), playback=Playback(animation=1, time=0.25))
    files = ModelFiles(MODEL, words=lambda path: ["--up", "z"])
    words = command_line(state, OrbitController(model, 1.6), SIZE, files, samples=37.6).words
    text = shlex.join(words)
    for part in ("--animation 1 --time 0.25", "--up z", shlex.join(["--env", str(tmp_path / "a map.png")]), "--spp 38"):
        assert part in text


def test_the_window_copies_it_prints_it_and_says_so(open_window, scene, capsys):
    import glfw

    hands = open_window(scene, files=ModelFiles(MODEL))
    hands.key("ctrl+c")
    [line] = capsys.readouterr().out.splitlines()
    assert glfw.get_clipboard_string(None).decode() == line
    assert hands.window.state.message == "Copied the command line"
    _, _, camera, _ = parsed(line)
    assert np.allclose(camera.pose, hands.window.orbit.camera.pose, atol=1e-9)


def test_a_label_tells_what_it_does_where_the_mouse_is(open_window, scene, monkeypatch):
    from viewer.app import widgets

    hands = open_window(scene, size=(640, 480))
    hands.key("Tab")
    shown, text = [], widgets.imgui.text_unformatted
    monkeypatch.setattr(widgets.imgui, "text_unformatted", lambda line: (shown.append(line), text(line)))
    hands.move(330, 99)  # the label "Show"
    hands.window._draw()
    assert tip_of("Show") in shown


def test_what_tooltips_say_was_measured():
    rows = json.loads((Path(__file__).parents[2] / "benchmarks" / "results" / "reach.json").read_text())["rows"]
    for setting, (method, error, times) in MEASURED.items():
        found = [([m for m in row["methods"] if method in (m["family"], m["label"])], row) for row in rows]
        best = [(min(methods, key=lambda m: m["relmse"]), row) for methods, row in found if methods]
        assert median(m["relmse"] / row["plain"] for m, row in best) == pytest.approx(error, abs=0.006), setting
        assert median(m["ms"] / row["plain_ms"] for m, row in best) == pytest.approx(times, abs=0.06), setting
