"""The command line's words: numbers, colours, cameras, lights."""

from __future__ import annotations

import math

import click
import numpy as np
import pytest
from command_line import SCENES

from viewer.errors import InputError, UsageError
from viewer.jobs.assemble import make_camera, make_light
from viewer.jobs.camera_options import Grid, Views, check_camera_options
from viewer.jobs.directions import directions_of
from viewer.jobs.options import BackgroundColor, Number, Numbers, PlainMaterial, Size
from viewer.scene.load import load_scene

NO_CAMERA = dict.fromkeys(("view", "eye", "target", "fov", "camera")) | {
    "size": (200, 100), "orbit": (), "ortho": False}


@pytest.fixture(scope="module")
def scene():
    return load_scene(SCENES / "lights.glb")


def camera(scene, **options):
    return make_camera("m.glb", scene, NO_CAMERA | options)


@pytest.mark.parametrize("kind, word, value", [
    (Size(), "640x480", (640, 480)), (Size(), "640X480", (640, 480)), (Size(), "64", (64, 64)),
    (Number(), "-2.5", -2.5), (Number(0, 1), "1", 1.0),
    (Numbers("X,Y,Z", 3), "-1,2e3,.5", (-1, 2000, 0.5)), (Numbers("A,B[,C]", 2, 3), "1, 2", (1, 2)),
    (Views(), "top,iso,top", ("top", "iso")), (Grid(), "4x2", (4, 2)),
    (PlainMaterial(), "gold,1,.25", "#ffd700,1,0.25"), (PlainMaterial(), "#08f", "#0088ff,0,0.5"),
    (BackgroundColor(), "none", "none"), (BackgroundColor(), "#ffffff", (1, 1, 1)),
])
def test_words_that_are_understood(kind, word, value):
    assert kind.convert(word, None, None) == value


@pytest.mark.parametrize("kind, word", [
    (Size(), ""), (Size(), "x"), (Size(), "1x"), (Size(), "0x1"), (Size(), "-1x1"), (Size(), "1x1x1"),
    (Size(), "1.5x2"), (Size(), "1000000"), (Size(), "\u0663x3"),
    (Number(), "nan"), (Number(), "inf"), (Number(), "1,5"), (Number(0, 1), "2"),
    (Numbers("X,Y,Z", 3), "1,2"), (Numbers("X,Y,Z", 3), "1,2,nan"), (Numbers("X,Y,Z", 3), "1,2,"),
    (Numbers("X,Y,Z", 3), "1,2,1e19"),
    (Views(), ""), (Views(), "front,up"), (Grid(), "4"), (Grid(), "0x2"), (Grid(), "4x2x1"),
    (PlainMaterial(), "glod"), (PlainMaterial(), "gold,2"), (PlainMaterial(), "gold,0,0,0"),
    (PlainMaterial(), "red,nan"), (PlainMaterial(), "#ff000080"),
    (BackgroundColor(), "#12345"), (BackgroundColor(), "ENV"), (BackgroundColor(), ""),
])
def test_words_that_are_not(kind, word):
    with pytest.raises(click.BadParameter):
        kind.convert(word, None, None)


def test_without_options_the_model_is_framed(scene):
    plain = camera(scene)
    assert plain.fov_y == pytest.approx(math.radians(45))
    azimuth, elevation = math.radians(30), math.radians(15)
    back = [math.cos(elevation) * math.sin(azimuth), math.sin(elevation), math.cos(elevation) * math.cos(azimuth)]
    assert -plain.forward == pytest.approx(back, abs=1e-12)
    np.testing.assert_array_equal(plain.pose, scene.framing_camera(2.0).pose)


def test_direction_field_of_view_and_shape_of_the_picture_are_framed(scene):
    tall = camera(scene, orbit=((-20, 40),), fov=20, size=(100, 200))
    expected = scene.framing_camera(0.5, math.radians(-20), math.radians(40), math.radians(20))
    np.testing.assert_array_equal(tall.pose, expected.pose)
    aimed = camera(scene, target=(1, 2, 0))
    np.testing.assert_array_equal(aimed.pose, scene.framing_camera(2.0, target=(1, 2, 0)).pose)


def test_orbit_eye_and_target(scene):
    assert camera(scene, orbit=((90, 0, 2),)).eye == pytest.approx(scene.center + [2, 0, 0])
    assert camera(scene, orbit=((0, 90),)).forward == pytest.approx([0, -1, 0], abs=1e-12)
    assert camera(scene, orbit=((0, 0, 3),), target=(5, 6, 7)).eye == pytest.approx([5, 6, 10])
    looking = camera(scene, eye=(0, 0, 9), target=(0, 0, 1), fov=20)
    assert looking.forward == pytest.approx([0, 0, -1]) and looking.fov_y == pytest.approx(math.radians(20))


@pytest.mark.parametrize("name, back", [
    ("front", (0, 0, 1)), ("back", (0, 0, -1)), ("left", (-1, 0, 0)), ("right", (1, 0, 0)), ("top", (0, 1, 0)),
    ("bottom", (0, -1, 0)), ("iso", np.ones(3) / math.sqrt(3))])
@pytest.mark.parametrize("ortho", [False, True])
def test_views_have_names(scene, name, back, ortho):
    """From above, the front is at the lower side of the picture, and from below at the upper one."""
    seen = camera(scene, view=(name,), ortho=ortho)
    assert -seen.forward == pytest.approx(back, abs=1e-12)
    up = {"top": (0, 0, -1), "bottom": (0, 0, 1)}.get(name)
    assert up is None or seen.pose[:3, 1] == pytest.approx(up, abs=1e-12)
    assert (seen.height is not None) == ortho


def test_without_perspective_as_much_is_shown_at_the_target(scene):
    flat = camera(scene, orbit=((0, 0, 3),), ortho=True, fov=60)
    assert flat.height == pytest.approx(6 * math.tan(math.radians(30)))
    looking = camera(scene, eye=(0, 0, 9), target=(0, 0, 1), fov=60, ortho=True)
    assert looking.height == pytest.approx(16 * math.tan(math.radians(30)))


def test_the_files_own_camera(scene):
    own = camera(scene, camera=0)
    assert own is scene.cameras[0]
    assert camera(scene, camera=0, fov=20).fov_y == pytest.approx(math.radians(20))
    with pytest.raises(InputError, match=r"m\.glb: cameras: --camera 9: the file has \d"):
        camera(scene, camera=9)


def test_an_eye_in_the_middle_needs_a_target(scene):
    with pytest.raises(UsageError, match="give a --target"):
        camera(scene, eye=tuple(scene.center))


@pytest.mark.parametrize("given", [
    {"orbit": ((0, 0),), "eye": (0, 0, 1)}, {"eye": (0, 0, 1), "camera": 0}, {"orbit": ((0, 0),), "camera": 0},
    {"target": (0, 0, 1), "camera": 0}, {"view": ("top",), "eye": (0, 0, 1)}, {"view": ("top",), "camera": 0},
    {"ortho": True, "camera": 0}, {"eye": (0, 0, 1), "target": (0, 0, 1)}])
def test_options_that_contradict_each_other(given):
    with pytest.raises(UsageError):
        check_camera_options(NO_CAMERA | given, takes_several=True)


def test_no_two_directions_have_one_label():
    orbits = ((123.45678, 0), (123.45679, 0), (0.1, -0.5), (0, 0, 2.0000001), (0, 0, 2))
    labels = [each.label for each in directions_of({"view": None, "orbit": orbits})]
    assert len(set(labels)) == len(orbits) and labels[2:] == ["az0.1_el-0.5", "az0_el0_d2.0000001", "az0_el0_d2"]


def test_several_views_are_for_render_alone():
    several = NO_CAMERA | {"view": ("top", "left"), "orbit": ((0, 0),)}
    check_camera_options(several, takes_several=True)
    with pytest.raises(UsageError, match="--orbit and --view: only `render` takes several views"):
        check_camera_options(several)


def test_a_light_shines_from_where_it_is_put():
    light = make_light((90, 0, 7))
    assert light.direction == pytest.approx((-1, 0, 0), abs=1e-12) and light.intensity == 7
    assert make_light((0, 90, 1)).direction == pytest.approx((0, -1, 0), abs=1e-12)
