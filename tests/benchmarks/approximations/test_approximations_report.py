"""What is made of the measurements: JSON, front, page and command line."""

from __future__ import annotations

import json
import re
from dataclasses import replace

import pytest

from benchmarks.approximations import __main__ as command
from benchmarks.approximations import curves
from benchmarks.approximations.chart import cost_chart
from benchmarks.approximations.document import better_than_default, dominates, measure_pieces
from viewer.measure.drawing import Mark, to_svg
from viewer.measure.report.timing import Effort

QUICK = Effort(least=1, most=1, seconds=0.0)


def row(name: str, cost: float, error: float, size: int = 0, is_default: bool = False) -> dict:
    times = {"median": cost, "p10": cost, "p90": cost, "n": 1}
    return {"name": name, "cost_ns": times, "error": {"rms": error, "max": 3 * error}, "bytes": size,
            "is_default": is_default}


def test_one_dominates_another_where_it_is_better_in_one_and_worse_in_none():
    plain = row("plain", 10, 0.1, 100)
    assert dominates(row("cheaper", 5, 0.1, 100), plain) and dominates(row("smaller", 10, 0.1, 50), plain)
    assert dominates(row("righter", 10, 0.05, 100), plain)
    assert not dominates(row("same", 10, 0.1, 100), plain) and not dominates(plain, plain)
    assert not dominates(row("larger", 5, 0.05, 200), plain) and not dominates(row("dearer", 12, 0.05, 100), plain)
    # Less than times and errors can tell
    assert not dominates(row("the same", 9.6, 0.0990, 100), plain)
    assert dominates(row("righter, and no dearer to speak of", 10.4, 0.05, 100), plain)


def test_what_is_better_than_the_default_is_named():
    default = row("default", 10, 0.1, 100, True)
    other = row("other", 5, 0.09, 100)
    assert better_than_default([default, other]) == ["other"]
    assert better_than_default([default, row("dearer", 20, 0.09, 100)]) == []
    other["error"]["max"] = 1.0
    assert better_than_default([default, other]) == []


@pytest.fixture(scope="module")
def document(context):
    return measure_pieces(context, [curves.srgb_piece, curves.masking_piece], QUICK)


def test_the_document(document):
    assert set(document) == {"device", "backend", "version", "clock", "evaluations_a_draw", "measured_s", "pieces"}
    json.dumps(document, allow_nan=False)
    assert [piece["name"] for piece in document["pieces"]] == ["srgb", "ggx-masking"]
    for piece in document["pieces"]:
        assert set(piece) == {"name", "title", "over", "unit", "truth", "per", "reason", "variants", "better"}
        assert any(found["pareto"] for found in piece["variants"])
        for found in piece["variants"]:
            assert set(found) == {"name", "source", "is_default", "error", "cost_ns", "bytes", "bake_s", "pareto"}
            assert set(found["cost_ns"]) == {"median", "p10", "p90", "n"} and found["cost_ns"]["median"] >= 0
            assert 0 <= found["error"]["rms"] <= found["error"]["max"]


def test_a_worse_default_is_seen(context):
    """The renderer's way planted to be three times as dear and a tenth wrong."""
    piece = curves.masking_piece()
    right = piece.variants[0]
    call = "vec4(1.1 * pow(pow(pow(v_smith_ggx(p.x, p.y, p.z), 0.37), 2.2), 1.0 / (0.37 * 2.2)))"
    wrong = replace(right, name="planted", kernels=(replace(right.kernels[0], call=call),), size=64)
    planted = replace(piece, variants=(wrong, replace(right, is_default=False)))
    found = measure_pieces(context, [lambda: planted], QUICK)["pieces"][0]
    assert found["variants"][0]["error"]["rms"] == pytest.approx(0.1, abs=1e-3)
    assert found["better"] == ["height-correlated"] and [row["pareto"] for row in found["variants"]] == [False, True]


def test_the_chart(document):
    piece = document["pieces"][1]
    chart = cost_chart(piece)
    points = [shape for shape in chart.shapes if isinstance(shape, Mark) and shape.point is not None]
    assert [mark.point for mark in points] == [0, 1, 2] and len({(mark.color, mark.shape) for mark in points}) == 3
    assert [mark.is_filled for mark in points] == [found["pareto"] for found in piece["variants"]]
    errors = [found["error"]["rms"] for found in piece["variants"]]
    assert sorted(points, key=lambda mark: -mark.y) == sorted(points, key=lambda mark: errors[mark.point])
    assert "height-correlated (the renderer&#x27;s)" in to_svg(chart)


def test_the_command(folder, monkeypatch, capsys, document):
    monkeypatch.setattr(command, "measure_pieces", lambda context, progress: document)
    command.main(["-o", "pieces"])
    out, err = capsys.readouterr()
    assert err == ""
    assert re.search(r"^ +\* +height-correlated ", out, re.MULTILINE) and "Hammon" in out
    out = folder / "pieces"
    assert json.loads((out / "approximations.json").read_text()) == document
    page = (out / "approximations.html").read_text()
    names = [found["name"] for piece in document["pieces"] for found in piece["variants"]]
    assert all(name.replace("'", "&#x27;") in page for name in names)
    assert page.count("<svg") == 2 and not re.search(r'(src|href)="(?!#)', page) and "@import" not in page
    assert {path.name for path in (out / "approximations").iterdir()} == {
        "srgb.svg", "srgb.png", "ggx-masking.svg", "ggx-masking.png"}


def test_a_folder_that_cannot_be_made_is_told_before_anything_is_measured(folder):
    (folder / "file").write_text("")
    with pytest.raises(SystemExit) as stop:
        command.main(["-o", "file"])
    assert stop.value.code == "error: file: is a file, not a folder"
