"""The files of a window: those beside the one that is shown, and the one that is shown when it changes; full screen."""

from __future__ import annotations

import shutil

import glfw
import numpy as np
import pytest
from click.testing import CliRunner

import viewer
from viewer.app.watch import FileWatch
from viewer.base.resources import resource_folder
from viewer.cli import cli
from viewer.errors import InputError
from viewer.interact.model_files import ModelFiles
from viewer.scene.files import stamp_of
from viewer.scene.load import load_scene
from viewer.scene.model_files import models_in

from .conftest import SIZE

SCENES = resource_folder("assets") / "scenes"
TRIANGLE = "mtllib paint.mtl\nusemtl paint\nv 0 0 0\nv 1 0 0\nv 0 1 {z}\nf 1 2 3\n"


@pytest.fixture
def folder(tmp_path):
    (tmp_path / "models" / "more").mkdir(parents=True)
    for name in ("b.glb", "a.glb", "more/c.glb"):
        shutil.copy(SCENES / "unlit.glb", tmp_path / "models" / name)
    (tmp_path / "models" / "notes.txt").write_text("no model")
    (tmp_path / "models" / ".hidden.glb").write_bytes(b"")
    return tmp_path / "models"


def test_files_beside_one_are_those_of_its_folder_in_a_ring(folder):
    files = ModelFiles(str(folder / "a.glb"))
    assert files.beside(1) == files.beside(-1) == str(folder / "b.glb")
    (folder / "0.stl").write_text("solid\nendsolid\n")
    assert [files.beside(step) for step in (1, -1)] == [str(folder / "b.glb"), str(folder / "0.stl")]
    files.path = str(folder / "gone.glb")  # its place counts, not it
    assert [files.beside(step) for step in (1, -1)] == [str(folder / "0.stl"), str(folder / "b.glb")]


def test_files_of_a_folder_are_those_in_its_folders_too(folder):
    files = ModelFiles(str(folder / "b.glb"), str(folder))
    assert [files.beside(step) for step in (1, -1)] == [str(folder / "more" / "c.glb"), str(folder / "a.glb")]


def test_files_of_a_folder_come_before_those_in_its_folders_and_all_of_them_come(tmp_path):
    """In the order in which `view FOLDER` finds them: more/ is before z, and more-b before more/c by characters."""
    for name in ("a.glb", "z.glb", "more/c.glb", "more-b/d.glb"):
        (tmp_path / name).parent.mkdir(exist_ok=True)
        (tmp_path / name).write_bytes(b"")
    found = models_in(tmp_path)
    for start, end, step in ((0, 1, 1), (1, 2, 1), (2, 3, 1), (3, 0, 1), (0, 3, -1), (3, 2, -1), (2, 1, -1)):
        files = ModelFiles(str(found[start]), str(tmp_path))
        assert files.beside(step) == str(found[end]), (start, step)


def test_without_another_file_there_is_none_beside(folder):
    with pytest.raises(InputError, match="no file"):
        ModelFiles().beside(1)
    with pytest.raises(InputError, match="no other model"):
        ModelFiles(str(folder / "more" / "c.glb")).beside(1)


def test_what_a_file_refers_to_is_noted_and_what_is_missing_too(tmp_path):
    (tmp_path / "model.obj").write_text(TRIANGLE.format(z=0))
    (tmp_path / "paint.mtl").write_text("newmtl paint\nmap_Kd wood.png\n")
    files = ModelFiles()
    files.load(str(tmp_path / "model.obj"))
    assert {path.name for path in files.read} == {"model.obj", "paint.mtl", "wood.png"}


def test_a_change_is_told_once_when_it_is_over(tmp_path, monkeypatch):
    monkeypatch.setattr("viewer.app.watch.INTERVAL", 0.0)
    file = tmp_path / "a"
    file.write_text("1")
    watch = FileWatch()
    assert not watch.poll()
    watch.follow({path: stamp_of(path) for path in (file, tmp_path / "missing")})
    assert not watch.poll()
    file.write_text("22")
    assert not watch.poll()  # still being written, perhaps
    file.write_text("333")
    assert not watch.poll()
    assert watch.poll() and not watch.poll()
    (tmp_path / "missing").write_text("there")
    assert [watch.poll(), watch.poll(), watch.poll()] == [False, True, False]


def test_a_change_while_the_file_is_read_is_told_too(tmp_path, monkeypatch):
    monkeypatch.setattr("viewer.app.watch.INTERVAL", 0.0)
    model = tmp_path / "model.obj"
    model.write_text(TRIANGLE.format(z=0))

    def load(path):
        scene = load_scene(path)
        model.write_text(TRIANGLE.format(z=1.25))
        return scene

    files = ModelFiles(load=load)
    watch = FileWatch()
    assert files.load(str(model)).bounds[1][2] == 0
    watch.follow(files.read)
    assert [watch.poll() for _ in range(3)] == [False, True, False]


def test_page_keys_show_the_other_files_and_go_past_a_broken_one(open_window, folder):
    (folder / "c.glb").write_bytes(b"glTF nothing")
    first = folder / "a.glb"
    window = (hands := open_window(viewer.load(first, None), files=ModelFiles(str(first)))).window
    for key, name, is_error in (("Next", "b.glb", False), ("Next", "c.glb", True), ("Next", "a.glb", False),
                                ("Prior", "c.glb", True), ("Prior", "b.glb", False)):
        window.state.message = ""
        hands.key(key)
        assert window._files.path == str(folder / name), (key, name)
        assert is_error != (window._files.shown == str(folder / name))  # what a copied command line names
        assert window.state.is_error == is_error or not window.state.message
        assert is_error == ("c.glb" in window.state.message)


def test_the_file_is_loaded_again_when_it_changes_or_what_it_refers_to(open_window, tmp_path, monkeypatch):
    monkeypatch.setattr("viewer.app.watch.INTERVAL", 0.02)
    model, paint = tmp_path / "model.obj", tmp_path / "paint.mtl"
    model.write_text(TRIANGLE.format(z=0))
    paint.write_text("newmtl paint\nKd 1 0 0\n")
    files = ModelFiles()
    hands = open_window(files.load(str(model)), files=files, watch=True)
    state, orbit = hands.window.state, hands.window.orbit
    hands.drag((160, 120), (184, 144))
    azimuth, target = orbit.azimuth, orbit.target.copy()

    paint.write_text("newmtl paint\nKd 0 0 1.0\n")
    hands.until(lambda: state.message)
    assert state.message == "Loaded model.obj again" and state.scene.materials[0].base_color[2] == 1
    state.message = ""
    model.write_text("v 0 0 0\nnonsense f 1\nf 1 2 9\n")
    hands.until(lambda: state.message)
    assert state.is_error and "model.obj" in state.message and state.scene.materials[0].base_color[2] == 1
    state.message = ""
    model.write_text(TRIANGLE.format(z=1.25))
    hands.until(lambda: state.message)
    assert not state.is_error and state.scene.bounds[1][2] == 1.25
    assert orbit.azimuth == azimuth and np.array_equal(orbit.target, target)


def test_full_screen_and_back(open_window):
    hands = open_window(viewer.load(SCENES / "unlit.glb", None))
    hands.window.state.panel = True
    screen = glfw.get_video_mode(glfw.get_primary_monitor()).size
    for back in ("F11", "Escape"):
        hands.key("F11")
        hands.until(lambda: glfw.get_window_size(hands.window.window) == (screen.width, screen.height))
        assert (hands.screen()[:200, -200:].max(axis=(1, 2)) > 20).all()  # the panel is whole
        hands.key(back)
        hands.until(lambda: glfw.get_window_size(hands.window.window) == SIZE)
    assert not hands.window.is_closed


def test_a_model_alone_is_viewed_and_other_words_are_no_commands(monkeypatch, folder):
    seen = []
    monkeypatch.setattr("viewer.app.open_window", lambda scene, *_, **named: seen.append((scene.name, named)))
    run = CliRunner().invoke
    for arguments in (["view", str(folder)], [str(folder)], [str(folder / "a.glb"), "--watch", "--fullscreen"]):
        assert run(cli, arguments).exit_code == 0, arguments
    assert [name for name, _ in seen] == ["a"] * 3
    assert [(named["watch"], named["full_screen"]) for _, named in seen] == [(False, False)] * 2 + [(True, True)]
    assert [named["files"].beside(-1) for _, named in seen] == [str(folder / "more" / "c.glb")] * 2 + [
        str(folder / "b.glb")]
    assert seen[2][1]["files"].read.keys() == {(folder / "a.glb").absolute()}
    for name in ("a.glb", "b.glb"):
        (folder / name).write_bytes(b"")
    outcome = run(cli, ["view", str(folder)])
    assert seen[3][0] == "c" and [line.endswith(".glb: the file is empty") for line in outcome.output.splitlines()] == [
        True, True]
    (folder / "more" / "c.glb").write_bytes(b"")
    with pytest.raises(InputError, match="a.glb: the file is empty"):
        cli.main([str(folder)], standalone_mode=False)
    with pytest.raises(InputError, match="no such file"):
        cli.main(["missing.glb"], standalone_mode=False)
    assert "No such command 'rendr'" in run(cli, ["rendr", "a.glb"]).output
