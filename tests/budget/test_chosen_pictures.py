"""Budgets and errors through the doors. How far a picture gets depends on the machine; that it is told truly does not.
"""

from __future__ import annotations

import json

import numpy as np
import pytest
from command_line import SCENES, runner

import viewer
from viewer.errors import UsageError

MODEL = SCENES / "spheres.glb"
SIZE = 32, 32
KEYS = ["method", "seconds", "spp", "error", "error_low", "error_high", "error_is", "time_budget", "error_target",
        "unmet", "candidates", "unfinished", "compared"]


@pytest.fixture
def run(capsys):
    return runner(capsys)


@pytest.fixture(scope="module")
def balls():
    return viewer.load(MODEL, "furnace")


def test_the_command_line_tells_how_the_picture_came_about(run, tmp_path):
    output, stats = tmp_path / "a.exr", tmp_path / "a.json"
    done = run("render", MODEL, "-o", output, "--size", "32", "--env", "furnace", "--time-budget", "1",
               "--background", "#ff0000", "--stats", stats)
    assert done.status == 0
    found = json.loads(stats.read_text())
    choice = found["choice"]
    assert f"{output}: time budget 1 s: {choice['method']}" in done.err and list(choice) == KEYS
    assert choice["candidates"][0]["method"] == "image-based light, no antialiasing"
    assert choice["candidates"][0]["seconds"] is not None and choice["time_budget"] == 1
    assert ("estimated_error" in found) == (choice["error_is"] == "measured")
    assert viewer.Image.open(output).linear[0, 0].tolist() == [1, 0, 0, 1]


def test_an_error_is_reached_and_measured(balls):
    right = viewer.render(balls, SIZE, mode="path", spp=400).linear[..., :3].astype(np.float64)
    for target in (0.4, 0.06):
        image = viewer.render(balls, SIZE, error=target)
        choice, told = image.stats["choice"], image.stats["estimated_error"]
        assert choice["error_high"] <= target and choice["unmet"] is None and choice["error_is"] == "measured"
        assert choice["error"] == told["relative"] and told["low"] <= told["relmse"] <= told["high"]
        true = (((image.linear[..., :3] - right) ** 2) / (right**2 + 0.01)).mean() ** 0.5
        assert true < 1.2 * target
        assert [entry["error"] for entry in choice["compared"] if entry["method"] == choice["method"]] == \
            [choice["error"]]
        json.dumps(image.stats)


def test_nothing_is_told_where_quiet_is_wanted(run, tmp_path):
    assert run("render", MODEL, "-o", tmp_path / "a.png", "--size", "8", "--env", "furnace", "--time-budget", "0.01",
               "-q").err == ""


def test_what_only_one_renderer_can_is_left_to_it(balls):
    layered = viewer.render(balls, (8, 8), error=0.9, aov=["depth"])
    assert layered.layers["depth"].shape == (8, 8) and layered.stats["choice"]["method"] == "path traced"
    assert layered.stats["choice"]["error"] <= 0.9 and layered.stats["choice"]["error_is"] == "measured"
    filtered = viewer.render(balls, (8, 8), time_budget=0.5, denoise="fast").stats["choice"]
    assert (filtered["method"], filtered["error_is"]) == ("path traced, denoised (fast)", "not measured")
    drawn = viewer.render(balls, (8, 8), time_budget=0.05, antialias="msaa-2").stats["choice"]
    assert all("MSAA 2" in one["method"] or "SSAA" not in one["method"] for one in drawn["candidates"])
    assert drawn["spp"] is None
    with pytest.raises(UsageError, match="time_budget has no effect in mode pbr"):
        viewer.render(balls, (8, 8), mode="pbr", time_budget=1)


@pytest.mark.parametrize("options, problem", [
    (("--mode", "pbr", "--time-budget", "1"), "time-budget has no effect in mode pbr"),
    (("--time-budget", "1", "--seed", "3", "--set", "shadows=off"), "give a mode"),
    (("--spp", "3"), "spp has no effect in mode pbr"),
])
def test_what_cannot_be_is_told_before_anything_is_loaded(run, options, problem, tmp_path):
    done = run("render", "none.glb", "-o", tmp_path / "a.png", *options)
    assert done.status == 2 and problem in done.error
