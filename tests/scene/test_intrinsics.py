"""Cameras with a principal point and pixels that are not square, against the pinhole equations in float64."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from viewer.errors import UsageError
from viewer.interact.pick import cursor_ray
from viewer.scene.camera import Camera
from viewer.scene.frame import Frame
from viewer.scene.scene import Scene

SIZE = (48, 32)
POSE = Camera.look_at((0.3, -0.4, 2.0), (0.1, 0.2, 0.0), (0.2, 1.0, 0.1)).pose
CALIBRATED = Camera.from_intrinsics(POSE, 50.0, 40.0, 20.0, 11.0, SIZE)
LENSES = {"calibrated": CALIBRATED,
          "principal point outside": replace(CALIBRATED, principal=(-0.7, 1.6)),
          "orthographic": replace(CALIBRATED, height=1.7)}


def pixels(camera: Camera, points: np.ndarray) -> np.ndarray:
    """Where a picture of SIZE shows points (N, 3), in pixels from its upper left corner: x = fx X / Z + cx."""
    fx, fy, cx, cy = camera.intrinsics(SIZE)
    x, y, z = ((points - camera.eye) @ camera.pose[:3, :3]).T
    depth = -z if camera.height is None else 1.0
    return np.stack([cx + fx * x / depth, cy - fy * y / depth], axis=1)


@pytest.fixture(params=LENSES)
def camera(request: pytest.FixtureRequest) -> Camera:
    return LENSES[request.param]


def test_intrinsics_are_those_that_were_given():
    assert CALIBRATED.intrinsics(SIZE) == pytest.approx((50.0, 40.0, 20.0, 11.0), rel=1e-14)
    assert CALIBRATED.intrinsics((96, 64)) == pytest.approx((100.0, 80.0, 40.0, 22.0), rel=1e-14)
    usual = Camera(POSE, math.radians(60)).intrinsics((640, 480))
    assert usual == pytest.approx((240 / math.tan(math.radians(30)),) * 2 + (320, 240), rel=1e-14)


def test_clip_space_is_where_the_pinhole_equations_say(camera):
    points = np.random.default_rng(3).uniform(-0.5, 0.5, (20, 3))
    frame = Frame(Scene(""), camera, SIZE)
    eye = (points - camera.eye) / frame.unit
    clip = np.concatenate([eye, np.ones((20, 1))], axis=1) @ frame.view_projection.T
    shown = (clip[:, :2] / clip[:, 3:] * (1, -1) + 1) / 2 * SIZE
    np.testing.assert_allclose(shown, pixels(camera, points), rtol=1e-12, atol=1e-12)


def test_rays_go_through_the_pixels_that_show_what_they_meet(camera):
    at = (31.0, 5.0)
    frame = Frame(Scene(""), camera, SIZE)
    ndc = np.array([2 * at[0] / SIZE[0] - 1, 1 - 2 * at[1] / SIZE[1], 1.0])
    origin, direction = cursor_ray(camera, SIZE, at)
    for start, along in ((origin, direction), (camera.eye + frame.unit * frame.ray_origin @ ndc, frame.ray @ ndc)):
        np.testing.assert_allclose(pixels(camera, np.stack([start + 0.5 * along, start + 3 * along])), [at, at],
                                   rtol=1e-12)


def test_an_orthographic_view_shows_as_much_at_its_depth():
    camera, point = Camera(np.eye(4), fov_y=0.7), np.array([[0.3, -0.2, -3.0]])
    flat = camera.orthographic(3.0)
    np.testing.assert_allclose(pixels(flat, point), pixels(camera, point), rtol=1e-14)
    with pytest.raises(UsageError, match="depth is 0.0, not above 0"):
        camera.orthographic(0.0)


@pytest.mark.parametrize(("arguments", "words"), [
    ((-1.0, 1.0, 0.0, 0.0, SIZE), "fx=-1, fy=1: a focal length is above 0"),
    ((1.0, math.nan, 0.0, 0.0, SIZE), "fx, fy, cx, cy"),
    ((1.0, 1.0, 0.0, 0.0, (0, 4)), "size="),
    ((40.0, 40.0, 1e6, 0.0, SIZE), "more than 1000 pictures away"),
    ((40.0, 1e-3, 1.0, 0.0, SIZE), "Camera.pixel_aspect is 2.5e-05"),
])
def test_intrinsics_that_are_no_camera_are_refused(arguments, words):
    with pytest.raises(UsageError, match=words):
        Camera.from_intrinsics(np.eye(4), *arguments)


def test_cameras_that_differ_in_any_number_have_other_keys():
    changes = ({"principal": (0.4, 0.5)}, {"pixel_aspect": 1.1}, {"height": 2.0}, {"fov_y": 0.5}, {"pose": np.eye(4)})
    assert len({camera.key for camera in (CALIBRATED, *(replace(CALIBRATED, **change) for change in changes))}) == 6
