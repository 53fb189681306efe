"""Pictures of the raster held against unfinished path-traced ones."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest

from viewer.budget.candidates import Candidate
from viewer.budget.making import Making, against, around
from viewer.settings import Settings


def exposure(truth: np.ndarray, samples: int, deviation: float, background="env") -> SimpleNamespace:
    """Of a picture (H, W, 3), each sample with normal noise."""
    noise = np.random.default_rng(5).normal(0, deviation, (samples, *truth.shape))
    values = truth + noise
    count = np.full((*truth.shape[:2], 1), samples)
    sums = (np.concatenate([values.sum(0), count], -1), np.concatenate([(values**2).sum(0), 0 * count], -1))
    return SimpleNamespace(film=SimpleNamespace(read_sums=lambda: sums), settings=Settings(background=background))


@pytest.mark.parametrize("wrong", [0.0, 0.05, 0.3])
def test_noise_is_not_taken_for_error(wrong):
    truth = np.full((64, 64, 3), 0.5)
    image = SimpleNamespace(linear=np.full((64, 64, 4), 0.5 + wrong))
    expected = wrong / np.hypot(0.5, 0.1)
    assert expected - 0.005 < against(image, exposure(truth, 4, 0.2)) < expected + 0.04


def test_a_colour_behind_is_no_error():
    image = SimpleNamespace(linear=np.full((8, 8, 4), 0.25))
    assert against(image, exposure(np.zeros((8, 8, 3)), 4, 0.0, (0.25, 0.25, 0.25))) == pytest.approx(0, abs=1e-6)


def test_the_mean_around_a_pixel():
    picture = np.random.default_rng(1).random((9, 12, 3))
    assert around(picture)[4, 5] == pytest.approx(picture[2:7, 3:8].mean((0, 1)))
    assert around(np.ones((3, 4, 3))) == pytest.approx(1)


def candidate(title: str, seconds: float, error: float) -> Candidate:
    return Candidate(title, Settings(), seconds, error)


def test_where_paths_come_to_nothing_the_best_that_time_allows_is_made():
    quick, good, best = candidate("quick", 0.1, 0.4), candidate("good", 1.0, 0.2), candidate("best", 3.0, 0.1)
    making = Making(None, None, None, None, 0.0, SimpleNamespace(found=[quick, good, best]))
    assert making._spare(None, 5.0) is best and making._spare(quick, 2.0) is good
    assert making._spare(good, 2.0) is None and making._spare(good, 0.01) is None
    assert making._spare(None, 0.01) is quick
