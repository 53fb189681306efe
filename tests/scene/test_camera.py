"""What a camera is made of: a rotation with a translation, and numbers."""

from __future__ import annotations

import math
import warnings

import numpy as np
import pytest

from viewer.errors import UsageError
from viewer.scene.camera import Camera
from viewer.scene.camera_file import CameraFrame, write_cameras


def posed(**rows: object) -> np.ndarray:
    """The pose of a camera at (1, 2, 3), with other rows."""
    pose = Camera.look_at((1, 2, 3), (0, 0, 0)).pose.copy()
    for name, row in rows.items():
        pose[int(name[3:])] = row
    return pose


@pytest.mark.parametrize(("pose", "words"), [
    (posed().T, r"Camera.pose\[3\] is .*, not 0, 0, 0, 1; the translation stands in the last column"),
    (posed(row3=(0, 0, 0, 2)), r"Camera.pose\[3\] is \[0.0, 0.0, 0.0, 2.0\], not 0, 0, 0, 1$"),
    (posed() * [2, 2, 2, 1], "Camera.pose is no rotation with a translation"),
    (posed() * [1e300, 1e300, 1e300, 1], "Camera.pose is no rotation with a translation"),
    (np.diag([0.0, 0, 0, 1]), "Camera.pose is no rotation with a translation"),
    (posed() * [1, -1, 1, 1], "Camera.pose mirrors"),
])
def test_a_pose_that_pictures_would_show_wrong_is_refused(pose, words):
    with warnings.catch_warnings(), pytest.raises(UsageError, match=words):
        warnings.simplefilter("error")
        Camera(pose)


def test_a_pose_of_few_digits_or_in_a_list_is_one():
    np.testing.assert_array_equal(Camera(posed().tolist()).pose, posed())
    np.testing.assert_array_equal(Camera(posed().round(3).astype(">f4")).pose, posed().round(3).astype(np.float32))


@pytest.mark.parametrize(("key", "value", "words"), [
    ("fov_y", "wide", "Camera.fov_y is of type str, not a number"),
    ("fov_y", None, "Camera.fov_y is of type NoneType"),
    ("height", [2], "Camera.height is of type list"),
    ("near", -1.0, "Camera.near is -1.0, not above 0"),
    ("pixel_aspect", "1", "Camera.pixel_aspect is of type str"),
    ("name", 3, "Camera.name is of type int, not text"),
])
def test_what_is_no_number_is_refused(key, value, words):
    with pytest.raises(UsageError, match=words):
        Camera(np.eye(4), **{key: value})


@pytest.mark.parametrize(("make", "words"), [
    (lambda: Camera.orbit((0, 0, 0), "far"), "distance is of type str, not a number"),
    (lambda: Camera.orbit((0, 0, 0), 1, azimuth=None), "azimuth is of type NoneType, not a number"),
    (lambda: Camera.framing((0, 0, 0), 1.0, 0.0), "aspect is 0.0, not above 0"),
    (lambda: Camera.framing((0, 0, 0), 1.0, 1.0, fov_y=0.0), "fov_y is 0, which is not between 0 and pi"),
    (lambda: Camera(np.eye(4)).orthographic("2"), "depth is of type str, not a number"),
])
def test_what_makes_no_camera_is_one_line(make, words):
    with pytest.raises(UsageError, match=words):
        make()


def test_numbers_of_numpy_can_be_written(folder):
    single = Camera(np.eye(4), np.float32(0.5), pixel_aspect=np.float32(1.5))
    flat = Camera(np.eye(4), height=np.float32(2.5))
    write_cameras("a.json", [CameraFrame(single, (4, 3)), CameraFrame(flat, (4, 3))])
    assert math.isclose(single.fov_y, 0.5) and (folder / "a.json").is_file()
