from __future__ import annotations

from xml.etree import ElementTree

import numpy as np
import pytest
from PIL import Image as Pillow

from viewer.measure.drawing import Mark, to_svg
from viewer.measure.drawing_png import SCALE, save_png
from viewer.measure.report.chart import error_chart, spell_time
from viewer.measure.report.errors import MEASURES


def document(points: list[tuple[str, float, float]], floor: float = 0.0) -> dict:
    """A report of (title, time in ms, error)."""
    return {"size": [64, 32], "reference": {"floor": dict.fromkeys(MEASURES, floor)}, "points": [
        {"title": title, "label": f"<{title}>", "time_ms": {"median": time, "p10": time / 1.2, "p90": time * 1.1},
         "error": dict.fromkeys(MEASURES, error),
         "pareto_by": dict.fromkeys(MEASURES, k % 2 == 0)} for k, (title, time, error) in enumerate(points)]}


CASES = {
    "usual": document([("a", 1.0, 0.5), ("b & c", 30.0, 0.1), ("a", 1e4, 1e-3)], 1e-4),
    "one point": document([("a", 7.0, 0.5)]),
    "all alike": document([("a", 7.0, 0.5), ("b", 7.0, 0.5)]),
    "no error": document([("a", 1.0, 0.0), ("b", 2.0, 0.01)]),
    "no error at all": document([("a", 1.0, 0.0)]),
    "far apart": document([("a", 1e-3, 1e9), ("b", 1e7, 1e-9)], 1e-12),
    "many titles": document([(f"title {k}", 1.0 + k, 1.0 / (k + 1)) for k in range(14)]),
}


@pytest.mark.parametrize("case", CASES)
def test_every_point_lies_in_the_frame_and_in_the_files(case, tmp_path):
    chart = error_chart(CASES[case], "relmse")
    marks = [shape for shape in chart.shapes if isinstance(shape, Mark)]
    points = {mark.point: mark for mark in marks if mark.point is not None}
    assert sorted(points) == list(range(len(CASES[case]["points"])))
    assert all(70 <= mark.x <= 704 and 34 <= mark.y <= 400 for mark in points.values())
    assert all(0 < mark.x < chart.width and 0 < mark.y < chart.height - 5 for mark in marks)
    svg = ElementTree.fromstring(to_svg(chart))
    found = svg.findall(".//{*}g[@data-point]")
    assert {int(group.get("data-point")) for group in found} == set(points)
    assert found[0].find("{*}title").text.startswith("<")
    save_png(chart, tmp_path / "chart.png")
    picture = np.asarray(Pillow.open(tmp_path / "chart.png"))
    assert picture.shape == (round(chart.height * 2 * SCALE) // 2, chart.width * SCALE, 3)
    for mark in points.values():
        if mark.is_filled and case != "all alike":
            color = [int(mark.color[k:k + 2], 16) for k in (1, 3, 5)]
            assert np.abs(picture[round(mark.y * SCALE), round(mark.x * SCALE)] - np.array(color)).max() < 40


def test_faster_is_left_and_better_is_down_and_titles_have_one_look():
    first, second, third = sorted((shape for shape in error_chart(CASES["usual"], "flip").shapes
                                   if isinstance(shape, Mark) and shape.point is not None), key=lambda m: m.point)
    assert first.x < second.x < third.x and first.y < second.y < third.y
    assert (first.color, first.shape) == (third.color, third.shape) != (second.color, second.shape)
    assert first.is_filled and not second.is_filled


def test_no_two_titles_look_alike():
    marks = [shape for shape in error_chart(CASES["many titles"], "flip").shapes if isinstance(shape, Mark)]
    assert len({(mark.color, mark.shape) for mark in marks}) == 14


def test_times_are_spelt_in_the_unit_that_suits():
    spelt = [spell_time(milliseconds) for milliseconds in (0.5, 33.333, 999.4, 999.6, 61e3)]
    assert spelt == ["0.5 ms", "33.3 ms", "999 ms", "1 s", "61 s"]
