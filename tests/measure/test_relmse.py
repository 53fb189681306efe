"""The error against noise: a picture that is only noisy is at the floor, a biased one above it."""

from __future__ import annotations

import numpy as np
import pytest

from viewer.measure.compare.relmse import EPSILON, Halves, reduced, relmse

SHAPE = (96, 96, 3)


def pictures(bias: float = 1.0) -> tuple[Halves, np.ndarray, np.ndarray]:
    """Halves with 10 % of noise a pixel about `bias` times the truth, a reference with 2 %, and the truth."""
    rng = np.random.default_rng(0)
    truth = rng.gamma(0.7, 1.0, SHAPE)
    first, second = (bias * truth * rng.normal(1, 0.1 * np.sqrt(2), SHAPE) for _ in range(2))
    return Halves(first, second), truth * rng.normal(1, 0.02, SHAPE), truth


def test_relmse_by_hand():
    picture, reference = np.full((2, 2, 3), 1.5), np.ones((2, 2, 3))
    assert relmse(picture, reference) == pytest.approx(0.25 / (1 + EPSILON))
    assert relmse(reference, reference) == 0


def test_noise_alone_is_at_the_floor():
    both, reference, truth = pictures()
    reference_floor = relmse(reference, truth)
    found = both.against(reference, reference_floor)
    assert found.floor == pytest.approx(relmse(both.mean, truth) + reference_floor, rel=0.03)
    assert found.excess == pytest.approx(1, abs=0.03)
    assert found.mean_ratio == pytest.approx(1, abs=4 * found.mean_sigma)
    scores = both.block_scores(reference, reference_floor, 8)
    assert scores.shape == (144, 3)
    assert scores.std() == pytest.approx(1, abs=0.15)
    assert np.abs(scores).max() < 5


@pytest.mark.parametrize("bias", [0.98, 1.02])
def test_a_bias_of_two_percent_is_seen(bias):
    both, reference, truth = pictures(bias)
    found = both.against(reference, relmse(reference, truth))
    assert abs(found.mean_ratio - 1) > 10 * found.mean_sigma
    scores = both.block_scores(reference, relmse(reference, truth), 16)
    assert np.sign(bias - 1) * scores.mean() > 1.5


def test_reduced_keeps_the_mean():
    picture = np.arange(6 * 4 * 3, dtype=float).reshape(6, 4, 3)
    small = reduced(picture, 2)
    assert small.shape == (3, 2, 3)
    assert small[0, 0, 0] == picture[:2, :2, 0].mean()
