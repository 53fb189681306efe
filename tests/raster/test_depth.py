"""A poster in front of a wall, with the eye inside the scene: depth alone decides which of the two is seen."""

from __future__ import annotations

import ctypes
from collections.abc import Iterator
from dataclasses import replace

import numpy as np
import pytest
from shapes import moved, plate, scene

from viewer.gpu.context import Context
from viewer.raster import depth
from viewer.raster.renderer import Renderer
from viewer.scene.camera import Camera
from viewer.scene.frame import Frame
from viewer.scene.material import Material
from viewer.scene.scene import Scene
from viewer.settings import Settings

WALL, POSTER = Material(base_color=(0, 0, 1, 1), unlit=True), Material(base_color=(1, 0, 0, 1), unlit=True)
CAMERA = replace(Camera.look_at((0, 0, 0), (0, 0, -1)), near=1.0)
_CLIP_DEPTH_MODE, _NEGATIVE_ONE_TO_ONE, _DEPTH_FUNC, _LESS = 0x935D, 0x935E, 0x0B74, 0x0201
RANGES = (1e2, 1e5, 1e7)


@pytest.fixture
def fallback(context: Context, monkeypatch: pytest.MonkeyPatch) -> Iterator[Renderer]:
    """A renderer that cannot reach glClipControl."""
    monkeypatch.setattr(depth, "can_reverse", lambda gl: False)
    renderer = Renderer(context)
    yield renderer
    renderer.release()


def room(far: float, distance: float, gap: float, slant: float = 0.0) -> Scene:
    """A wall at `distance`, which is drawn first, and a poster `gap` before it; small things at a distance of 1, at the
    left edge of the picture, and of `far`, behind the eye."""
    turned = np.eye(4)
    turned[:3, :3] = Camera.orbit((0, 0, 0), 1.0, 0.0, slant).pose[:3, :3]
    return scene((plate(0), moved((0, 0, -distance), distance) @ turned),
                 (plate(1), moved((0, 0, -distance + gap), distance / 4) @ turned),
                 (plate(1), moved((-0.38, 0, -1.01), 0.02)), (plate(0), moved((far / 2, 0, far), distance / 10)),
                 materials=(WALL, POSTER))


def poster(renderer: Renderer, model: Scene, camera: Camera = CAMERA) -> np.ndarray:
    """Red less blue of the 16 x 16 pixels in the middle, which the poster covers."""
    picture = renderer.render(model, camera, Settings.of(background="none"), (96, 96)).linear
    return (picture[..., 0] - picture[..., 2])[40:56, 40:56]


@pytest.mark.parametrize("slant", [0.0, 0.7])
@pytest.mark.parametrize("far", RANGES)
def test_reversed_depth_tells_apart_a_hundred_thousandth_of_the_distance(renderer, far, slant):
    assert renderer._depth.is_reversed
    for distance in (2.0, far**0.5, far / 2):
        assert (poster(renderer, room(far, distance, 1e-5 * distance, slant)) == 1).all(), distance


@pytest.mark.parametrize("samples", ["none", "msaa-8"])
def test_reversed_depth_with_and_without_multisampling(renderer, samples):
    picture = renderer.render(room(12.0, 8.0, 0.02), CAMERA, Settings.of(antialias=samples, background="none"),
                              (96, 96)).linear
    assert (picture[40:56, 40:56, 0] == 1).all()


@pytest.mark.parametrize("far", RANGES)
def test_without_clip_control_the_nearest_plane_of_the_camera_sets_what_is_told_apart(fallback, far):
    assert not fallback._depth.is_reversed
    for distance in (2.0, far**0.5, far / 2):
        step = distance**2 / (CAMERA.near * 2**24)
        if 4 * step < distance / 2:
            assert (poster(fallback, room(far, distance, 4 * step)) == 1).all(), distance


def test_without_clip_control_or_a_nearest_plane_a_hundred_thousandth_of_the_farthest_is_taken():
    model = room(1e5, 10.0, 1.0)
    near, far = Frame(model, replace(CAMERA, near=None), (96, 96)).depth_range
    assert near == pytest.approx(1e-5 * far, rel=0.2)


@pytest.mark.parametrize("far", RANGES)
def test_what_is_close_is_seen_in_the_widest_range(renderer, fallback, far):
    model = room(far, far / 2, far / 20)
    for drawn in (renderer, fallback):
        picture = drawn.render(model, CAMERA, Settings.of(background="none"), (96, 96)).linear
        assert picture[48, 4, 0] == 1


@pytest.mark.parametrize("far", [1e9, 1e11])
def test_reversed_depth_sees_what_is_close_however_far_other_things_are(renderer, far):
    model = room(far, 2.0, 2e-5)
    picture = renderer.render(model, CAMERA, Settings.of(background="none"), (96, 96)).linear
    assert picture[48, 4, 0] == 1 and (poster(renderer, model) == 1).all()


def test_an_orthographic_camera_tells_apart_a_millionth_of_its_range(renderer, fallback):
    camera = Camera(np.eye(4), height=4.0)
    for drawn in (renderer, fallback):
        assert (poster(drawn, room(100.0, 5.0, 5e-4), camera) == 1).all()


def test_the_depth_test_is_left_as_it_was_found(context, renderer):
    renderer.draw(room(12.0, 8.0, 0.02), CAMERA, Settings.of(), (8, 8))
    get, value = context.function("glGetIntegerv", ctypes.c_int, ctypes.c_void_p), ctypes.c_int()
    for name, usual in ((_CLIP_DEPTH_MODE, _NEGATIVE_ONE_TO_ONE), (_DEPTH_FUNC, _LESS)):
        get(name, ctypes.addressof(value))
        assert value.value == usual
