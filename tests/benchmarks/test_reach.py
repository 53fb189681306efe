"""What `reach` takes for truth, for error and for reached."""

from __future__ import annotations

import numpy as np
import pytest

from benchmarks import corpus, reach
from benchmarks.reach_table import by_family, summary
from benchmarks.reach_truth import Truth
from viewer.measure.compare.relmse import Halves
from viewer.measure.report.ladder import PLAIN, Method

SIZE = 64


@pytest.fixture
def truth() -> Truth:
    """Grey of 0.5 with noise of 0.02 in each half."""
    rng = np.random.default_rng(0)
    first, second = rng.normal(0.5, 0.02, (2, SIZE, SIZE, 3))
    return Truth(Halves(first, second), np.ones((SIZE, SIZE), bool), 0.0)


def test_the_floor_is_the_noise_of_the_mean(truth: Truth) -> None:
    assert truth.floor == pytest.approx(0.02**2 / 2 / (0.25 + 0.01), rel=0.03)


def test_of_the_true_picture_no_error_is_left(truth: Truth) -> None:
    error, trimmed = truth.error(np.full((SIZE, SIZE, 4), 0.5))
    assert abs(error) < 0.05 * truth.floor and abs(trimmed) < 0.1 * truth.floor


def test_a_bias_is_an_error(truth: Truth) -> None:
    assert truth.error(np.full((SIZE, SIZE, 4), 0.6))[0] == pytest.approx(0.1**2 / (0.25 + 0.01), rel=0.03)


def test_what_is_not_finite_counts_as_black(truth: Truth) -> None:
    black, lost = (truth.error(np.full((SIZE, SIZE, 4), value)) for value in (0.0, np.nan))
    assert lost == black and black[0] > 0.9


@pytest.mark.parametrize(("plain", "best", "expected"), [(0.3, 0.09, "yes"), (0.3, 0.11, "no"),
                                                         (0.01, 0.0, "at the noise"), (0.3, -0.001, "yes")])
def test_a_third_is_reached(plain: float, best: float, expected: str) -> None:
    assert reach.verdict(plain, best, floor=0.02) == expected


def test_plain_is_drawn_first_and_what_knows_less_last() -> None:
    methods = [Method("many", "many", {"environment_shadows": "1024"}), Method("phong", "Phong"),
               Method("ibl", "", {"antialias": "none"}), Method("new", "new", {"environment_shadows": "16"}),
               Method("smooth", "smooth", {"antialias": "ssaa-4"}), PLAIN]
    names = [method.name for method in sorted(methods, key=reach._promise)]
    assert names == ["ibl", "smooth", "new", "phong", "ibl", "many"]


def test_of_each_family_the_best_that_is_in_time_is_told() -> None:
    methods = [("image-based light", PLAIN.label, 0.3, 2.0), ("new", "new, dear", 0.01, 21.0),
               ("new", "new", 0.09, 20.0), ("new", "new, worse", 0.2, 3.0), ("Phong", "Phong", 9.0, 1.0)]
    row = {"model": "a", "environment": "noon_grass_1k", "plain": 0.3, "direct": -0.001, "verdict": "yes", "gain": 3.3,
           "methods": [dict(zip(("family", "label", "relmse", "ms"), values)) for values in methods]}
    assert by_family([row], 10)[::2] == ["| model | direct | plain | image-based light | new |",
                                         "| a, noon | 0.000 | 0.3000 | 0.3000 (1.0) | 0.0900 (10.0) |"]
    assert summary([row, row | {"verdict": "no", "gain": 1.5}])[1] == "Not reached, with the gain: a (noon, 1.5)."


def test_a_model_that_is_nowhere() -> None:
    with pytest.raises(FileNotFoundError, match="neither a file nor a model"):
        corpus.model("no such model")
