"""Budgets and errors through the doors, on a device of which something made up is known."""

from __future__ import annotations

import json
import sys
from dataclasses import replace

import numpy as np
import pytest
from command_line import SCENES, runner
from test_choice import CALIBRATION

import viewer
from viewer import api
from viewer.budget import chooser, contention, making, start
from viewer.budget.cost import Cost
from viewer.errors import UsageError
from viewer.jobs import doctor
from viewer.measure.check.scenes import scene, sphere
from viewer.scene.environment_files import load_environment
from viewer.scene.material import Material

MODEL = SCENES / "spheres.glb"
NO_TIME = Cost()
QUICK = replace(
    CALIBRATION, start={"raster": 0.0, "path": 0.0},
    raster=tuple(replace(one, compile_new=NO_TIME, compile=NO_TIME, prepare=NO_TIME, picture=NO_TIME)
                 for one in CALIBRATION.raster),
    traced=replace(CALIBRATION.traced, compile_new=NO_TIME, prepare=NO_TIME, sample=Cost(fixed=1e3), finish=NO_TIME,
                   denoise=NO_TIME))
"""Where all of the raster is for nothing and paths are out of reach."""


@pytest.fixture
def run(capsys):
    return runner(capsys)


@pytest.fixture
def known(monkeypatch):
    """Makes a calibration the one that is known of every device."""
    monkeypatch.setattr(api, "_local", api.threading.local())

    def set_to(calibration):
        monkeypatch.setattr(chooser, "load_calibration", lambda renderer: calibration)

    return set_to


def test_the_command_line_tells_what_it_chose(run, known, tmp_path):
    known(QUICK)
    output, stats = tmp_path / "a.png", tmp_path / "a.json"
    done = run("render", MODEL, "-o", output, "--size", "16", "--time-budget", "900", "--stats", stats)
    assert done.status == 0
    assert f"{output}: time budget 900 s: shadows, in " in done.err and "expected error 0.1" in done.err
    choice = json.loads(stats.read_text())["choice"]
    assert (choice["method"], choice["error"], choice["unmet"]) == ("shadows", 0.1, None)
    assert [one["method"] for one in choice["candidates"]][:3] == ["Phong", "image", "shadows"]
    expected = viewer.render(viewer.load(MODEL), (16, 16), antialias="msaa-4")
    assert np.array_equal(viewer.Image.open(output).srgb, expected.srgb)


def test_a_device_that_is_not_known_is_measured_and_that_is_said_before(run, known, monkeypatch, tmp_path):
    known(None)
    monkeypatch.setattr(chooser, "store_calibration", lambda renderer, calibration: None)
    monkeypatch.setattr("viewer.budget.start.measure", lambda context: print("measures", file=sys.stderr) or QUICK)
    done = run("render", MODEL, "-o", tmp_path / "a.png", "--size", "8", "--error", "0.3")
    said, measures, chosen = done.err.splitlines()
    assert said.startswith("measuring how fast ") and said.endswith("; this takes half a minute or more")
    assert measures == "measures" and chosen.startswith(f"{tmp_path / 'a.png'}: error 0.3: ")


def test_nothing_is_told_where_quiet_is_wanted(run, known, tmp_path):
    known(QUICK)
    assert run("render", MODEL, "-o", tmp_path / "a.png", "--size", "8", "--error", "0.3", "-q").err == ""


@pytest.mark.parametrize("options, problem", [
    (("--mode", "pbr", "--time-budget", "1"), "time-budget has no effect in mode pbr"),
    (("--time-budget", "1", "--seed", "3", "--set", "shadows=off"), "give a mode"),
    (("--spp", "3"), "spp has no effect in mode pbr"),
])
def test_what_cannot_be_is_told_before_anything_is_loaded(run, options, problem, tmp_path):
    done = run("render", "none.glb", "-o", tmp_path / "a.png", *options)
    assert done.status == 2 and problem in done.error


def test_a_raster_that_meets_the_error_by_a_few_samples_is_taken(known):
    known(replace(QUICK, raster=tuple(replace(one, errors={"environment": 0.06}) for one in QUICK.raster[1:])))
    ball = scene([sphere()], [Material(metallic=0.0)], environment=load_environment("studio"))
    choice = viewer.render(ball, (160, 160), error=0.06).stats["choice"]
    assert choice["error_is"] == "measured" and choice["error"] <= 0.06 and choice["spp"] is None
    assert choice["compared"][-1] == {"method": choice["method"], "error": choice["error"]}


def test_an_error_no_raster_is_known_to_have_is_traced_to(known):
    known(QUICK)
    choice = viewer.render(viewer.load(MODEL, "furnace"), (16, 16), error=0.05).stats["choice"]
    assert choice["method"] == "path traced" and choice["error"] <= 0.05 and choice["unmet"] is None


def test_what_only_one_kind_of_method_can_is_chosen_from_that_kind(known):
    known(QUICK)
    balls = viewer.load(MODEL)
    assert viewer.render(balls, (8, 8), error=0.9, aov=["depth"]).layers["depth"].shape == (8, 8)
    assert viewer.render(balls, (8, 8), time_budget=5, antialias="none").stats["choice"]["method"] == "image"
    with pytest.raises(UsageError, match="time_budget has no effect in mode pbr"):
        viewer.render(balls, (8, 8), mode="pbr", time_budget=1)


def test_where_paths_come_to_nothing_in_time_a_picture_of_the_raster_is_kept(known, monkeypatch):
    """They are believed to be there at once, and after no step does every pixel have a sample."""
    known(replace(QUICK, traced=replace(QUICK.traced, compile=NO_TIME, filter_new=NO_TIME, filter=NO_TIME,
                                        sample=Cost(pixel=1e-12))))
    monkeypatch.setattr(start, "first_program", lambda context: 0.0)
    monkeypatch.setattr(making.Making, "_covered", staticmethod(lambda exposure, is_over: False))
    choice = viewer.render(viewer.load(MODEL), (16, 16), time_budget=60).stats["choice"]
    assert choice["method"] in ("Phong", "image", "shadows") and choice["spp"] is None
    assert choice["error_is"] == "expected" and choice["unfinished"].startswith("path traced")


def test_what_is_left_of_the_time_goes_into_a_better_picture(known, monkeypatch):
    """The driver has compiled all of it before, which nobody knew: that shows in the first picture."""
    monkeypatch.setattr(contention.Stopwatch, "slowdown", 1.0)
    phong, image, _ = QUICK.raster
    known(replace(QUICK, raster=(replace(phong, compile_new=Cost(fixed=10)),
                                 replace(image, compile_new=Cost(fixed=2000)))))
    choice = viewer.render(viewer.load(MODEL), (16, 16), time_budget=900).stats["choice"]
    assert choice["method"] == "image" and choice["seconds"] < 60


def test_a_device_is_measured_once_and_kept(known, monkeypatch):
    kept, measured = {}, []
    monkeypatch.setattr(api, "_local", api.threading.local())
    monkeypatch.setattr(chooser, "load_calibration", kept.get)
    monkeypatch.setattr(chooser, "store_calibration", kept.__setitem__)
    monkeypatch.setattr(start, "measure", lambda context: measured.append(1) or QUICK)
    balls = viewer.load(MODEL)
    viewer.render(balls, (8, 8), time_budget=5)
    monkeypatch.setattr(api, "_local", api.threading.local())
    viewer.render(balls, (8, 8), time_budget=5)
    assert measured == [1] and list(kept.values()) == [QUICK]


def test_doctor_tells_whether_the_device_is_known(monkeypatch):
    found = [doctor.Finding("window", None, problem="none"), doctor.Finding("egl", 0, "llvmpipe")]
    monkeypatch.setattr("viewer.budget.calibration.load_calibration", lambda renderer: None)
    assert "egl will be measured" in doctor.calibration_line(found)
    monkeypatch.setattr("viewer.budget.calibration.load_calibration", lambda renderer: QUICK)
    assert "egl is measured" in doctor.calibration_line(found)
    assert doctor.calibration_line(found[:1]) == ""
