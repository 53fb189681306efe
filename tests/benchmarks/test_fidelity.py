"""The table of our pictures beside other engines', of scores that are given."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest

from benchmarks import fidelity
from benchmarks.encodings import coded_as, radiance, shown, srgb_coded

SCORER = SimpleNamespace(REAL_TIME=["one", "other"])


def row(name: str, default: float, one: float, other: float, rule: int = fidelity.RULE,
        **more: float) -> dict[str, object]:
    versions = {"default": default} | more
    bounds = {"floor": 0.05, "own": {"rule": rule, "plain": 0.03}, "third": 0.12 if more else None}
    return {"scenario": name, **bounds, "engines": {"one": one, "other": other}} | {
        version: {"rule": rule, "plain": score, "alike": score / 2} for version, score in versions.items()}


def cells(line: str) -> list[str]:
    return [cell.strip() for cell in line.strip("|").split("|")]


def test_other_encodings_are_of_the_same_light() -> None:
    picture = np.array([[[0.5, 0.02, 1.0]]], np.float32), np.ones((1, 1), np.float32)
    light = np.array([0.214041, 0.02 / 12.92, 1.0])
    assert coded_as(picture, "dspbr-pt")[0][0, 0] == pytest.approx(light**(1 / 2.2), abs=1e-5)
    assert coded_as(picture, "vray")[0][0, 0] == pytest.approx(light**(1 / 2.2) - 0.5 / 255, abs=1e-5)
    for engine in ("vray", "dspbr-pt", "filament"):
        assert srgb_coded(coded_as(picture, engine), engine)[0] == pytest.approx(picture[0], abs=1e-5)


def test_light_is_that_before_the_tone_curve():
    light = np.array([[[0.4, 0.02, 0.01], [0.2, 0.3, 0.5]]], np.float64)
    picture = shown(light, np.ones((1, 2)))
    assert radiance(picture) == pytest.approx(light, rel=1e-4)


def test_ranks_and_means_are_those_of_the_scores(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(fidelity, "VERSIONS", {"default": {}, "path": {}})
    rows = [row("a", 0.2, 0.1, 0.3, path=0.1), row("b", 0.1, 0.2, 0.3),
            row("a, without the file's lights", 0.9, 0.1, 0.3)]
    head, _, *lines = fidelity._table(SCORER, rows)
    at = cells(head).index
    assert [cells(line)[at("rank")] for line in lines[:3]] == ["2", "1", "3"]
    mean, of_all_versions = map(cells, lines[3:])
    assert mean[0] == "mean (2)" and mean[at("default")] == "0.1500 (0.0750)" and mean[at("one")] == "0.150"
    assert mean[at("path")] == ""  # one scenario lacks it
    assert mean[at("a reference's own")] == "0.030" and mean[at("third")] == "0.120 (1)"
    assert of_all_versions[0].endswith("(1)") and of_all_versions[at("path")] == "0.1000 (0.0500)"


def test_scores_of_an_older_rule_and_means_with_them_are_marked(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(fidelity, "VERSIONS", {"default": {}})
    older = row("b", 0.4, 0.2, 0.3, rule=1)
    del older["default"]["rule"]  # so the first rule is kept
    head, _, *lines = fidelity._table(SCORER, [row("a", 0.2, 0.1, 0.3), older])
    at = cells(head).index("default")
    assert [cells(line)[at] for line in lines[:3]] == ["0.200 (0.100)", "0.400 (*0.200*)", "0.3000 (*0.1500*)"]


def test_columns_that_were_never_measured_are_empty(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(fidelity, "VERSIONS", {"default": {}, "path": {}})
    older = row("a", 0.2, 0.1, 0.3, path=0.1)
    del older["default"]
    head, _, *lines = fidelity._table(SCORER, [older])
    at = cells(head).index
    assert len(lines) == 2
    for line in map(cells, lines):
        assert line[at("rank")] == line[at("default")] == "" and line[at("path")].startswith("0.100")


def test_rows_that_are_not_drawn_stay_as_they_were() -> None:
    kept = {name: {"scenario": name, "default": 1} for name in ("Box", "Duck", "Fox")}
    rows = fidelity.joined(kept, [{"scenario": "Duck", "default": 2}, {"scenario": "New", "default": 3}])
    assert [(row["scenario"], row["default"]) for row in rows] == [("Box", 1), ("Duck", 2), ("Fox", 1), ("New", 3)]
