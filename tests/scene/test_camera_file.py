"""transforms.json: read, refused in one line, and written so that it is read as the same cameras."""

from __future__ import annotations

import json
import math
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from viewer.errors import InputError
from viewer.scene.camera import Camera
from viewer.scene.camera_file import CameraFrame, camera_facts, read_camera_file, write_cameras, write_frames

ROWS = [[1, 0, 0, 0.5], [0, 1, 0, 0.25], [0, 0, 1, 3], [0, 0, 0, 1]]
LENS = {"fl_x": 500.0, "fl_y": 510.0, "cx": 300.0, "cy": 250.5, "w": 640, "h": 480}


def read(folder: Path, content: object, size: tuple[int, int] = (80, 60)):
    path = folder / "transforms.json"
    path.write_text(content if isinstance(content, str) else json.dumps(content))
    return read_camera_file(path, size)


def frame(**changes: object) -> dict[str, object]:
    return {"file_path": "images/a.png", "transform_matrix": ROWS} | changes


def test_intrinsics_stand_at_the_top_or_in_a_frame(folder):
    (shared, own), warnings = read(folder, LENS | {"frames": [frame(), frame(file_path="./b.jpg", fl_x=250.0, w=320)]})
    assert (shared.camera.name, own.camera.name) == ("a", "b")
    assert shared.size == (640, 480) and own.size == (320, 480) and not warnings
    assert shared.file == folder / "images" / "a.png" and shared.depth_file is None
    assert shared.camera.intrinsics(shared.size) == pytest.approx((500, 510, 300, 250.5), rel=1e-14)
    assert own.camera.intrinsics(own.size) == pytest.approx((250, 510, 300, 250.5), rel=1e-14)
    np.testing.assert_array_equal(own.camera.pose, ROWS)


def test_frames_with_intrinsics_of_their_own_leave_others_theirs(folder):
    own = frame(fl_x=250.0, w=320, k1=0.1)
    found, warnings = read(folder, LENS | {"frames": [own, frame(), own, frame(camera_model="ORTHOPHOTO"), frame()]})
    assert [each.size[0] for each in found] == [320, 640, 320, 640, 640]
    assert [each.camera.height is None for each in found] == [True, True, True, False, True]
    assert found[1].camera.intrinsics((640, 480)) == found[4].camera.intrinsics((640, 480))
    assert found[0].camera.intrinsics((320, 480)) == pytest.approx((250, 510, 300, 250.5), rel=1e-14)
    assert len(warnings) == 1 and "k1:" in warnings[0]


def test_an_angle_is_that_of_the_width_and_pixels_are_square(folder):
    """As the files of the first NeRF data sets have it, which say no size."""
    (only,), _ = read(folder, {"camera_angle_x": 0.6, "frames": [frame(file_path="./train/r_0")]})
    assert only.size == (80, 60) and only.camera.name == "r_0"
    fx, fy, cx, cy = only.camera.intrinsics(only.size)
    assert (fx, fy) == pytest.approx((40 / math.tan(0.3),) * 2) and (cx, cy) == (40, 30)


def test_orthophotos_are_orthographic(folder):
    (only,), _ = read(folder, LENS | {"camera_model": "ORTHOPHOTO", "fl_y": 120.0, "frames": [frame()]})
    assert only.camera.height == 4.0 and only.camera.principal == (300 / 640, 250.5 / 480)


def test_one_warning_says_that_distortion_is_not_drawn(folder):
    content = LENS | {"k1": 0.1, "k2": 0.0, "frames": [frame(p1=1e-3), frame(p1=2e-3)]}
    (line,) = read(folder, content)[1]
    assert "transforms.json: k1, p1: the distortion of lenses is not drawn" in line


@pytest.mark.parametrize(("paths", "labels"), [
    (["a/r.png", "b/r.png", "c.png"], ["0", "1", "c"]),
    (["", "../..", "x/../é y.exr"], ["0", "1", "é_y"]),
    (["1.png", ""], ["0", "1"]),
    (["a.png", "b/A.png", "c.png"], ["0", "1", "c"]),
    (["漢" * 90 + ".png"], ["漢" * 33]),
])
def test_labels_are_names_of_pictures_that_no_two_share(folder, paths, labels):
    frames, _ = read(folder, LENS | {"frames": [frame(file_path=path) for path in paths]})
    assert [f.camera.name for f in frames] == labels


def test_a_pose_of_few_digits_or_with_a_scale_becomes_a_rotation(folder):
    turn = Camera.look_at((1, 2, 3), (0, 0, 0)).pose
    for rows in (np.round(turn, 4), turn @ np.diag([2, 2, 2, 1])):
        (only,), _ = read(folder, LENS | {"frames": [frame(transform_matrix=rows.tolist())]})
        np.testing.assert_allclose(only.camera.pose, turn, atol=1e-4)
        np.testing.assert_allclose(only.camera.pose[:3, :3].T @ only.camera.pose[:3, :3], np.eye(3), atol=1e-14)


def posed(row: int, column: int, value: object) -> dict[str, object]:
    """A file of one frame whose pose has `value` in this place."""
    rows: list[list[object]] = [list(numbers) for numbers in ROWS]
    rows[row][column] = value
    return LENS | {"frames": [frame(transform_matrix=rows)]}


@pytest.mark.parametrize(("content", "words"), [
    ("[]", "must be an object, not an array"),
    ("{", "line 1: not valid JSON"),
    ({}, "frames: is missing"),
    ({"frames": []}, "frames: is empty: there are no cameras"),
    ({"frames": [3]}, r"frames\[0\]: must be an object"),
    (LENS | {"frames": [{"file_path": "a"}]}, r"frames\[0\].transform_matrix: is missing"),
    (LENS | {"frames": [frame(), frame(transform_matrix=ROWS[:3])]}, r"frames\[1\].transform_matrix: must be four"),
    (posed(1, 2, math.nan), r"transform_matrix\[1\]\[2\]: must be a num"),
    (posed(0, 3, 1e19), r"transform_matrix\[0\]\[3\]: must be a number"),
    (posed(0, 0, True), r"transform_matrix\[0\]\[0\]: must be a number"),
    (posed(3, 3, 0.01), r"transform_matrix\[3\]: is \[0.0, 0.0, 0.0, 0.01"),
    (posed(0, 0, 0), "transform_matrix: is singular"),
    (posed(0, 0, -1), "transform_matrix: mirrors"),
    (LENS | {"frames": [frame(), *posed(0, 0, -1)["frames"]]}, r"frames\[1\].transform_matrix: mirrors"),
    (posed(0, 0, 2), "transform_matrix: is no rotation"),
    ({"frames": [frame()]}, r"frames\[0\]: neither fl_x nor camera_angle_x"),
    ({"fl_x": 3.0, "frames": [frame()]}, r"frames\[0\].fl_x: is in pixels of a picture of w x h"),
    (LENS | {"fl_y": 0, "frames": [frame()]}, r"frames\[0\].fl_y: 0 is not above 0"),
    (LENS | {"w": 1 << 20, "frames": [frame()]}, r"frames\[0\].w: 1048576 pixels are more than"),
    (LENS | {"h": 0, "frames": [frame()]}, r"frames\[0\].h: must be at least 1"),
    (LENS | {"cx": math.inf, "frames": [frame()]}, r"frames\[0\].cx: must be a finite number"),
    (LENS | {"cx": 1e9, "frames": [frame()]}, r"frames\[0\].cx: 1e\+09 is more than 1000 pictures away"),
    (LENS | {"fl_y": 1e300, "frames": [frame()]}, r"frames\[0\]: no picture of 640x480 has focal lengths of 500 and"),
    (LENS | {"fl_x": 1e-300, "fl_y": 1e-300, "frames": [frame()]}, r"frames\[0\]: no picture of 640x480 has focal"),
    (LENS | {"camera_model": "ORTHOPHOTO", "fl_y": 1e-310, "frames": [frame()]}, r"frames\[0\]: no picture of 640x480"),
    ({"camera_angle_x": 5e-324, "frames": [frame()]}, r"frames\[0\]: no picture of 80x60 has focal lengths of inf"),
    (LENS | {"is_fisheye": True, "frames": [frame()]}, r"frames\[0\].is_fisheye: fisheye lenses are not drawn"),
    ({"camera_angle_x": 45, "frames": [frame()]}, r"frames\[0\].camera_angle_x: 45 is not below pi; it is in radians"),
    (LENS | {"camera_model": "OPENCV_FISHEYE", "frames": [frame()]}, r"frames\[0\].camera_model: 'OPENCV_FISHEYE'"),
    ({"camera_model": "ORTHOPHOTO", "frames": [frame()]}, r"frames\[0\].fl_x: is missing"),
])
def test_what_is_no_camera_is_refused_with_its_place(folder, content, words):
    with pytest.raises(InputError, match=words) as caught:
        read(folder, content)
    assert str(caught.value).startswith(str(folder / "transforms.json")) and "\n" not in str(caught.value)


def cameras(count: int) -> Iterator[Camera]:
    rng = np.random.default_rng(5)
    for _ in range(count):
        made = Camera.look_at(rng.normal(size=3) * 10 ** rng.uniform(-6, 6), (0, 0, 0), rng.normal(size=3))
        camera = replace(made, fov_y=rng.uniform(0.01, 3.0), principal=tuple(rng.uniform(-1, 2, 2).tolist()),
                         pixel_aspect=rng.uniform(0.5, 2.0))
        yield replace(camera, height=10 ** rng.uniform(-6, 6)) if rng.uniform() < 0.3 else camera


def test_what_is_written_is_read_as_the_same_cameras(folder):
    """Poses to the bit; numbers that are made of others to the last bit but one, since not every quotient is one."""
    written = list(cameras(60))
    write_cameras("transforms.json", [CameraFrame(c, (63, 41), Path("a.png")) for c in written])
    frames, _ = read_camera_file("transforms.json", (1, 1))
    for camera, found in zip(written, frames, strict=True):
        assert found.size == (63, 41)
        np.testing.assert_array_equal(found.camera.pose, camera.pose)
        assert (found.camera.height is None) == (camera.height is None)
        for name in ("fov_y",) if camera.height is None else ("height",):
            assert getattr(found.camera, name) == pytest.approx(getattr(camera, name), rel=3e-16)
        assert found.camera.pixel_aspect == pytest.approx(camera.pixel_aspect, rel=3e-16)
        assert found.camera.principal == pytest.approx(camera.principal, rel=3e-16)


def test_numbers_of_a_file_are_written_as_they_stood_there(folder):
    rng = np.random.default_rng(7)
    content = {"frames": [frame(w=640 + k, h=479, fl_x=round(rng.uniform(100, 2000), 3),
                                fl_y=round(rng.uniform(100, 2000), 6), cx=round(rng.uniform(0, 600), 2),
                                cy=round(rng.uniform(0, 400), 9), transform_matrix=camera.pose.tolist())
                          for k, camera in enumerate(cameras(40))]}
    frames, _ = read(folder, content)
    write_cameras("again.json", [CameraFrame(f.camera, f.size, Path("images/a.png")) for f in frames])
    again = json.loads(Path("again.json").read_text())
    for before, after in zip(content["frames"], again["frames"], strict=True):
        assert before.items() <= (again | after).items()


def test_names_are_relative_to_the_file_and_what_is_shared_stands_once(folder):
    Path("poses").mkdir()
    picture = CameraFrame(Camera(np.eye(4)), (8, 8), Path("out/a.png"), Path("out/a.exr"))
    pictures = [picture, replace(picture, file=Path("poses/b.png"), depth_file=None)]
    write_frames("poses/transforms.json", [(camera_facts(each.camera, each.size), each.file, each.depth_file)
                                           for each in pictures], np.eye(4))
    content = json.loads(Path("poses/transforms.json").read_text())
    assert [f.get("file_path") for f in content["frames"]] == ["../out/a.png", "b.png"]
    assert [f.get("depth_file_path") for f in content["frames"]] == ["../out/a.exr", None]
    assert content["applied_transform"] == np.eye(4)[:3].tolist()
    assert content["w"] == 8 and content["camera_model"] == "PINHOLE" and "fl_x" not in content["frames"][0]
    assert content["camera_angle_x"] == pytest.approx(math.radians(45))
