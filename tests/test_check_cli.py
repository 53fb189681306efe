"""pbr-viewer check: what it prints and writes, its exit status, and its one line for what goes wrong."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from command_line import SCENES, names

from viewer.measure.check import run as check_module
from viewer.measure.check.checks import Check

LOBE = """
struct Chalk { vec3 albedo; };
vec3 chalk_eval(Chalk m, vec3 view, vec3 light) { return m.albedo * SCALE; }
float chalk_pdf(Chalk m, vec3 view, vec3 light) { return max(light.z, 0.0) / 3.14159265; }
"""


@pytest.fixture
def quick(monkeypatch):
    """The package's own checks as rows made here."""

    def use(*checks: Check) -> None:
        monkeypatch.setattr(check_module, "run_checks", lambda what, quiet: list(checks))

    return use


def chalk(folder: Path, scale: str) -> Path:
    (folder / "chalk.glsl").write_text(LOBE.replace("SCALE", scale))
    return folder / "chalk.glsl"


def test_a_lobe_of_ones_own_that_is_right(run, folder):
    outcome = run("check", "energy", "--shader", chalk(folder, "0.318309886"), "--lobe", "chalk", "--json", "a.json")
    assert (outcome.status, outcome.err) == (0, "")
    rows = json.loads((folder / "a.json").read_text())
    assert {row["check"] for row in rows} >= {"white furnace", "hemisphere balance", "not negative", "reciprocity"}
    assert all(row["pass"] and set(row) >= {"check", "case", "value", "bound", "pass", "expected"} for row in rows)
    assert outcome.out.splitlines()[-1].endswith("no defects")


def test_a_lobe_of_ones_own_that_is_too_bright(run, folder):
    outcome = run("check", "energy", "--shader", chalk(folder, "0.4"), "--lobe", "chalk", "--json", "-")
    assert outcome.status == 1
    values = {row["check"]: row["value"] for row in json.loads(outcome.out)}
    assert values["reflects at most all"] == pytest.approx(0.4 * 3.14159265 - 1, rel=1e-3)


def test_a_lobe_that_is_not_there_or_does_not_compile(run, folder):
    file = chalk(folder, "0.3")
    assert run("check", "energy", "--shader", file, "--lobe", "cheese").status == 2
    assert "cheese_eval" in run("check", "energy", "--shader", file, "--lobe", "cheese").error
    outcome = run("check", "energy", "--shader", chalk(folder, "oops"), "--lobe", "chalk")
    assert outcome.status == 1 and "chalk.glsl:3" in outcome.error
    assert run("check", "energy", "--shader", "none.glsl", "--lobe", "chalk").status == 1


@pytest.mark.parametrize(("text", "words"), [
    ("float odd_eval(vec3 wo) { return 1.0; }", "it takes vec3 wo, vec3 wi"),
    ("float odd_eval(vec3 wo, vec3 wi) { return 1.0; } vec3 odd_sample(vec3 wo, vec3 u) { return u; }", "BsdfSample")])
def test_a_lobe_of_another_shape(run, folder, text, words):
    (folder / "odd.glsl").write_text(text)
    outcome = run("check", "energy", "--shader", "odd.glsl", "--lobe", "odd")
    assert outcome.status == 2 and words in outcome.error


def test_every_material_of_a_model(run, folder):
    outcome = run("check", "energy", SCENES / "specular-ior.glb", "--json", "a.json")
    assert (outcome.status, outcome.err) == (0, "")
    rows = json.loads((folder / "a.json").read_text())
    from viewer.scene.load import load_scene

    materials = load_scene(SCENES / "specular-ior.glb").materials
    assert len({row["case"].split(",")[0] for row in rows}) == len(materials)
    assert {row["check"] for row in rows} >= {"furnace picture", "no gain", "not negative"}


@pytest.mark.parametrize(("arguments", "words"), [
    (("energy", "--shader", "a.glsl"), "--lobe"), (("stability", "a.glb"), "check energy"),
    (("energy", "a.glb", "--shader", "a.glsl", "--lobe", "x"), "either")])
def test_options_that_do_not_go_together(run, arguments, words):
    outcome = run("check", *arguments)
    assert outcome.status == 2 and words in outcome.error


def test_exit_status_and_files(run, folder, quick):
    quick(Check("a", "b", 0.5, 1.0), Check("known", "b", 2.0, 1.0, expected=True))
    assert run("check").status == 0
    quick(Check("a", "b", float("nan"), 1.0, note="<worst>"))
    outcome = run("check", "stability", "--json", "a.json")
    assert outcome.status == 1 and outcome.out.startswith("FAIL  a  b  nan")
    assert json.loads((folder / "a.json").read_text())[0]["value"] is None


def test_the_page_stands_alone(run, folder):
    outcome = run("check", "energy", "--shader", chalk(folder, "0.2"), "--lobe", "chalk", "-o", "report")
    assert outcome.status == 1 and names(folder / "report") == ["check.json", "index.html"]
    assert outcome.err == f"the page: {Path('report', 'index.html')}\n"
    page = (folder / "report" / "index.html").read_text()
    assert "white furnace" in page and 'class="FAIL"' in page
    assert "http" not in page.replace("http://www.w3.org/2000/svg", "")


def test_a_page_that_cannot_be_written(run, folder, quick):
    quick(Check("a", "b", 0.5, 1.0))
    (folder / "file").write_text("")
    outcome = run("check", "-o", "file/report")
    assert outcome.status == 1 and "file/report" in outcome.error
    outcome = run("check", "energy", "none.glb", "-o", "report")
    assert outcome.status == 1 and outcome.error == "none.glb: no such file" and names(folder) == ["file"]
