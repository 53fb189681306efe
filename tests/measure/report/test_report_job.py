"""`pbr-viewer report` from the command line to the files."""

from __future__ import annotations

import json
import shutil
from pathlib import Path
from xml.etree import ElementTree

import pytest
from command_line import SCENES, names
from PIL import Image as Pillow
from quick_report import MODEL, QUICK
from stored_report import stored_findings

from viewer.base.signals import Stopped
from viewer.measure.report.bench import Bench
from viewer.measure.report.job import report_folders

NUMBER = (int, float)


def test_what_lies_in_the_folder(report_folder):
    assert names(report_folder) == ["error-time.png", "error-time.svg", "index.html", "measured", "report.json"]
    svg = ElementTree.fromstring((report_folder / "error-time.svg").read_text())
    document = json.loads((report_folder / "report.json").read_text())
    assert len(svg.findall(".//*[@data-point]")) == len(document["points"])
    assert Pillow.open(report_folder / "error-time.png").size[0] == 1440
    page = (report_folder / "index.html").read_text()
    assert "http://" not in page.replace("http://www.w3.org/2000/svg", "") and "https://" not in page


def test_the_json_is_as_promised(report_folder):
    report = json.loads((report_folder / "report.json").read_text())
    assert report["scene"] == "spheres.glb" and isinstance(report["device"], str) and report["size"] == [24, 24]
    reference = report["reference"]
    assert isinstance(reference["method"], str) and reference["spp"] >= 16 and 0 < reference["relmse_floor"] < 1
    for point in report["points"]:
        assert isinstance(point["method"], str) and point["settings"]["mode"] in ("pbr", "phong", "path")
        times, error = point["time_ms"], point["error"]
        assert 0 < times["p10"] <= times["median"] <= times["p90"] and times["n"] >= 1
        assert all(isinstance(error[name], NUMBER) and error[name] >= 0 for name in ("rmse", "relmse", "flip"))
        assert isinstance(point["pareto"], bool) and point["command"].startswith("pbr-viewer render ")
    assert {point["method"] for point in report["points"]} >= {"phong", "lights", "ibl", "path"}
    assert any(point["pareto"] for point in report["points"]) and report["is_whole"] is True
    assert [row["budget_ms"] for row in report["recommend"]] == [pytest.approx(33.3, abs=0.1), 100, 1000, 10000]
    assert all(row["point"] is None or report["points"][row["point"]]["pareto"] for row in report["recommend"])
    assert all(error["relmse_trimmed"] <= 1.0001 * error["relmse"] for error in (p["error"] for p in report["points"]))
    assert list(report["qualities"]) == ["draft", "standard", "high"]
    for name, index in report["qualities"].items():
        assert index is None or report["points"][index]["quality"] == name
    assert report["points"][report["qualities"]["draft"]]["method"] == "ibl"
    best = report["raster"]["relmse"]
    assert report["points"][best["best"]]["settings"]["mode"] != "path" and 0 < best["ratio"] <= 1
    assert all(set(out) == {"method", "reason"} for out in report["left_out"])


def test_path_tracing_is_nearer_to_the_reference_than_phong(report_folder):
    report = json.loads((report_folder / "report.json").read_text())
    error = {name: min(point["error"]["relmse"] for point in report["points"] if point["method"] == name)
             for name in ("phong", "lights", "ibl", "path")}
    assert error["ibl"] < error["lights"] and error["ibl"] < error["phong"]


def counted(monkeypatch, stop_before: int = 10**9) -> list[str]:
    """The slugs of what is measured; somebody asks to stop before one."""
    measured, measure = [], Bench.measure

    def counting(self, method):
        if len(measured) == stop_before:
            raise Stopped(2)
        measured.append(method.slug)
        return measure(self, method)

    monkeypatch.setattr(Bench, "measure", counting)
    return measured


def test_nothing_is_measured_again_that_has_not_changed(run, report_folder, tmp_path, monkeypatch):
    folder = tmp_path / "copy"
    shutil.copytree(report_folder, folder)
    measured = counted(monkeypatch)
    *options, quiet = QUICK
    outcome = run("report", MODEL, "-o", folder, *options)
    assert outcome.status == 0 and measured == [] and quiet == "--quiet"
    assert outcome.err == f"the report: {folder / 'index.html'}\n"
    assert json.loads((folder / "report.json").read_text())["points"] == \
        json.loads((report_folder / "report.json").read_text())["points"]
    (folder / "measured" / "phong-antialias-none.json").unlink()
    kept = {path.stem for path in (folder / "measured").glob("*.json")}
    assert run("report", MODEL, "-o", folder, *QUICK).status == 0
    # The time that it took is free again, maybe for a point that there was none for.
    assert "phong-antialias-none" in measured and not kept & set(measured)
    anew = counted(monkeypatch, stop_before=6)  # six tell as much as all
    assert run("report", MODEL, "-o", folder, *QUICK, "--exposure", "1").status == 130 and len(anew) == 6


def test_an_interrupted_report_says_how_to_go_on_and_does(run, folder, report_folder, monkeypatch):
    first = counted(monkeypatch, stop_before=4)
    outcome = run("report", MODEL, "-o", "to/out", *QUICK)
    assert outcome.status == 130 and len(first) == 4
    assert outcome.err.splitlines() == ["to/out: 4 points are measured and kept; the same command continues from there",
                                        "pbr-viewer: interrupted"]
    assert names(folder / "to/out") == ["measured"]
    for kind in ("indirect", "reflections", "together"):  # take longest; some are left to be measured without them
        for path in (report_folder / "measured").glob(f"{kind}-*"):
            shutil.copy(path, folder / "to/out/measured")
    monkeypatch.undo()
    monkeypatch.chdir(folder)
    second = counted(monkeypatch)
    assert run("report", MODEL, "-o", "to/out", *QUICK).status == 0
    assert not set(first) & set(second) and json.loads((folder / "to/out/report.json").read_text())["is_whole"]


def test_several_models_have_a_folder_each_and_a_page_that_leads_there(run, folder, report_folder):
    for name in ("spheres", "spheres-3"):  # measured already
        shutil.copytree(report_folder, folder / "out" / name)
    outcome = run("report", MODEL, "missing.glb", MODEL, "-o", "out", *QUICK)
    assert outcome.status == 1 and "missing.glb" in outcome.error
    page = (folder / "out" / "index.html").read_text()
    assert page.count("<tr><td>") == 2 and 'href="spheres/index.html"' in page and "spheres-3/index.html" in page


@pytest.mark.parametrize("arguments, status, words", [
    (["-o", "file/out"], 1, "file/out: cannot be made: Not a directory"),
    (["-o", "file"], 1, "file: is a file, not a folder"),
    (["-o", "out", "--within", "0"], 2, "0 is not from 0.1"),
    (["-o", "out", "--mode", "path"], 2, "No such option"),
    (["-o", "out", "--size", "100000x8"], 2, "a picture of 100000x8"),
    (["-o", "out", "--orbit", "0,0,1e6"], 1, "spheres.glb: nothing of it is in the picture"),
])
def test_what_goes_wrong_is_told_in_one_line(run, folder, arguments, status, words):
    (folder / "file").write_text("")
    dim = ("--size", "8", "--env", "none", "--light", "0,45,3", "-q")
    outcome = run("report", SCENES / "spheres.glb", *dim, *arguments)
    assert outcome.status == status and words in outcome.error


def test_a_model_that_cannot_be_shown_leaves_nothing_behind(run, folder):
    assert run("report", "missing.glb", "-o", "out", *QUICK).status == 1
    assert run("report", MODEL, "-o", "out", *QUICK, "--orbit", "0,0,1e6").status == 1
    assert names(folder) == []


def test_models_of_one_name_have_folders_of_their_own():
    models = ["x/a.glb", "y/a.glb", "a-2.glb", "a.obj"]
    assert [path.name for path in report_folders(models, Path("out"))] == ["a", "a-2", "a-2-3", "a-4"]


def test_the_report_that_the_tests_of_the_page_store_has_what_a_measured_one_has(report_folder):
    measured, stored = json.loads((report_folder / "report.json").read_text()), stored_findings().document
    for theirs, ours in ((measured, stored), (measured["points"][0], stored["points"][0]),
                         (measured["reference"], stored["reference"]),
                         (measured["recommend"][0], stored["recommend"][0])):
        assert set(theirs) == set(ours)
