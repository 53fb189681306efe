"""The window, driven by real events; its pictures compared with those made without one."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from needs import needs
from PIL import Image as Pillow
from waiting import PATIENCE_S

import viewer
from viewer.base.resources import resource_folder
from viewer.image.image import Image
from viewer.interact import pace
from viewer.interact.keys import KEYS
from viewer.interact.model_files import ModelFiles
from viewer.measure.compare.difference import compare
from viewer.quality import POINTS, Quality
from viewer.scene.camera import Camera
from viewer.scene.color import srgb_to_linear
from viewer.settings import Settings

from .conftest import PLAIN, SIZE

SAME = 0.005
"""Mean FLIP between two drivers' pictures of the same."""
OTHER = 0.02
"""Mean FLIP of pictures nobody would take for the same."""


def headless(scene, settings: Settings = PLAIN, camera: Camera | None = None) -> np.ndarray:
    camera = camera or scene.framing_camera(SIZE[0] / SIZE[1])
    return viewer.render(scene, SIZE, camera, **vars(settings)).srgb[..., :3]


def flip(a: np.ndarray, b: np.ndarray) -> float:
    return compare(Image.from_srgb(a), Image.from_srgb(b)).flip


def test_shows_what_render_makes_in_both_modes(open_window, scene):
    hands = open_window(scene)
    pbr, phong = headless(scene), headless(scene, replace(PLAIN, mode="phong"))
    assert flip(pbr, phong) > OTHER
    assert flip(hands.screen(), pbr) < SAME
    hands.key("2")
    assert flip(hands.screen(), phong) < SAME
    hands.key("1")
    assert flip(hands.screen(), pbr) < SAME


@pytest.mark.parametrize("key, lobes", [("4", "uniform-diffuse"), ("5", "specular"), ("6", "directional-diffuse")])
def test_number_keys_show_single_contributions(open_window, scene, key, lobes):
    hands = open_window(scene)
    hands.key(key)
    assert flip(hands.screen(), headless(scene, replace(PLAIN, lobes=lobes))) < SAME


def test_split_shows_both_modes_and_its_line_is_dragged(open_window, scene):
    hands = open_window(scene)
    pbr, phong = headless(scene), headless(scene, replace(PLAIN, mode="phong"))
    hands.key("3")
    screen, margin = hands.screen(), 12
    assert flip(screen[40:, :160 - margin], phong[40:, :160 - margin]) < SAME
    assert flip(screen[40:, 160 + margin:], pbr[40:, 160 + margin:]) < SAME
    azimuth = hands.window.orbit.azimuth
    hands.drag((160, 200), (80, 180))
    assert hands.window.state.split == pytest.approx(0.25, abs=1e-6)
    assert hands.window.orbit.azimuth == azimuth
    screen = hands.screen()
    assert flip(screen[40:, :80 - margin], phong[40:, :80 - margin]) < SAME
    assert flip(screen[40:, 80 + margin:], pbr[40:, 80 + margin:]) < SAME


def test_drag_orbits_and_the_picture_is_that_of_the_new_camera(open_window, scene):
    hands = open_window(scene)
    orbit = hands.window.orbit
    azimuth, elevation, before = orbit.azimuth, orbit.elevation, hands.screen()
    hands.drag((160, 120), (184, 144))
    assert orbit.azimuth == pytest.approx(azimuth - np.pi * 0.1, abs=1e-9)
    assert orbit.elevation == pytest.approx(elevation + np.pi * 0.1, abs=1e-9)
    after = hands.screen()
    assert flip(after, before) > OTHER
    assert flip(after, headless(scene, camera=orbit.camera)) < SAME
    hands.window.step(0.05)
    assert np.array_equal(hands.screen(), after)  # inertia is off


@pytest.mark.parametrize("button", [2, 3])
def test_other_buttons_pan_what_is_under_the_cursor(open_window, scene, button):
    hands = open_window(scene)
    before = hands.screen().astype(float)
    hands.drag((160, 120), (184, 108), button=button)
    after = hands.screen().astype(float)
    # The content moved by (24, -12): best of all shifts tried.
    window = (slice(60, 180), slice(80, 240))

    def error(dx, dy):
        return np.abs(after[window] - np.roll(before, (dy, dx), (0, 1))[window]).mean()

    shifts = [(dx, dy) for dx in range(-36, 37, 4) for dy in range(-24, 25, 4)]
    assert min(shifts, key=lambda shift: error(*shift)) == (24, -12)


def test_wheel_comes_closer_to_what_is_under_the_cursor(open_window, scene):
    from viewer.interact.pick import pick

    hands = open_window(scene)
    orbit = hands.window.orbit
    point = pick(scene, orbit.camera, SIZE, (110, 100))
    assert point is not None
    distance = np.linalg.norm(orbit.camera.eye - point)
    hands.click(110, 100, "--repeat", 3, button=4)
    assert np.linalg.norm(orbit.camera.eye - point) == pytest.approx(distance * 0.88**3, rel=1e-9)
    assert np.allclose(pick(scene, orbit.camera, SIZE, (110, 100)), point, atol=1e-6 * scene.radius)
    hands.click(110, 100, "--repeat", 3, button=5)
    assert np.linalg.norm(orbit.camera.eye - point) == pytest.approx(distance, rel=1e-9)


@pytest.mark.parametrize("how", ["double click", "shift click"])
def test_a_click_centres_on_what_is_under_the_cursor(open_window, scene, how):
    from viewer.interact.pick import pick

    hands = open_window(scene)
    orbit = hands.window.orbit
    framed, point = orbit.target.copy(), pick(scene, orbit.camera, SIZE, (110, 100))
    if how == "double click":
        hands.click(110, 100, "--repeat", 2, "--delay", 20)
    else:
        hands.move(110, 100)
        hands.xdotool("keydown", "shift", "click", 1, "keyup", "shift")
    assert np.allclose(orbit.target, point, atol=1e-9 * scene.radius)
    hands.key("f")
    assert np.allclose(orbit.target, framed, atol=1e-9 * scene.radius)


def test_standard_views(open_window, scene):
    hands = open_window(scene)
    orbit = hands.window.orbit
    looks = {"z": (0, 0, -1), "shift+z": (0, 0, 1), "x": (-1, 0, 0), "shift+x": (1, 0, 0), "y": (0, -1, 0),
             "shift+y": (0, 1, 0)}
    for key, forward in looks.items():
        hands.key(key)
        assert np.allclose(orbit.camera.forward, forward, atol=1e-12), key
    assert flip(hands.screen(), headless(scene, camera=orbit.camera)) < SAME
    hands.key("o")
    assert orbit.camera.height is not None
    assert flip(hands.screen(), headless(scene, camera=orbit.camera)) < SAME


def test_the_files_own_cameras(open_window, scene):
    own = (Camera.orbit(scene.center, 2 * scene.radius, 1.0, 0.5),
           Camera(np.eye(4), height=2 * scene.radius, name="flat"))
    hands = open_window(replace(scene, cameras=own))
    for camera in (*own, own[0]):
        hands.key("c")
        shown = hands.window.orbit.camera
        assert np.allclose(shown.pose[:3, :3], camera.pose[:3, :3], atol=1e-9)
        assert flip(hands.screen()[:180], headless(scene, camera=camera)[:180]) < SAME  # above the message
    assert "Camera 1 of 2" in hands.window.state.message


def test_screenshot_is_the_picture_under_a_free_name(open_window, scene, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    hands = open_window(scene, Settings())
    hands.key("Tab")
    hands.key("s", "F12", "ctrl+s")
    names = [f"{Path(scene.name).stem}-{k}.png" for k in (1, 2, 3)]
    assert sorted(path.name for path in tmp_path.iterdir()) == names
    assert f"Saved {tmp_path / names[2]}" == hands.window.state.message
    assert flip(Image.open(names[0]).srgb[..., :3], headless(scene, Settings())) < SAME


def test_a_picture_at_rest_is_saved_without_being_drawn_again(open_window, scene, tmp_path, monkeypatch):
    """Or else it would be replaced by the simpler one of movement for a moment, and its error measured again."""
    monkeypatch.chdir(tmp_path)
    hands = open_window(scene, Settings(), quality=Quality("standard"))
    window, drawn = hands.window, []
    draw = window.renderer.draw
    monkeypatch.setattr(window.renderer, "draw", lambda *given, **named: drawn.append(given) or draw(*given, **named))
    hands.key("s")
    assert not drawn and window.picture.is_refined
    window.orbit.orbit(0.1, 0.0)
    window.do("screenshot")
    assert drawn
    first, second = (Image.open(f"{Path(scene.name).stem}-{k}.png").srgb for k in (1, 2))
    assert flip(first[..., :3], second[..., :3]) > OTHER


def test_screenshot_where_nothing_can_be_written(open_window, scene, tmp_path, monkeypatch):
    hands = open_window(scene)
    missing = tmp_path / "gone"
    missing.mkdir()
    monkeypatch.chdir(missing)
    missing.rmdir()
    hands.key("s")
    assert hands.window.state.is_error and "current folder" in hands.window.state.message


def test_a_status_longer_than_the_picture_is_wide_is_wrapped(open_window, scene, monkeypatch):
    hands = open_window(scene)
    before = hands.screen()
    monkeypatch.setattr(hands.window.picture, "status", lambda: "too few to mix with the real-time picture " * 3)
    rows, columns = np.nonzero((hands.screen() != before).any(axis=-1))
    assert rows.max() > 38 + 30 and columns.max() < SIZE[0] - 5  # below its first line, and not up to the right edge


def test_dropped_files_are_opened_and_bad_ones_told(open_window, scene, tmp_path):
    hands = open_window(scene)
    window = hands.window
    before = hands.screen()
    for bad in ("broken.glb", "broken.hdr"):
        (tmp_path / bad).write_bytes(b"glTF nothing")
        window.open([str(tmp_path / bad)])
        hands.settle()
        assert window.state.is_error and bad in window.state.message and "\n" not in window.state.message
        assert window.state.scene is scene
    window.state.message = ""
    assert np.array_equal(hands.screen(), before)
    model = resource_folder("assets") / "scenes" / "textures.glb"
    window.open([str(model)])
    hands.settle()
    opened = viewer.load(model)
    assert window.state.scene.environment is scene.environment
    assert flip(hands.screen(), headless(opened)) < SAME


def test_a_model_that_cannot_be_drawn_gives_way_to_the_one_before(open_window, scene, monkeypatch):
    broken = viewer.load(resource_folder("assets") / "scenes" / "textures.glb")
    image = next(m.base_color_texture.image for m in broken.materials if m.base_color_texture)

    def fail(*_):
        raise viewer.InputError("textures.glb", "images[0]", "is broken")

    monkeypatch.setattr(type(image), "decode", fail)
    hands = open_window(scene, files=ModelFiles(load=lambda _: broken))
    before = hands.screen()
    hands.window.open(["textures.glb"])
    hands.settle()
    state = hands.window.state
    assert state.scene is scene and state.is_error and state.message == "textures.glb: images[0]: is broken"
    state.message = ""
    assert np.array_equal(hands.screen(), before)


def test_shaders_are_reloaded_and_broken_ones_leave_the_old(open_window, scene, tmp_path, monkeypatch):
    shaders = tmp_path / "shaders"
    shutil.copytree(resource_folder("shaders"), shaders)
    monkeypatch.setattr("viewer.gpu.source.resource_folder", lambda _: shaders)
    hands = open_window(scene)
    state, before = hands.window.state, hands.screen()
    display = shaders / "display" / "display.frag"
    text = display.read_text()

    def clean() -> np.ndarray:
        state.message = ""
        return hands.screen()

    display.write_text(text.replace("void main() {", "void main() {\n    nonsense;"))
    hands.until(lambda: state.message)
    line = text[:text.index("void main() {")].count("\n") + 2
    assert state.is_error and f"display.frag:{line}: " in state.message and "nonsense" in state.message
    assert np.array_equal(clean(), before)
    display.write_text(text[:text.rindex("}")] + "o_color.rgb *= 0.5;\n}\n")
    hands.until(lambda: state.message)
    assert state.message == "Shaders reloaded" and not state.is_error
    assert clean().mean() == pytest.approx(before.mean() / 2, abs=1)
    display.write_text(text)
    hands.until(lambda: state.message)
    assert np.array_equal(clean(), before)


def test_help_overlay_and_closing(open_window, scene):
    hands = open_window(scene)
    before = hands.screen()
    hands.key("h")
    assert flip(hands.screen(), before) > OTHER
    hands.key("Escape")
    assert not hands.window.state.help and not hands.window.is_closed
    hands.key("Escape")
    assert hands.window.is_closed


def test_every_key_of_the_table_does_something(open_window, scene, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    hands = open_window(scene)
    for binding in KEYS:
        hands.window.do(binding.action)
        hands.settle()


def test_inertia_carries_on_and_ends(open_window, scene):
    hands = open_window(scene)
    orbit = hands.window.orbit
    throw = ("mousedown", 1, *("mousemove_relative", "--sync", 6, 0) * 4, "mouseup", 1)
    for inertia in (False, True):
        hands.move(100, 200)
        azimuth = orbit.azimuth
        hands.xdotool(*throw)
        turned = azimuth - orbit.azimuth
        if inertia:
            assert turned > 1.5 * np.pi * 24 / 240 and not orbit.velocity.any()
        else:
            assert turned == pytest.approx(np.pi * 24 / 240, abs=1e-9)
        hands.key("i")


def test_resizing_and_sizes_of_nothing(open_window, scene, monkeypatch):
    import glfw

    hands = open_window(scene)
    glfw.set_window_size(hands.window.window, 200, 260)
    hands.until(lambda: hands.window._pixels == (200, 260))
    screen = hands.screen()
    assert screen.shape == (260, 200, 3)
    camera = hands.window.orbit.camera
    expected = viewer.render(scene, (200, 260), camera, **vars(PLAIN)).srgb[..., :3]
    assert flip(screen, expected) < SAME
    monkeypatch.setattr(glfw, "get_framebuffer_size", lambda _: (0, 0))  # minimised, on some desktops
    hands.window._input.changed = True
    hands.settle()


def test_an_idle_window_draws_nothing(open_window, scene, monkeypatch):
    hands = open_window(scene)
    drawn = []
    monkeypatch.setattr(hands.window, "_draw", lambda: drawn.append(1))
    for _ in range(3):
        hands.window.step(timeout=0.05)
    assert not drawn


def test_a_picture_that_moves_too_slowly_has_fewer_pixels_until_it_rests(open_window, scene, monkeypatch):
    hands = open_window(scene)
    window = hands.window
    monkeypatch.setattr(pace, "FRAME_SECONDS", 1e6)  # whatever the load, no frame takes too long
    window.do("view_front")
    hands.settle()
    at_rest = hands.screen()
    monkeypatch.setattr(pace, "FRAME_SECONDS", 1e-6)  # every frame takes too long,
    monkeypatch.setattr(pace, "STILL_SECONDS", 1e6)  # and follows the last one fast enough
    window.do("view_right")  # tells how slow it is
    assert hands.screen().shape == at_rest.shape and window.picture.size == SIZE
    window.do("view_front")
    moving = hands.screen()
    assert window.picture.size == (round(SIZE[0] / 8**0.5), round(SIZE[1] / 8**0.5))
    assert not window.picture.is_refined and window.picture.seconds_until_work > 1
    enlarged = Pillow.fromarray(window.picture.shown()).resize(SIZE, Pillow.Resampling.BILINEAR)
    assert np.abs(moving - np.asarray(enlarged, int)).max() <= 2
    assert SAME < flip(moving, at_rest) < 5 * OTHER
    monkeypatch.setattr(pace, "STILL_SECONDS", 0.1)
    hands.settle()
    assert window.picture.size == SIZE and np.array_equal(hands.screen(), at_rest)


def test_a_picture_at_rest_is_refined_where_software_draws(open_window, scene):
    """A graphics card takes all samples in every frame."""
    hands = open_window(scene, Settings())
    hands.window.do("view_front")
    moving = hands.screen()
    hands.settle()
    still, expected = hands.screen(), headless(scene, Settings(), hands.window.orbit.camera)
    assert flip(still, expected) < SAME
    if hands.window.context.is_software:
        assert flip(moving, expected) > 2 * flip(still, expected) and not np.array_equal(moving, still)
    else:
        assert flip(moving, expected) < SAME


def test_a_picture_at_rest_has_the_quality_and_a_moving_one_has_not(open_window, scene):
    hands = open_window(scene, PLAIN)
    window = hands.window
    window.do("view_front")
    draft = hands.screen()
    window.state.quality = Quality("standard", frozenset({"antialias"}))
    assert np.array_equal(hands.screen(), draft) and not window.picture.is_refined
    hands.settle()
    at_rest = replace(PLAIN, **{name: value for name, value in POINTS["standard"].items() if name != "antialias"})
    assert window.state.at_rest == at_rest and window.picture.is_refined
    expected = headless(scene, at_rest, window.orbit.camera)
    assert flip(hands.screen(), expected) < SAME < flip(draft, expected)


def test_media_at_rest_are_refined_where_software_draws(open_window, scene):
    """Without antialiasing, nothing but their rays and steps is refined."""
    grains = np.random.default_rng(1).uniform(0, 1, (8, 8, 8)).astype(np.float32)
    cloud = replace(scene, volumes=(viewer.Volume.in_box(grains, scene.bounds),))
    settings = replace(PLAIN, volume_density=20.0)
    hands = open_window(cloud, settings)
    hands.window.do("view_front")
    moving = hands.screen()
    assert hands.window.picture.is_refined == (not hands.window.context.is_software)
    hands.settle()
    still, expected = hands.screen(), headless(cloud, settings, hands.window.orbit.camera)
    assert flip(still, expected) < SAME
    if hands.window.context.is_software:
        assert flip(moving, expected) > 2 * flip(still, expected) and not np.array_equal(moving, still)


def test_no_display_is_one_clear_error(scene, monkeypatch):
    from viewer import app
    from viewer.errors import ContextError

    monkeypatch.setattr("glfw.create_window", lambda *_: None)
    monkeypatch.setattr("glfw.get_error", lambda: (0, b"X11: Failed to open display"))
    with pytest.raises(ContextError, match="window: X11: Failed to open display") as caught:
        app.open_window(scene, PLAIN)
    assert "\n" not in str(caught.value)


def test_a_long_message_is_shown_whole(open_window, scene):
    hands = open_window(scene)
    before = hands.screen().astype(int)
    hands.window.state.say("/a/folder/model.glb: accessors[3].count: 70000 elements do not fit in bufferView 2", True)
    changed = np.argwhere(np.abs(hands.screen() - before).sum(axis=2) > 60)
    assert changed[:, 1].min() >= 10 and 280 < changed[:, 1].max() < SIZE[0] - 10  # with a margin at both sides
    assert changed[:, 0].max() - changed[:, 0].min() > 40  # two lines


@needs("xvfb", "xdotool")
def test_the_command_opens_it_and_a_key_closes_it(display, scene, tmp_path):
    """`python -m viewer view`, from the command line to the picture it saves."""
    model = resource_folder("assets") / "scenes" / "spheres.glb"
    process = subprocess.Popen([sys.executable, "-m", "viewer", "view", model, "--size", "160x120", "--mode", "phong",
                                "--background", "#777777", "--set", "antialias=none", "-v"], cwd=tmp_path,
                               stderr=subprocess.PIPE, text=True)
    try:
        find = ["xdotool", "search", "--sync", "--onlyvisible", "--pid", str(process.pid)]
        window = subprocess.run(find, capture_output=True, text=True, timeout=PATIENCE_S, check=True).stdout.split()[0]
        subprocess.run(["xdotool", "windowfocus", "--sync", window], check=True, timeout=PATIENCE_S)
        subprocess.run(["xdotool", "key", "s", "q"], check=True, timeout=PATIENCE_S)
        told = process.communicate(timeout=PATIENCE_S)[1].splitlines()
        assert process.returncode == 0
    finally:
        process.kill()
    assert [line.partition(": ")[0] for line in told] == [str(model), "window", "first picture"]
    assert "load " in told[0] and "OpenGL" in told[1] and "compile and upload" in told[2] and "plan: " in told[2]
    camera = scene.framing_camera(160 / 120)
    grey = tuple(float(c) for c in srgb_to_linear(np.full(3, 0x77 / 255)))
    expected = viewer.render(scene, (160, 120), camera, mode="phong", background=grey, antialias="none")
    assert flip(Image.open(tmp_path / f"{scene.name}-1.png").srgb[..., :3], expected.srgb[..., :3]) < SAME


@needs("linux")  # elsewhere there is always a desktop
def test_the_command_without_a_display_says_so_in_one_line(tmp_path):
    environment = {k: v for k, v in os.environ.items() if k not in ("DISPLAY", "WAYLAND_DISPLAY")}
    model = resource_folder("assets") / "scenes" / "spheres.glb"
    done = subprocess.run([sys.executable, "-m", "viewer", "view", model], env=environment, capture_output=True,
                          text=True, timeout=PATIENCE_S)
    assert done.returncode == 3 and done.stdout == ""
    assert done.stderr.startswith("pbr-viewer: window: ") and done.stderr.count("\n") == 1
