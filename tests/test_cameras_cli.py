"""Views and files of cameras on the command line: which pictures there are, and the files that tell of them."""

from __future__ import annotations

import json
import os
from pathlib import Path

import numpy as np
import pytest
from command_line import SCENES, names

import viewer
from viewer.image.image import Image
from viewer.jobs.views import camera_frames
from viewer.scene.camera import Camera
from viewer.scene.camera_file import CameraFrame, read_camera_file, write_cameras

BALLS = SCENES / "spheres.glb"
QUICK = ("--size", "24x16", "--set", "antialias=none", "-q")


def frames(path: str) -> list[dict[str, object]]:
    return json.loads(Path(path).read_text())["frames"]


def test_each_view_has_a_picture_and_a_frame(run, folder):
    outcome = run("render", BALLS, "-o", "out/", "--view", "front,top", "--orbit", "30,15", *QUICK,
                  "--write-cameras", "out/transforms.json")
    assert (outcome.status, outcome.err) == (0, "")
    pictures = ["spheres_front.png", "spheres_top.png", "spheres_az30_el15.png"]
    assert set(names(folder / "out")) == {*pictures, "transforms.json"}
    assert [frame["file_path"] for frame in frames("out/transforms.json")] == pictures
    scene = viewer.load(BALLS)
    read, _ = read_camera_file("out/transforms.json", (1, 1))
    for frame, angles in zip(read, ((0.0, 0.0), (0.0, np.pi / 2), (np.pi / 6, np.pi / 12)), strict=True):
        np.testing.assert_array_equal(frame.camera.pose, scene.framing_camera(1.5, *angles).pose)
    assert run("render", BALLS, "-o", "by/{view}/{name}.png", "--view", "left,right", *QUICK).status == 0
    assert names(folder / "by") == ["left", "right"] and names(folder / "by" / "left") == ["spheres.png"]
    assert run("render", BALLS, "-o", "{view}.png", "--view", "left", *QUICK).status == 0
    assert run("render", BALLS, "-o", "{view}.png", *QUICK).status == 0
    assert run("render", BALLS, "-o", "one.png", "--view", "left", *QUICK).status == 0
    assert {"left.png", "view.png", "one.png"} <= set(names(folder))


def test_the_file_of_cameras_is_read_once_for_all_models_and_again_when_it_changes(folder, monkeypatch):
    read = []
    monkeypatch.setattr("viewer.jobs.views.read_camera_file", lambda path, size: read.append(path) or ((), ()))
    options = {"cameras": "in.json", "size": (24, 16)}
    for text in ("{}", "{}", "{ }"):
        Path("in.json").write_text(text)
        os.utime("in.json", ns=(len(text), len(text)))
        for _ in range(3):
            camera_frames(options)
    assert len(read) == 2


def test_pictures_through_written_cameras_are_the_same(run, folder):
    """Calibrated and orthographic cameras, each in the size of its own frame, and all in another size."""
    center = viewer.load(BALLS).center
    pose = Camera.look_at(center + (0, 1, 5), center).pose
    written = [CameraFrame(Camera.from_intrinsics(pose, 20.0, 22.0, 9.0, 11.0, (24, 16)), (24, 16), Path("a.png")),
               CameraFrame(Camera(pose, height=4.0), (20, 20), Path("b.png"))]
    write_cameras("in.json", written)
    first = run("render", BALLS, "-o", "one/", "--cameras", "in.json", *QUICK[2:], "--write-cameras", "two.json")
    assert (first.status, first.err) == (0, "")
    assert run("render", BALLS, "-o", "two/", "--cameras", "two.json", *QUICK[2:]).status == 0
    assert set(names(folder / "one")) == {"spheres_a.png", "spheres_b.png"}
    assert set(names(folder / "two")) == {"spheres_spheres_a.png", "spheres_spheres_b.png"}
    for name, frame in zip("ab", written, strict=True):
        one, two = (Image.open(f"one/spheres_{name}.png"), Image.open(f"two/spheres_spheres_{name}.png"))
        assert one.size == frame.size
        np.testing.assert_array_equal(one.srgb, two.srgb)
        drawn = viewer.render(viewer.load(BALLS), frame.size, frame.camera, antialias="none")
        np.testing.assert_allclose(one.srgb.astype(int), drawn.srgb, atol=1)  # which was displayed from half floats
    assert run("render", BALLS, "-o", "three/", "--cameras", "in.json", *QUICK).status == 0
    assert {Image.open(f"three/spheres_{name}.png").size for name in "ab"} == {(24, 16)}


def test_a_file_for_all_models_or_for_each(run, folder):
    models = (BALLS, SCENES / "unlit.glb")
    assert run("render", *models, "-o", "out/", *QUICK, "--write-cameras", "all.json").status == 0
    assert [frame["file_path"] for frame in frames("all.json")] == ["out/spheres.png", "out/unlit.png"]
    assert run("render", *models, "-o", "out/", *QUICK, "--write-cameras", "poses/{name}.json").status == 0
    assert names(folder / "poses") == ["spheres.json", "unlit.json"]
    assert [frame["file_path"] for frame in frames("poses/unlit.json")] == ["../out/unlit.png"]


def test_cameras_of_pictures_that_were_done_before_are_written_again(run, folder):
    models = (BALLS, SCENES / "unlit.glb")
    command = ("render", *models, "-o", "out/", *QUICK, "--resume", "--write-cameras", "all.json")
    assert run("render", *models, "-o", "out/", *QUICK).status == 0
    assert run(*command).status == 0  # the first run has not told of any cameras
    first = Path("all.json").read_text()
    (folder / "all.json").unlink()
    before = (folder / "out" / "unlit.png").stat().st_mtime_ns
    (folder / "out" / "spheres.png").unlink()
    assert run(*command).status == 0
    assert Path("all.json").read_text() == first and len(frames("all.json")) == 2
    assert (folder / "out" / "unlit.png").stat().st_mtime_ns == before


@pytest.mark.parametrize("ortho", [(), ("--ortho",)])
def test_depth_and_poses_are_a_data_set(run, folder, ortho):
    """Each pixel's depth, unprojected by the numbers of the file alone, is the point that the surface has there."""
    outcome = run("render", BALLS, "-o", "{view}.npz", "--view", "front,iso", *QUICK, *ortho, "--aov", "depth,position",
                  "--write-cameras", "transforms.json")
    assert (outcome.status, outcome.err) == (0, "")
    content = json.loads(Path("transforms.json").read_text())
    for frame in content["frames"]:
        layers, numbers = np.load(frame["depth_file_path"]), content | frame
        pose, depth = np.array(numbers["transform_matrix"]), layers["depth"].astype(float)
        y, x = np.mgrid[:numbers["h"], :numbers["w"]] + 0.5
        across = np.stack([(x - numbers["cx"]) / numbers["fl_x"], (numbers["cy"] - y) / numbers["fl_y"]], axis=-1)
        seen = np.isfinite(depth)
        assert 0.05 < seen.mean() < 0.95 and (depth[seen] > 0).all()
        local = np.concatenate([across * (1 if ortho else depth[..., None]), -depth[..., None]], axis=-1)[seen]
        np.testing.assert_allclose(local @ pose[:3, :3].T + pose[:3, 3], layers["position"][seen], atol=2e-5)


def test_depth_and_what_was_turned_are_told(run, folder):
    outcome = run("render", BALLS, "-o", "a.exr", "--size", "8", "-q", "--aov", "depth", "--up", "z",
                  "--write-cameras", "t.json")
    assert outcome.status == 0
    content = json.loads(Path("t.json").read_text())
    assert content["frames"][0]["depth_file_path"] == content["frames"][0]["file_path"] == "a.exr"
    assert content["applied_transform"] == [[1, 0, 0, 0], [0, 0, 1, 0], [0, -1, 0, 0]]


def test_distortion_is_told_once_and_a_bad_file_before_anything_is_drawn(run, folder):
    write_cameras("in.json", [CameraFrame(Camera(np.eye(4)), (8, 8))])
    content = json.loads(Path("in.json").read_text())
    (folder / "in.json").write_text(json.dumps(content | {"k1": 0.1}))
    outcome = run("render", BALLS, SCENES / "unlit.glb", "-o", "out/", "--cameras", "in.json")
    assert outcome.status == 0 and outcome.err.count("distortion of lenses is not drawn") == 1
    with pytest.warns(UserWarning, match="in.json: k1: the distortion of lenses is not drawn"):
        (frame,) = viewer.read_cameras("in.json")
    viewer.write_cameras("out.json", [frame])
    assert json.loads(Path("out.json").read_text()) == content
    (folder / "in.json").write_text(json.dumps({"frames": []}))
    outcome = run("render", BALLS, "-o", "b.png", "--cameras", "in.json")
    assert (outcome.status, outcome.error) == (1, "in.json: frames: is empty: there are no cameras")
    assert "b.png" not in names(folder)


def test_options_that_do_not_go_together(run, folder):
    for arguments, words in (
        (("--cameras", "a.json", "--view", "top"), "--view and --cameras cannot be used together"),
        (("--cameras", "a.json", "--fov", "30"), "--fov and --cameras cannot be used together"),
        (("--cameras", "a.json", "--ortho"), "--ortho and --cameras cannot be used together"),
        (("--write-cameras", "a.txt"), "--write-cameras a.txt: the name of a file of cameras must end in .json"),
    ):
        outcome = run("render", BALLS, "-o", "a.png", *arguments)
        assert outcome.status == 2 and words in outcome.err
    outcome = run("render", BALLS, "-o", "a.gif", "--turntable", "4", "--write-cameras", "a.json")
    assert outcome.status == 2 and "it writes the cameras of pictures, not of films" in outcome.err
    outcome = run("render", BALLS, "-o", "a.gif", "--turntable", "4", "--view", "top,left")
    assert outcome.status == 2 and "a film has one --view or --orbit" in outcome.err
