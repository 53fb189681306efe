"""--animation and --time: the picture is of that time, `info` lists animations, and what is not there is one line."""

from __future__ import annotations

import json

import numpy as np
import pytest
from command_line import SCENES
from gltf_builder import GltfBuilder

import viewer
from viewer.image.image import Image

PLAIN = ("--size", "24", "--env", "none", "--light", "0,0,3", "--background", "none", "--eye", "0,0,4",
         "--target", "0,0,0")


@pytest.fixture
def moving(folder):
    """A triangle that comes from the left to the right in 2 s, and another that stands still."""
    builder = GltfBuilder()
    node = builder.node(mesh=builder.triangle(), translation=[-1, 0, 0])
    still = builder.node(mesh=builder.triangle(), translation=[0, -1, 0])
    for name, number in (("come", node), ("rise", still)):
        sampler = {"input": builder.accessor([0, 2]), "output": builder.accessor([[-1, -1, 0], [1, 0, 0]])}
        builder.add("animations", {"name": name, "samplers": [sampler],
                                   "channels": [{"sampler": 0, "target": {"node": number, "path": "translation"}}]})
    (folder / "a.glb").write_bytes(builder.glb())
    return folder / "a.glb"


def picture(run, *options, said=""):
    outcome = run("render", "a.glb", "-o", "a.png", *PLAIN, *options)
    assert (outcome.status, outcome.err) == (0, said)
    return Image.open("a.png").srgb.astype(int)


def test_the_picture_is_of_the_time(run, moving):
    rest, first, late = picture(run), picture(run, "--time", "0"), picture(run, "--time", "2")
    assert (rest != first).any() and (first != late).any()
    assert np.array_equal(picture(run, "--animation", "come"), first), "without a time it is 0"
    over = "a.glb: warning: --time 9: the animation 'come' takes 2 s; its end is shown\n"
    assert np.array_equal(picture(run, "--time", "9", said=over), late), "after the last key frame it stands still"
    assert np.array_equal(picture(run, "--animation", "1", "--time", "2"),
                          picture(run, "--animation", "rise", "--time", "2"))


def test_python_shows_the_same(run, moving):
    scene = viewer.load(moving, environment=None)
    scene = scene.relit(lights=(viewer.Light.from_angles(0, 0, 3),))
    camera = viewer.Camera.look_at((0, 0, 4), (0, 0, 0))
    image = viewer.render(scene, (24, 24), camera, time=1.5, background="none")
    assert np.array_equal(image.srgb, picture(run, "--time", "1.5"))


def test_a_film_that_is_over_is_one_line_and_a_turntable_begins_anew(run, moving):
    outcome = run("render", "a.glb", "-o", "a.gif", *PLAIN, "--time", "9")
    assert outcome.status == 1
    assert outcome.err == "pbr-viewer: a.glb: animations: --time 9: 'come' is over by then; it takes 2 s\n"
    outcome = run("render", "a.glb", "-o", "a.gif", *PLAIN[:-6], "--time", "9", "--animation", "0", "--turntable", "2")
    assert (outcome.status, outcome.err) == (0, "")


def test_info_lists_them(run, moving):
    run("info", "a.glb", "--json", "a.json")
    assert json.loads((moving.parent / "a.json").read_text())["animations"] == [
        "come, 2 s: translation of 1 node", "rise, 2 s: translation of 1 node"]


@pytest.mark.parametrize("options, problem", [
    (("--animation", "fly"), "a.glb: animations: --animation fly: the file has come, rise, counted from 0"),
    (("--animation", "2"), "--animation 2: the file has come, rise"),
])
def test_an_animation_that_is_not_there(run, moving, options, problem):
    outcome = run("render", "a.glb", "-o", "a.png", *options)
    assert outcome.status == 1 and problem in outcome.err and outcome.err.count("\n") == 1


def test_a_file_without_animations(run, folder):
    outcome = run("render", SCENES / "unlit.glb", "-o", "a.png", "--time", "1")
    assert outcome.status == 1 and "animations: --time: the file has none" in outcome.err
    scene = viewer.load(SCENES / "unlit.glb")
    with pytest.raises(viewer.UsageError, match="time is of type str, not a number of seconds"):
        viewer.render(scene, time="1")


def test_an_animation_that_cannot_be_played_is_told_from_none(run, folder):
    builder = GltfBuilder()
    node = builder.node(mesh=builder.triangle())
    sampler = {"input": builder.accessor([2, 0]), "output": builder.accessor([[0, 0, 0], [1, 0, 0]])}
    builder.add("animations", {"samplers": [sampler],
                               "channels": [{"sampler": 0, "target": {"node": node, "path": "translation"}}]})
    (folder / "a.glb").write_bytes(builder.glb())
    why = "none that can be played: animations[0].samplers[0].input: times must be finite, each after the one before"
    for options in (("--time", "1"), ("--animation", "0")):
        outcome = run("render", "a.glb", "-o", "a.png", *options)
        assert outcome.status == 1 and why in outcome.err and outcome.err.count("\n") == 1
    outcome = run("render", "a.glb", "-o", "a.gif")
    assert outcome.status == 1 and "animations: there are none that can be played, so nothing moves" in outcome.err


def test_a_pose_that_cannot_be_drawn_is_told_of_the_file(run, folder):
    builder = GltfBuilder()
    node = builder.node(mesh=builder.triangle())
    sampler = {"input": builder.accessor([0, 1]), "output": builder.accessor([[1, 1, 1], [1e30, 1, 1]])}
    builder.add("animations", {"name": "grow", "samplers": [sampler],
                               "channels": [{"sampler": 0, "target": {"node": node, "path": "scale"}}]})
    (folder / "a.glb").write_bytes(builder.glb())
    for options in (("-o", "a.png", "--time", "1"), ("-o", "a.gif", "--fps", "2")):
        outcome = run("render", "a.glb", *options, "--size", "8")
        assert outcome.status == 1 and "pbr-viewer: a.glb: animation 'grow': at " in outcome.err
        assert "cannot be drawn" in outcome.err and outcome.err.count("\n") == 1
        assert not (folder / options[1]).exists()
