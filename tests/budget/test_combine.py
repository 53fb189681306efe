"""The mixture of a raster picture and paths, and what the same samples tell of its error."""

from __future__ import annotations

import numpy as np
import pytest
from right_pictures import RASTERS, truth

from viewer.budget.combine import Samples, judged
from viewer.image.estimated_error import EstimatedError
from viewer.image.neighbours import LARGEST
from viewer.measure.compare.relmse import relmse


def samples(right: np.ndarray, each: int, seed: int = 0) -> Samples:
    """Four groups of `each` samples, which are right times a number of mean 1 and variance 1."""
    shape = 4, each, *right.shape[:2], 1
    noise = np.random.default_rng(seed).exponential(size=shape).astype(np.float32)
    total = (right * noise).sum(axis=1)
    return Samples(total, np.full_like(total[..., :1], each))


@pytest.mark.parametrize("each", [1, 4, 16])
def test_what_is_told_is_true(each):
    """In nearly all cases: the errors of the mixture, the raster and the paths lie in the interval, and on the whole
    what is told is neither too small nor too large."""
    right, inside, shares = truth(), [], []
    for seed, raster in enumerate(RASTERS.values()):
        for told in judged(raster, samples(right, each, seed)).values():
            true = relmse(told.picture, right)
            inside.append(told.low <= true <= told.high)
            shares.append(told.relmse / true)
            assert 0 <= told.low <= told.relmse <= told.high and 0 <= told.trimmed <= told.relmse
    assert sum(inside) >= 0.9 * len(inside)
    assert 0.8 < np.median(shares) < 1.25


def test_more_samples_tell_it_more_surely():
    few, many = (judged(RASTERS["too bright"], samples(truth(), each))["drawn"] for each in (2, 32))
    assert many.high - many.low < 0.4 * (few.high - few.low)


def test_the_mixture_is_better_than_either_and_becomes_the_paths():
    right, raster = truth(), RASTERS["too dark in the shade"]
    for each in (1, 4):
        told = {name: relmse(one.picture, right) for name, one in judged(raster, samples(right, each)).items()}
        assert told["mixed"] < told["traced"]
    exact = np.stack([right] * 4)
    told = judged(raster, Samples(exact, np.ones_like(exact[..., :1])))
    np.testing.assert_allclose(told["mixed"].picture, right, rtol=1e-4)
    assert told["mixed"].relmse < 1e-8 < told["drawn"].relmse


def test_a_right_raster_is_told_to_be_the_best():
    told = judged(truth(), samples(truth(), 2))
    assert min(told, key=lambda name: told[name].relmse) == "drawn" and told["drawn"].low == 0


def test_no_mixture_knows_the_group_that_judges_it():
    first = samples(truth(), 2)
    before = first.mixtures(RASTERS["too bright"])
    total = first.means * 2
    total[0] += 1
    after = Samples(total, np.full_like(total[..., :1], 2)).mixtures(RASTERS["too bright"])
    assert np.array_equal(before[:2], after[:2]) and not np.array_equal(before[2:], after[2:])


def test_groups_count_by_their_samples():
    total = np.ones((4, 8, 8, 3), np.float32)
    total[3] = 30
    count = np.ones((4, 8, 8, 1), np.float32)
    count[3] = 10
    both = Samples(total, count)
    assert both.mean[0, 0, 0] == pytest.approx(33 / 13) and both.number == 13
    mean, noise = both.without([0])
    assert mean[0, 0, 0] == pytest.approx(32 / 12)
    assert noise[0, 0, 0] == pytest.approx((2 / 12 * (1 - 32 / 12) ** 2 + 10 / 12 * (3 - 32 / 12) ** 2) / 2, rel=1e-5)


@pytest.mark.parametrize("bright", [1e12, 1e20, 3e38])
def test_light_whose_square_does_not_fit_leaves_all_finite(bright):
    """Such as a lamp of the wrong unit. The pixels around it are mixed as beside any other lamp."""
    right = truth()
    right[10:13, 10:13] = bright
    parts = samples(np.minimum(right, LARGEST), 4)
    total = np.where(right > LARGEST, np.float32(bright), parts.means)
    told = judged(right, Samples(total, np.ones_like(total[..., :1])))
    for one in told.values():
        assert np.isfinite(one.picture).all() and np.isfinite([one.relmse, one.low, one.high, one.trimmed]).all()
    away = told["mixed"].picture[20:], judged(truth(), parts)["mixed"].picture[20:]
    np.testing.assert_allclose(*away, rtol=0.05)


def test_what_statistics_say():
    told = judged(truth(), samples(truth(), 2))["mixed"].to_json(1.5)
    assert list(told) == list(EstimatedError.__annotations__)
    assert (told["samples"], told["seconds"]) == (8, 1.5) and told.pop("brightness") is None and told.pop("notes") == []
    assert all(type(value) in (int, float) for value in told.values())
