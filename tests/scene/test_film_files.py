"""Films: whole files with the frames and the times that were asked for, from a camera that all frames fit into."""

from __future__ import annotations

import json
import os
import signal
import sys

import numpy as np
import pytest
from command_line import SCENES, names
from gltf_builder import GltfBuilder
from needs import needs, require
from PIL import Image as Pillow

from viewer.errors import InputError, OutputError, UsageError
from viewer.image.film import check_film, write_film
from viewer.image.image import Image
from viewer.jobs import film as film_job
from viewer.jobs.film import film_camera, film_frames
from viewer.jobs.makers import RasterMaker
from viewer.scene.load import load_scene

SMALL = ("--size", "24", "--env", "none", "--light", "0,0,3")
OPTIONS = {"turntable": None, "fps": None, "time": None, "animation": None, "camera": None, "eye": None, "target": None,
           "orbit": (), "view": None, "ortho": False, "fov": None, "size": (64, 48)}


def bars(count):
    """Frames in which a red bar grows from the left by 6 of 48 pixels."""
    for k in range(count):
        pixels = np.full((32, 48, 4), 255, np.uint8)
        pixels[..., :3] = 40
        pixels[:, :6 * k + 6, 0] = 200
        yield Image.from_srgb(pixels)


def decoded(path):
    """The frames (N, H, W, 4) of a film, and the milliseconds of each."""
    if path.suffix == ".mp4":
        import av

        with av.open(str(path)) as container:
            stream = container.streams.video[0]
            frames = [frame.reformat(format="rgba", src_colorspace="ITU709").to_ndarray()
                      for frame in container.decode(stream)]
            return np.stack(frames), [float(1000 / stream.average_rate)] * len(frames)
    with Pillow.open(path) as picture:
        frames, times = [], []
        for k in range(getattr(picture, "n_frames", 1)):
            picture.seek(k)
            frames.append(np.asarray(picture.convert("RGBA")))
            times.append(picture.info.get("duration"))
    return np.stack(frames), times


@pytest.mark.parametrize("suffix", ["mp4", "webp", "gif", "apng"])
def test_frames_come_back(tmp_path, suffix):
    if suffix == "mp4":
        require("film")
    path = tmp_path / f"a.{suffix}"
    assert write_film(path, bars(7), 30) == 7
    frames, times = decoded(path)
    assert len(frames) == 7
    for frame, wanted in zip(frames, bars(7), strict=True):
        assert np.abs(frame.astype(int) - wanted.srgb)[:, ::6].max() <= (40 if suffix in ("mp4", "webp") else 2)
        assert np.abs(frame.astype(int) - wanted.srgb).mean() < 4
    assert names(tmp_path) == [path.name]
    if suffix != "webp":  # of which Pillow tells no durations
        assert sum(times) == pytest.approx(7000 / 30, abs=6 if suffix == "gif" else 1)


def test_alpha_stays_where_the_format_has_it(tmp_path):
    pixels = np.zeros((8, 8, 4), np.uint8)
    pixels[:, 4:] = (200, 100, 50, 255)
    pixels[0, 4, 3] = 100  # an edge, as pictures have; without any, libwebp writes no frame with alpha
    for suffix in ("webp", "gif", "apng"):
        write_film(tmp_path / f"a.{suffix}", iter([Image.from_srgb(pixels), Image.from_srgb(pixels[:, ::-1])]), 10)
        frames, _ = decoded(tmp_path / f"a.{suffix}")
        assert frames[0, 1:, 0, 3].max() == 0 and frames[0, 1:, -1, 3].min() == 255
        assert frames[1, 1:, 0, 3].min() == 255 and frames[1, 1:, -1, 3].max() == 0


def test_an_error_leaves_no_file(tmp_path):
    def broken():
        yield from bars(2)
        raise OSError("no more")

    for suffix in ("gif", "webp"):
        with pytest.raises(OutputError, match="no more"):
            write_film(tmp_path / f"a.{suffix}", broken(), 25)
    assert names(tmp_path) == []


def test_what_an_mp4_needs(tmp_path, monkeypatch):
    with pytest.raises(UsageError, match="an .mp4 needs an even width and height, not 33x32"):
        check_film(tmp_path / "a.mp4", (33, 32))
    check_film(tmp_path / "a.gif", (33, 31))
    monkeypatch.setitem(sys.modules, "av", None)
    with pytest.raises(UsageError, match=r"an .mp4 needs PyAV: pip install 'pbr-viewer\[film\]'"):
        check_film(tmp_path / "a.mp4", (32, 32))


@pytest.fixture
def moving(folder):
    """A triangle that rises by 8 in 2 s, in "a.glb"."""
    builder = GltfBuilder()
    node = builder.node(mesh=builder.triangle())
    sampler = {"input": builder.accessor([0, 2]), "output": builder.accessor([[0, 0, 0], [0, 8, 0]])}
    builder.add("animations", {"name": "rise", "samplers": [sampler], "channels": [
        {"sampler": 0, "target": {"node": node, "path": "translation"}}]})
    (folder / "a.glb").write_bytes(builder.glb())
    return folder / "a.glb"


def test_an_animation_plays_once(run, moving):
    outcome = run("render", "a.glb", "-o", "a.gif", "--fps", "5", *SMALL, "--stats", "a.json")
    assert (outcome.status, outcome.err) == (0, "")
    frames, times = decoded(moving.parent / "a.gif")
    assert len(frames) == 10 and times == [200] * 10
    assert json.loads((moving.parent / "a.json").read_text())["frames"] == 10
    assert all((frame != frames[0]).any() for frame in frames[1:])


def test_times_and_turns(moving):
    scene = load_scene(moving)
    frames = film_frames("a.glb", scene, OPTIONS | {"fps": 2.0, "time": 0.5})
    assert [(frame.time, frame.turn) for frame in frames] == [(0.5, 0), (1, 0), (1.5, 0)]
    turned = film_frames("a.glb", scene, OPTIONS | {"turntable": 5, "fps": 2.0, "animation": "rise"})
    assert [frame.time for frame in turned] == [0, 0.5, 1, 1.5, 0]
    assert np.diff([frame.turn for frame in turned]) == pytest.approx(2 * np.pi / 5)
    still = film_frames("a.glb", scene, OPTIONS | {"turntable": 3})
    assert [frame.of(scene) is scene for frame in still] == [True] * 3


def test_a_film_from_the_end_on_has_nothing_to_show(moving):
    with pytest.raises(InputError, match="--time 2: 'rise' is over by then; it takes 2 s"):
        film_frames("a.glb", load_scene(moving), OPTIONS | {"time": 2.0})


@pytest.mark.parametrize("changes", [
    {}, {"turntable": 8}, {"turntable": 8, "animation": "rise"}, {"ortho": True}, {"turntable": 8, "ortho": True}])
def test_all_frames_fit_into_the_picture_and_the_camera_keeps_its_distance(moving, changes):
    scene, options = load_scene(moving), OPTIONS | {"fps": 4.0} | changes
    frames = film_frames("a.glb", scene, options)
    camera = film_camera("a.glb", scene, frames, options)
    steps, reach = [], []
    for frame in frames:
        shown = frame.of(scene)
        view, transform = camera(shown, frame), shown.instances[0].transform
        corners = shown.meshes[0].positions @ transform[:3, :3].T + transform[:3, 3]
        clip = np.c_[corners, np.ones(3)] @ (view.projection(64 / 48, 0.1, 100.0) @ view.view()).T
        reach.append(np.abs(clip[:, :2] / clip[:, 3:]).max())
        steps.append((view.eye[1], np.linalg.norm(view.eye - camera(scene, frames[0]).eye)))
    assert 0.6 < max(reach) <= 1
    assert (view.height is not None) == ("ortho" in changes)
    heights, chords = np.array(steps).T
    assert np.ptp(heights) < 1e-9 and (np.ptp(chords) < 1e-9) == ("turntable" not in changes)


def test_a_turntable_turns(run, folder):
    outcome = run("render", SCENES / "unlit.glb", "-o", "a.apng", "--turntable", "4", "--size", "24")
    assert (outcome.status, outcome.err) == (0, "")
    frames, times = decoded(folder / "a.apng")
    assert len(frames) == 4 and times == [40] * 4 and (frames[0] != frames[1]).any()


@pytest.mark.parametrize("name", ["a.gif", "a.apng", "a.webp", pytest.param("a.mp4", marks=needs("film"))])
def test_a_turntable_of_one_frame_is_the_picture_at_its_start(run, folder, name):
    picture = ("render", SCENES / "unlit.glb", "--size", "24", "-o")
    assert run(*picture, name, "--turntable", "1", "--stats", "a.json").status == 0
    assert json.loads((folder / "a.json").read_text())["frames"] == 1
    assert run(*picture, "b.apng", "--turntable", "2").status == 0
    (frame,), _ = decoded(folder / name)
    near, far = (np.abs(frame.astype(float) - other).mean() for other in decoded(folder / "b.apng")[0])
    assert near < 12 and near < 0.5 * far


@pytest.mark.parametrize("signals", [1, 2])
def test_ctrl_c_leaves_a_whole_shorter_film(run, moving, monkeypatch, signals):
    """Twice does so too, in the middle of a picture."""
    real, made = RasterMaker.make, []

    def make(self, *args):
        made.append(1)
        if len(made) == 4:
            for _ in range(signals):
                os.kill(os.getpid(), signal.SIGINT)
        return real(self, *args)

    monkeypatch.setattr(RasterMaker, "make", make)
    outcome = run("render", "a.glb", "-o", "a.gif", "--fps", "5", *SMALL, "--stats", "a.json")
    assert outcome.status == 130 and outcome.error == "a.gif: stopped after 3 of 10 frames"
    assert len(decoded(moving.parent / "a.gif")[0]) == 3
    assert json.loads((moving.parent / "a.json").read_text())["frames"] == 3


def test_ctrl_c_while_the_film_is_written_leaves_it_whole(run, moving, monkeypatch):
    real = Pillow.Image.save

    def save(self, *args, **options):
        os.kill(os.getpid(), signal.SIGINT)
        real(self, *args, **options)

    monkeypatch.setattr(Pillow.Image, "save", save)
    outcome = run("render", "a.glb", "-o", "a.gif", "--fps", "2", *SMALL)
    assert outcome.status == 130 and outcome.error == "a.gif: stopped after 4 of 4 frames"
    assert len(decoded(moving.parent / "a.gif")[0]) == 4


@pytest.mark.parametrize("options, problem", [
    (("-o", "a.png", "--turntable", "3"), "--turntable with -o a.png: a film ends in one of .mp4, .webp"),
    (("-o", "a.png", "--fps", "3"), "--fps with -o a.png"),
    (("-o", "a.gif", "--turntable", "3", "--eye", "0,0,9"), "--turntable and --eye cannot be used together"),
    (("-o", "a.gif", "--time-budget", "1"), "a method is chosen for pictures only; give a --mode"),
])
def test_options_without_effect_are_wrong_usage(run, moving, options, problem):
    outcome = run("render", "a.glb", *SMALL, *options)
    assert outcome.status == 2 and problem in outcome.error


def test_nothing_moves(run, folder, monkeypatch):
    outcome = run("render", SCENES / "unlit.glb", "-o", "a.gif", *SMALL)
    assert outcome.status == 1 and "animations: there are none, so nothing moves; --turntable N" in outcome.error
    assert names(folder) == []


def test_a_film_without_end_is_refused(run, moving, monkeypatch):
    monkeypatch.setattr(film_job, "MAX_FRAMES", 9)
    outcome = run("render", "a.glb", "-o", "a.gif", "--fps", "5", *SMALL)
    assert outcome.status == 1 and "2 s at 5 frames a second are more than 9 frames" in outcome.error


def test_a_webp_is_a_picture_unless_something_moves(run, moving):
    for options, count in (((), 1), (("--time", "1"), 1), (("--animation", "rise"), 50), (("--fps", "2"), 4)):
        assert run("render", "a.glb", "-o", "a.webp", *SMALL, *options).status == 0
        assert len(decoded(moving.parent / "a.webp")[0]) == count
