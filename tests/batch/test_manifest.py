"""The manifest of a batch: what is done already, and what a run leaves that is stopped in the middle."""

from __future__ import annotations

import json
import os
import platform
import shutil
import subprocess
import sys
from pathlib import Path

import pytest
from command_line import SCENES, names
from needs import needs

from viewer.base.atomic import atomic_write
from viewer.batch.keys import Keys
from viewer.batch.manifest import MANIFEST, Line, Manifest
from viewer.errors import OutputError
from viewer.image.image import Image
from viewer.jobs.render_job import RenderJob, RenderTask

SMALL = ("--size", "24")
TASK = RenderTask("m.glb", Path("m.png"))


def line(out: str, key: str = "k", status: str = "done") -> Line:
    return Line("m.glb", out, key, status, None if status == "done" else "broken", 1.5, "here:1")  # type: ignore[arg-type]


def lines(folder: Path) -> list[dict]:
    return [json.loads(text) for text in (folder / MANIFEST).read_text().splitlines()]


def test_a_line_is_of_the_promised_form(folder):
    with Manifest(folder) as manifest:
        manifest.add([line("a/m.png"), line("n.png", status="failed")])
    assert (folder / MANIFEST).read_text().splitlines() == [
        '{"model": "m.glb", "out": "a/m.png", "key": "k", "status": "done", "error": null, "seconds": 1.5, '
        '"worker": "here:1"}',
        '{"model": "m.glb", "out": "n.png", "key": "k", "status": "failed", "error": "broken", "seconds": 1.5, '
        '"worker": "here:1"}']


def test_two_commands_in_one_folder_lose_no_line(folder):
    with Manifest(folder) as first:
        first.add([line("a.png")])
        with Manifest(folder) as second:
            first.add([line("a.png", key="of the first")])
            second.add([line("b.png")])
            second.add([line("b.png", key="of the second")])
        assert len(lines(folder)) == 4, "the second does not know the lines of the first, and may not remove repeats"
    assert len(lines(folder)) == 4
    with Manifest(folder) as second:
        with Manifest(folder) as first:
            first.add([line("c.png")])
        assert len(lines(folder)) == 3, "the first has put another file, without repeats, in the place of the second's"
        second.add([line("d.png")])
    assert {entry["out"] for entry in lines(folder)} == {"a.png", "b.png", "c.png", "d.png"}


@needs("posix")
def test_a_manifest_that_vanishes_is_not_begun_anew(folder):
    with Manifest(folder) as manifest:
        manifest.add([line("a.png")])
        (folder / MANIFEST).unlink()
        with pytest.raises(OutputError, match="was removed while pictures were made; --resume makes what is missing"):
            manifest.add([line("b.png")])
    assert names(folder) == []


def test_only_whole_pictures_of_the_same_key_are_done(folder):
    with Manifest(folder) as manifest:
        manifest.add([line("m.png")])
        assert not manifest.is_done(TASK, "k")  # there is no file
        (folder / "m.png").touch()
        assert manifest.is_done(TASK, "k") and not manifest.is_done(TASK, "other")
        manifest.add([line("m.png", status="failed")])
        assert not manifest.is_done(TASK, "k")
        for names_of_views, expected in ((("m_front.png", "m_top.png"), True), (("m_front.png", "m_left.png"), False)):
            manifest.add([line(name) for name in names_of_views])
            (folder / names_of_views[0]).touch()
            (folder / "m_top.png").touch()
            assert manifest.is_done(TASK, "k") == expected, "all views of the model, whatever went before"


def test_the_last_line_of_a_picture_counts_and_the_others_go(folder):
    (folder / "m.png").touch()
    with Manifest(folder) as manifest:
        manifest.add([line("m.png", "old"), line("n.png")])
        manifest.add([line("m.png", "new")])
        assert len(lines(folder)) == 3, "each is written at once"
    assert [(each["out"], each["key"]) for each in lines(folder)] == [("n.png", "k"), ("m.png", "new")]
    with Manifest(folder) as manifest:
        assert manifest.is_done(TASK, "new") and not manifest.is_done(TASK, "old")


def test_the_views_of_a_model_take_the_place_of_its_failure(folder):
    with Manifest(folder) as manifest:
        manifest.add([line("m.png", "old", "failed")], "m.png")
        manifest.add([line("m_front.png", "new"), line("m_top.png", "new")], "m.png")
    assert [each["out"] for each in lines(folder)] == ["m_front.png", "m_top.png"]


def test_a_line_that_is_cut_off_is_left_out(folder, capsys):
    with Manifest(folder) as manifest:
        manifest.add([line("m.png"), line("n.png")])
    whole = (folder / MANIFEST).read_bytes()
    (folder / MANIFEST).write_bytes(whole[:-9])
    with Manifest(folder) as manifest:
        manifest.add([line("o.png")])
    assert "the last line is cut off" in capsys.readouterr().err
    assert [each["out"] for each in lines(folder)] == ["m.png", "o.png"]


def test_the_views_of_a_model_leave_its_other_picture_alone(folder):
    with Manifest(folder) as manifest:
        manifest.add([line("m.png")], "m.png")
        manifest.add([line("m_front.png", "new")], "m.png")
    assert [each["out"] for each in lines(folder)] == ["m.png", "m_front.png"]


@needs("posix")
def test_nobody_waits_for_a_pipe(folder):
    os.mkfifo("m.glb")
    assert Keys(RenderJob({})).of("m.glb", "m.png") == Keys(RenderJob({})).of("none.glb", "m.png")
    os.mkfifo(MANIFEST)
    with pytest.raises(OutputError, match="manifest.jsonl: is not a regular file"):
        Manifest(folder)


LINE = {"model": "m.glb", "out": "m.png", "key": "k", "status": "done", "error": None, "seconds": 1.5, "worker": "a:1"}


@pytest.mark.parametrize("text", ["{}\n", "[1, 2]\n", "text\n", '{"image": "a.png", "caption": "a cat"}\n',
                                  "[" * 9999 + "\n", *(json.dumps(LINE | changed) + "\n" for changed in (
                                      {"out": 2}, {"key": {}}, {"status": "new"}, {"seconds": float("inf")},
                                      {"seconds": "1"}, {"cameras": 5}, {"cameras": [5]}, {"error": [1]}))],
                         ids=lambda text: text[:60])
def test_the_file_of_another_program_is_left_alone(folder, text):
    (folder / MANIFEST).write_text(text)
    with pytest.raises(OutputError, match="line 1: is no line of a manifest"), Manifest(folder):
        pass
    assert (folder / MANIFEST).read_text() == text


def test_a_key_follows_all_that_a_picture_is_made_from(folder):
    gltf = {"asset": {"version": "2.0"}, "buffers": [{"uri": "part%201.bin", "byteLength": 1}],
            "images": [{"uri": "data:,x"}, {"uri": "../outside.png"}]}
    (folder / "m.gltf").write_text(json.dumps(gltf))
    (folder / "o.obj").write_text("mtllib o.mtl \"other one.mtl\"\nv 0 0 0\n")
    (folder / "o.mtl").write_text("newmtl a\nmap_Kd -s 1 1 1 map.png\n")
    (folder / "other one.mtl").write_text("newmtl b\nmap_Kd -o 1 a map.png # of wood\n")
    (folder / "c.dae").write_text("<image><init_from>a&amp;b.png</init_from></image>"
                                  "<image><init_from>\n <ref>./c%201.png</ref></init_from></image>")
    (folder / "p.ply").write_bytes(b"ply\r\nformat ascii 1.0\r\ncomment TextureFile sub\\p 1.png\r\nend_header\n"
                                   b"comment TextureFile map.png\n")
    (folder / "sub").mkdir()
    for name in ("part 1.bin", "map.png", "a&b.png", "c 1.png", "sub/p 1.png", "a map.png", "studio.hdr", "weave.json"):
        (folder / name).write_bytes(b"0")
    options = {"size": (8, 8), "env": "studio.hdr", "assignments": ("weave=weave.json,Cloth",), "quiet": False}

    def keys(**changed: object) -> list[str]:
        made = Keys(RenderJob(options | changed))
        return [made.of(name, "a.png") for name in ("m.gltf", "o.obj", "c.dae", "p.ply")]

    first = keys()
    assert keys() == first == keys(quiet=True), "and nothing else"
    seen = {*first}
    for change in ({"size": (8, 9)}, {"assignments": ()}):
        assert not seen & {*keys(**change)}
    for name, changed in (("part 1.bin", 0), ("map.png", 1), ("o.mtl", 1), ("other one.mtl", 1), ("a map.png", 1),
                          ("m.gltf", 0), ("a&b.png", 2), ("c 1.png", 2), ("sub/p 1.png", 3), ("p.ply", 3)):
        before = keys()
        with (folder / name).open("a") as file:
            file.write(" ")
        assert [old != new for old, new in zip(before, keys())] == [changed == k for k in range(4)], name
    for name in ("studio.hdr", "weave.json"):
        before = keys()
        (folder / name).write_bytes(b"1")
        assert all(old != new for old, new in zip(before, keys())), name
    assert Keys(RenderJob(options)).of("none.glb", "a.png") != Keys(RenderJob(options)).of("none.glb", "b.png")


def test_resume_makes_what_is_missing_and_leaves_the_rest_alone(run, folder):
    models = ["models/a.glb", "models/b.glb", "models/c.glb"]
    (folder / "models").mkdir()
    for model in models[:2]:
        shutil.copy(SCENES / "unlit.glb", model)
    Path(models[2]).touch()
    assert run("render", "models", "-o", "out/", *SMALL).error == "models/c.glb: the file is empty"
    assert [(each["out"], each["status"], each["error"]) for each in lines(folder / "out")] == [
        ("a.png", "done", None), ("b.png", "done", None), ("c.png", "failed", "models/c.glb: the file is empty")]
    (folder / "out" / "a.png").write_bytes(b"kept")
    (folder / "out" / "b.png").unlink()
    shutil.copy(SCENES / "unlit.glb", models[2])
    outcome = run("render", "models", "-o", "out/", *SMALL, "--resume", "--stats", "stats.json")
    assert (outcome.status, outcome.err) == (0, "1 of 3 models are done already\n")
    stats = json.loads((folder / "stats.json").read_text())
    assert [record["output"] for record in stats] == ["out/b.png", "out/c.png"]
    assert (folder / "out" / "a.png").read_bytes() == b"kept" and Image.open("out/c.png").size == (24, 24)
    assert sorted((each["out"], each["status"]) for each in lines(folder / "out")) == [
        ("a.png", "done"), ("b.png", "done"), ("c.png", "done")]
    shutil.copy(SCENES / "emissive.glb", models[0])
    assert run("render", "models", "-o", "out/", *SMALL, "--resume").err.startswith("2 of 3 models")
    assert Image.open("out/a.png").size == (24, 24)
    assert run("render", "models", "-o", "out/", *SMALL, "--resume", "--exposure", "1", "-q").err == ""


def test_a_single_picture_has_a_manifest_only_to_resume(run, folder):
    assert run("render", SCENES / "unlit.glb", "-o", "a.png", *SMALL).status == 0 and names(folder) == ["a.png"]
    assert run("render", SCENES / "unlit.glb", "-o", "a.png", *SMALL, "--resume").err.startswith("0 of 1")
    assert run("render", SCENES / "unlit.glb", "-o", "a.png", *SMALL, "--resume").err.startswith("1 of 1")
    assert names(folder) == ["a.png", MANIFEST]


def test_what_may_pass_is_tried_again(run, folder, monkeypatch):
    tries = []

    def full(self: Image, path: Path) -> None:
        tries.append(path.name)
        if path.name == "unlit.png" and len(tries) < 3:
            raise OutputError(f"{path}: cannot be written: No space left on device")

    monkeypatch.setattr(Image, "save", full)
    models = [SCENES / "unlit.glb", SCENES / "emissive.glb"]
    assert run("render", *models, "-o", "out/", *SMALL, "--retries", "2").status == 0
    assert tries == ["unlit.png", "emissive.png", "unlit.png"] and len(lines(folder / "out")) == 2
    tries.clear()
    outcome = run("render", *models, "none.glb", "-o", "out/", *SMALL, "--retries", "0")
    assert outcome.status == 1 and tries == ["unlit.png", "emissive.png"]
    assert [each["status"] for each in lines(folder / "out")] == ["failed", "done", "failed"]


def test_leftovers_of_killed_processes_go_and_those_of_others_stay(run, folder):
    killed = subprocess.Popen([sys.executable, "-c", ""])
    killed.wait()
    (folder / "out").mkdir()
    gone = folder / "out" / f".pbr-viewer-{platform.node()}-{killed.pid}-0123abcd.png"
    kept = [gone.with_name(f".pbr-viewer-{platform.node()}-{os.getpid()}-0123abcd.png"),
            gone.with_name(f".pbr-viewer-elsewhere-{killed.pid}-0123abcd.png"), gone.with_name(f"{killed.pid}.png")]
    for file in (gone, *kept):
        file.touch()
    assert run("render", SCENES / "unlit.glb", "-o", "out/", *SMALL).status == 0
    assert not gone.exists() and all(file.exists() for file in kept)
    with atomic_write(folder / "b.png") as temporary:
        assert temporary.name.startswith(f".pbr-viewer-{platform.node()}-{os.getpid()}-")
