"""Pictures of several models: what is told, what is measured, where they go."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from command_line import SCENES, names

from viewer.errors import UsageError
from viewer.image.image import Image
from viewer.jobs.render_job import output_paths

MODEL = SCENES / "unlit.glb"
SMALL = ("--size", "24")


def test_a_picture_goes_where_out_says(folder):
    (folder / "out").mkdir()
    cases = [("a.png", ["x/m.glb"], ["a.png"], []), ("no/a.png", ["m.glb"], ["no/a.png"], []),
             ("out", ["x/m.glb"], ["out/m.png"], ["out"]), ("new/", ["m"], ["new/m.png"], ["new"]),
             ("new/", ["m", "n"], ["new/m.png", "new/n.png"], ["new"]),
             ("new/{name}-s.EXR", ["x/m.v2.glb", "n"], ["new/m.v2-s.EXR", "new/n-s.EXR"], ["new"]),
             ("{name}/a.png", ["m", "n"], ["m/a.png", "n/a.png"], ["m", "n"])]
    for output, models, paths, folders in cases:
        assert output_paths(models, output) == ([Path(path) for path in paths], [Path(path) for path in folders])


@pytest.mark.parametrize("output", ["a.png", "a", "{name}.bmp", "same-{name}.png"])
def test_a_place_that_does_not_fit_is_refused_before_any_work(folder, output):
    with pytest.raises(UsageError):
        output_paths(["x/m.glb", "y/m.glb"] if "same" in output else ["m.glb", "n.glb"], output)


@pytest.mark.parametrize("output", ["shots/", "shots/{name}.png"])
def test_a_folder_is_made_for_pictures_alone(run, folder, output):
    models = [SCENES / "unlit.glb", SCENES / "emissive.glb"]
    outcome = run("render", *models, "-o", output, *SMALL, "--stats", "shots/stats.json")
    assert (outcome.status, outcome.err) == (0, "")
    assert names(folder) == ["shots"] and names(folder / "shots") == ["emissive.png", "stats.json", "unlit.png"]
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
    assert names(folder) == ["empty.glb", "spheres.png", "stats.json", "unlit.png"]
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
    assert stats["memory"]["peak_rss_mb"] > 10 and stats["memory"]["textures_mb"] >= 0
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
