"""Pictures of several models: what is told, what is measured, where they go."""

from __future__ import annotations

import io
import json
import os
from pathlib import Path

import pytest
from command_line import SCENES, names

from viewer.errors import InputError, UsageError
from viewer.image.image import Image
from viewer.jobs.inputs import find_models
from viewer.jobs.outputs import Outputs, output_paths
from viewer.jobs.render_job import RenderTask

MODEL = SCENES / "unlit.glb"
SMALL = ("--size", "24")


def test_a_picture_goes_where_out_says(folder):
    (folder / "out").mkdir()
    cases = [("a.png", ["x/m.glb"], ["a.png"], ["."]), ("no/a.png", ["m.glb"], ["no/a.png"], ["no"]),
             ("out", ["x/m.glb"], ["out/m.png"], ["out"]), ("new/", ["m"], ["new/m.png"], ["new"]),
             ("new/", ["m", "n"], ["new/m.png", "new/n.png"], ["new"]),
             ("new/{name}-s.EXR", ["x/m.v2.glb", "n"], ["new/m.v2-s.EXR", "new/n-s.EXR"], ["new"]),
             ("{name}/a.png", ["m", "n"], ["m/a.png", "n/a.png"], ["m", "n"])]
    for output, models, paths, folders in cases:
        assert output_paths(models, output) == Outputs(tuple(map(Path, paths)), tuple(map(Path, folders)))


def test_models_of_one_name_keep_the_names_of_their_folders(folder):
    cases = [(["x/m.glb", "n.glb", "y/m.gltf"], ["x/m", "n", "y/m"]),
             (["data/x/low/m.glb", "data/y/low/m.glb", "data/m.glb"], ["x/low/m", "y/low/m", "m"]),
             (["m.glb", "m.obj", "x/m.obj"], ["m.glb", "m.obj", "x/m"]),
             ([str(folder / "a/m.glb"), "b/m.glb"], ["a/m", "b/m"])]
    for models, shown in cases:
        for output in ("out/", "out/{name}.png"):
            outputs = output_paths(models, output)
            assert list(outputs.paths) == [Path(f"out/{name}.png") for name in shown]
            assert set(outputs.folders) == {path.parent for path in outputs.paths}


@pytest.mark.parametrize("output", ["a.png", "a", "{name}.bmp", "same/"])
def test_a_place_that_does_not_fit_is_refused_before_any_work(folder, output):
    with pytest.raises(UsageError):
        output_paths(["m.glb", "m.obj", "x/m.glb.obj"] if "same" in output else ["m.glb", "n.glb"], output)


def test_several_views_have_names_of_their_own():
    plain, pattern = RenderTask("m", Path("out/m.v2.png")), RenderTask("m", Path("{view}/m.png"), Path("e-{view}.exr"))
    assert [plain.picture(label) for label in ("", "front")] == [Path("out/m.v2.png"), Path("out/m.v2_front.png")]
    assert (pattern.picture("top"), pattern.map_of_error("top")) == (Path("top/m.png"), Path("e-top.exr"))
    assert plain.map_of_error("front") is None


def test_models_are_files_folders_patterns_and_a_list(folder, monkeypatch):
    for name in ("b.glb", "a.GLTF", "a.png", "deep/er/c.obj", "deep/.hidden.glb", ".git/d.glb", "odd[1].glb"):
        (folder / name).parent.mkdir(parents=True, exist_ok=True)
        (folder / name).touch()
    everything = ["a.GLTF", "b.glb", "odd[1].glb", "deep/er/c.obj"]
    assert [str(Path(model)) for model in find_models(["."])] == everything
    assert find_models(["b.glb", "deep", "./b.glb", "*.glb"]) == ["b.glb", "deep/er/c.obj", "odd[1].glb"]
    assert find_models(["**/*.obj", "none.glb", "odd[1].glb"]) == ["deep/er/c.obj", "none.glb", "odd[1].glb"]
    for text in (b"b.glb\r\n\nde\xe9p[x].glb\n", b"b.glb\0de\xe9p[x].glb\0"):
        monkeypatch.setattr("sys.stdin", io.TextIOWrapper(io.BytesIO(text)))
        assert find_models(["-"]) == ["b.glb", os.fsdecode(b"de\xe9p[x].glb")]
    (folder / "linked").symlink_to("deep", target_is_directory=True)
    (folder / "deep/back").symlink_to("..", target_is_directory=True)  # never ends
    assert [Path(model).as_posix() for model in find_models(["."])] == [*everything, "linked/er/c.obj"]
    (folder / "empty").mkdir()
    for argument in ("-", "[x].glb", "empty"):
        monkeypatch.setattr("sys.stdin", io.TextIOWrapper(io.BytesIO(b" \n")))
        with pytest.raises(InputError):
            find_models([argument])


@pytest.mark.parametrize("output", ["shots/", "shots/{name}.png"])
def test_a_folder_is_made_for_pictures_alone(run, folder, output):
    models = [SCENES / "unlit.glb", SCENES / "emissive.glb"]
    outcome = run("render", *models, "-o", output, *SMALL, "--stats", "shots/stats.json")
    assert (outcome.status, outcome.err) == (0, "")
    assert names(folder) == ["shots"]
    assert names(folder / "shots") == ["emissive.png", "manifest.jsonl", "stats.json", "unlit.png"]
    assert run("render", *models, "-o", output, *SMALL).status == 0


@pytest.mark.parametrize("arguments, error", [
    (["none.glb"], "none.glb: no such file"),
    ([MODEL, "--env", "none.hdr"], "none.hdr: no such file"),
    ([MODEL, "--stats", "no/s.json"], "no/s.json: the folder no does not exist"),
])
def test_no_folder_is_left_where_nothing_was_made(run, folder, arguments, error):
    outcome = run("render", *arguments, "-o", "shots/", *SMALL)
    assert (outcome.status, outcome.error) == (1, error)
    assert names(folder) == []


def test_of_several_models_a_bad_one_does_not_stop_the_others(run, folder):
    (folder / "empty.glb").touch()
    outcome = run("render", SCENES / "unlit.glb", "empty.glb", SCENES / "spheres.glb", "-o", folder, *SMALL,
                  "--stats", "stats.json")
    assert outcome.status == 1 and outcome.error == "empty.glb: the file is empty"
    assert names(folder) == ["empty.glb", "manifest.jsonl", "spheres.png", "stats.json", "unlit.png"]
    records = json.loads((folder / "stats.json").read_text())
    assert [record.get("error") for record in records] == [None, "empty.glb: the file is empty", None]


def test_a_bad_environment_is_told_once_for_all_models(run, folder):
    (folder / "bad.hdr").write_text("#?RADIANCE\n")
    outcome = run("render", SCENES / "unlit.glb", SCENES / "spheres.glb", "-o", folder, *SMALL, "--env", "bad.hdr")
    assert outcome.status == 1 and outcome.error.startswith("bad.hdr: ")
    assert names(folder) == ["bad.hdr"]


def test_verbose_tells_the_device_and_the_times(run, folder):
    lines = run("render", MODEL, "-o", "a.png", *SMALL, "-v").err.splitlines()
    assert len(lines) == 2 and "OpenGL" in lines[0]
    told = ("a.png: load ", "render ", "save ", "total ", "compile and upload", "plan: ")
    assert all(word in lines[1] for word in told)


def test_stats_hold_times_the_plan_and_memory(run, folder):
    assert run("render", SCENES / "lights.glb", "-o", "a.png", *SMALL, "--stats", "s.json").status == 0
    stats = json.loads((folder / "s.json").read_text())
    assert stats["size"] == [24, 24] and stats["device"] and stats["backend"] in ("egl", "osmesa", "window")
    parts = stats["wall_s"]
    assert parts["total"] == pytest.approx(parts["load"] + parts["render"] + parts["save"])
    assert {"surfaces", "resolve", "display", "background"} <= set(stats["pass_ms"])
    assert all(value >= 0 for value in [*stats["pass_ms"].values(), *stats["prepare_s"].values()])
    assert stats["plan"]["passes"][-1] == "display" and stats["plan"]["draws"] >= 1
    assert stats["memory"]["peak_rss_mb"] >= stats["memory"]["rss_mb"] > 10 and stats["memory"]["textures_mb"] >= 0
    assert names(folder) == ["a.png", "s.json"]


def test_warnings_name_the_model_and_quiet_drops_them(run, folder):
    model = json.loads(json.dumps({"asset": {"version": "2.0"}, "extensionsUsed": ["EXT_unheard_of"],
                                   "scenes": [{"nodes": []}], "scene": 0}))
    (folder / "odd.gltf").write_text(json.dumps(model))
    outcome = run("render", "odd.gltf", "-o", "a.png", *SMALL)
    assert outcome.status == 0 and "EXT_unheard_of" in outcome.err
    assert all(line.startswith("odd.gltf: warning: ") for line in outcome.err.splitlines())
    assert run("render", "odd.gltf", "-o", "a.png", *SMALL, "-q").err == ""


def test_a_scene_that_nothing_lights_is_told_once(run, folder):
    dark = run("render", SCENES / "spheres.glb", "-o", "a.png", *SMALL, "--env", "none")
    assert dark.status == 0 and dark.err.count("\n") == 1
    assert dark.err.startswith(f"{SCENES / 'spheres.glb'}: warning: ") and "black" in dark.err
    assert not Image.open("a.png").srgb[..., :3].any()
    for arguments in (["--env", "none", "--light", "0,0,3"], ["--env", "furnace"], ["--env", "none", "-q"]):
        assert run("render", SCENES / "spheres.glb", "-o", "a.png", *SMALL, *arguments).err == ""
    for model in ("unlit", "emissive", "lights"):
        assert run("render", SCENES / f"{model}.glb", "-o", "a.png", *SMALL, "--env", "none").err == ""
