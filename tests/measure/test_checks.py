"""A row of `pbr-viewer check`: what passes, what is a defect, and how it is written."""

from __future__ import annotations

import json
import math

import numpy as np
import pytest

from viewer.measure.check.checks import Check, exit_status, summary
from viewer.measure.check.chi_squared import critical_value, statistic
from viewer.measure.check.table import print_table, verdict
from viewer.measure.drawing import Label, Line, to_svg
from viewer.measure.plot import heat_map, lines, polar

PASSES, FAILS = Check("a", "b", 1.0, 1.0), Check("a", "b", 1.01, 1.0)
KNOWN, GONE = Check("a", "b", 2.0, 1.0, expected=True), Check("a", "b", 0.5, 1.0, expected=True)


def test_what_fails_as_expected_is_a_result_and_what_then_passes_a_defect():
    assert [verdict(check) for check in (PASSES, FAILS, KNOWN, GONE)] == ["pass", "FAIL", "known", "GONE"]
    assert [exit_status([PASSES, check]) for check in (PASSES, FAILS, KNOWN, GONE)] == [0, 1, 0, 1]
    assert summary([PASSES, KNOWN]) == "2 checks, 1 passed, 1 failed as expected, no defects"
    assert summary([FAILS, GONE]) == "2 checks, 0 passed, 2 defects"


@pytest.mark.parametrize("value", [math.nan, math.inf])
def test_what_is_not_finite_fails_and_is_null_in_json(value):
    check = Check("a", "b", value, 1.0)
    assert not check.passed and check.is_defect
    row = json.loads(json.dumps(check.to_json(), allow_nan=False))
    assert row["value"] is None and row["pass"] is False and row["bound"] == 1.0


def test_the_table_is_plain_where_nobody_reads_colours(capsys):
    print_table([PASSES, KNOWN])
    out = capsys.readouterr().out
    assert out.splitlines()[0].split() == ["pass", "a", "b", "1.00e+00", "<=", "1.00e+00"]
    assert "\x1b" not in out and out.endswith("no defects\n")


@pytest.mark.parametrize(("degrees", "tests"), [(10, 1), (100, 1), (200, 50), (60, 1000)])
def test_thresholds_of_chi_squared(degrees, tests):
    """Any of the tests exceeds its threshold by chance once in a hundred times. For even degrees the tail is a sum:
    e^-y sum_{k < degrees / 2} y^k / k!, y = x / 2 (Abramowitz & Stegun 1964, 26.4.21)."""
    y = critical_value(degrees, tests) / 2
    tail = sum(math.exp(k * math.log(y) - y - math.lgamma(k + 1)) for k in range(degrees // 2))
    assert 1 - (1 - tail) ** tests == pytest.approx(0.01, rel=0.15)


def test_chi_squared_tells_a_wrong_density_from_noise():
    random = np.random.default_rng(5)
    shares = np.append(random.random(60), [1e-5] * 20)
    shares /= shares.sum()
    counts = random.multinomial(20_000, shares).astype(float)
    chi2, degrees = statistic(counts, 20_000 * shares)
    assert 50 < degrees < 62 and chi2 < critical_value(degrees, 1)
    tilted = shares * np.linspace(0.9, 1.1, 80)
    chi2, degrees = statistic(counts, 20_000 * tilted / tilted.sum())
    assert chi2 > critical_value(degrees, 1)
    assert statistic(np.array([5.0, 95.0]), np.array([0.0, 100.0]))[0] == math.inf


def test_plots_are_whole_svg():
    from xml.etree import ElementTree

    x = np.linspace(0, 1, 5)
    for drawing in (lines("a < b", {"one": (x, x), "two": (x, x * np.nan)}, "x", "y"), polar("lobe", {"one": (x, x)}),
                 heat_map("map", np.array([[0.0, 1e-9], [1e-5, np.inf]]), "x", "y", ["0", "1"], ["0", "1"])):
        text = to_svg(drawing)
        root = ElementTree.fromstring(text)
        assert root.tag.endswith("svg") and "nan" not in text.lower().replace("nan%", "")


def test_no_curve_comes_to_the_names_of_the_curves_nor_over_the_edge():
    """The names stand above all that is drawn, also where the curves reach the highest and the farthest."""
    angle = np.linspace(-np.pi / 2, np.pi / 2, 91)
    names = [f"shininess {k}" for k in (3, 10, 100)] + ["roughness 0.5"]
    for drawing in (lines("a", dict.fromkeys(names, (np.linspace(0, 1, 5), np.ones(5))), "x", "y"),
                    polar("lobe", dict.fromkeys(names, (angle, np.ones(91))))):
        points = np.array([point for shape in drawing.shapes if isinstance(shape, Line) for point in shape.points])
        assert points.min() >= 0 and points[:, 0].max() <= drawing.width and points[:, 1].max() <= drawing.height
        legend = [shape for shape in drawing.shapes if isinstance(shape, Label) and shape.text in names]
        assert len(legend) == 4 and max(label.y for label in legend) + 4 <= points[:, 1].min()
        ends = [label.x + 6.5 * len(label.text) for label in legend]  # about what a letter takes
        assert all(end < label.x for end, label in zip(ends, legend[1:])) and ends[-1] <= drawing.width
