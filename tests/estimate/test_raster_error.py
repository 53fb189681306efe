"""The told error of a picture, by synthetic paths whose expectation is known."""

from __future__ import annotations

from dataclasses import replace
from itertools import permutations

import numpy as np
import pytest
from right_pictures import RASTERS, SIZE, truth

from viewer.estimate.neighbourhood import EPSILON, box, guided, noise_of, pulled, smooth
from viewer.estimate.pairs import TRIMMED, squared_error
from viewer.estimate.raster_error import RasterError, raster_error
from viewer.measure.compare.relmse import relmse

GROUPS = 8
MASK = np.ones((SIZE, SIZE), bool)
MASK[:6] = False


def paths(right: np.ndarray, samples: int, seed: int) -> np.ndarray:
    """Each sample is 0 three times of four, and else bright, as where few samples find a light."""
    random = np.random.default_rng(seed)
    found = random.binomial(samples, 0.25, (GROUPS, *right.shape[:2], 1))
    return (right * 4 / samples * random.gamma(2.0 * found + 1e-9, 0.5)).astype(np.float32)


def told(raster: np.ndarray, samples: int, seed: int = 0) -> RasterError:
    return raster_error(raster, paths(truth(), samples, seed), MASK, GROUPS * samples, 1.0)


def test_products_of_different_ones_have_no_noise_on_average():
    apart = np.random.default_rng(1).normal(size=(5, 7, 3))
    pairs = [apart[i] * apart[j] for i, j in permutations(range(5), 2)]
    np.testing.assert_allclose(squared_error(apart), np.mean(pairs, axis=0), rtol=1e-12, atol=1e-12)


@pytest.mark.parametrize("name", RASTERS)
def test_the_interval_holds_the_true_error(name):
    raster = RASTERS[name]
    true = relmse(raster[MASK], truth()[MASK])
    for samples in (2, 16):
        errors = [told(raster, samples, seed) for seed in range(6)]
        assert sum(error.low <= true <= error.high for error in errors) >= 5
    assert np.mean([error.relmse for error in errors]) == pytest.approx(true, rel=0.2)
    assert errors[0].high < 2 * true and errors[0].low > 0.3 * true


def test_the_interval_holds_the_error_where_light_is_rare():
    """One of fifty samples has all the light of a pixel, which a black picture lacks. Pixels that have met it are too
    bright, and light those around them, so that their errors weigh too little."""
    right, every = np.full((32, 32, 3), 0.1, np.float32), np.ones((32, 32), bool)
    true = float(0.1**2 / (0.1**2 + EPSILON))
    for seed in range(6):
        found = np.random.default_rng(seed).binomial(8, 0.02, (GROUPS, 32, 32, 1))
        error = raster_error(np.zeros_like(right), (right * found * 50 / 8).astype(np.float32), every, 64, 1.0)
        assert error.relmse < 0.9 * true and error.low <= true <= error.high < 2 * true


def test_with_many_samples_it_is_the_definition():
    raster = RASTERS["without texture"]
    error = told(raster, 2000)
    each = ((raster - truth()) ** 2 / (truth() ** 2 + EPSILON)).mean(axis=-1)
    assert error.relmse == pytest.approx(each[MASK].mean(), rel=0.02)
    assert error.trimmed == pytest.approx(np.sort(each[MASK])[:-int(TRIMMED * MASK.sum())].mean(), rel=0.02)
    assert error.low > 0.93 * error.relmse and error.high < 1.07 * error.relmse


def test_a_right_picture_has_hardly_any():
    error = told(truth(), 16)
    assert error.low == 0 and error.relmse < 0.01 and error.high < 0.05 and error.map.max() < 0.5


def test_brightness_alone_is_told_apart():
    assert told(RASTERS["too bright"], 16).brightness > 0.95
    assert told(RASTERS["too dark in the shade"], 64).brightness < 0.1


def test_one_spot_is_told_by_trimming_and_seen_in_the_map():
    error = told(RASTERS["one bright spot"], 16)
    assert error.trimmed < 0.3 * error.relmse
    assert np.unravel_index(error.map.argmax(), MASK.shape) == pytest.approx((24, 24), abs=3)
    assert error.map.dtype == np.float32 and not error.map[~MASK].any() and error.map.max() > 0.5
    image = error.map_image()
    assert image.linear[..., 0] == pytest.approx(error.map) and image.srgb[24, 24, 0] > 180
    assert image.srgb[0, 0].tolist() == [0, 0, 0, 255]


def test_pixels_that_are_no_numbers_count_as_black():
    raster = truth().copy()
    raster[20, 20], raster[30, 30, 1] = np.nan, np.inf
    black = truth().copy()
    black[20, 20] = black[30, 30] = 0
    assert told(raster, 4).to_json() == told(black, 4).to_json()


@pytest.mark.parametrize("bright", [1e20, 3e38])
def test_light_whose_square_does_not_fit_is_told_in_numbers(bright):
    """A lamp of the wrong unit, which both renderers show, is no error."""
    raster, groups = truth(), paths(truth(), 4, 0)
    before = raster_error(raster, groups, MASK, 32, 1.0)
    raster[20:22, 20:22] = groups[:, 20:22, 20:22] = bright
    error = raster_error(raster, groups, MASK, 32, 1.0)
    assert np.isfinite([error.relmse, error.low, error.high, error.trimmed, error.brightness]).all()
    assert np.isfinite(error.map).all() and error.relmse < 1.1 * before.relmse + 1e-3


def test_the_sentence_has_shares_of_the_relative_error():
    error = RasterError(0.0144, 0.01, 0.0196, 0.0064, 0.3, 24.0, 1.0, np.zeros((2, 2), np.float32))
    assert str(error) == ("12 % from the truth (95 % sure: 10 to 14 %); 10 % with the right brightness, 8 % without "
                          "the worst 1 % of the pixels")
    assert "(95 % sure: at most 14 %; more seconds tell it better)" in str(replace(error, low=0.0))
    assert {"relmse", "low", "high", "relative", "trimmed_relmse", "samples", "seconds"} <= set(error.to_json())


def test_neighbourhoods_keep_what_is_even_and_do_not_cross_edges():
    even = np.full((9, 11, 3), 0.7, np.float32)
    for filtered in (smooth(even, 2), box(even), guided(even, even)):
        np.testing.assert_allclose(filtered, even, rtol=1e-6)
    edge = truth()
    assert np.abs(guided(edge, edge) / edge - 1).max() < 0.4 < np.abs(smooth(edge, 1) / edge - 1).max()
    assert box(np.arange(12.0).reshape(3, 4, 1), 1)[0, 0, 0] == np.mean([0, 1, 4, 5])


def test_the_mixture_leaves_a_right_picture_and_follows_paths_without_noise():
    raster = RASTERS["too bright"]
    np.testing.assert_allclose(pulled(raster, truth(), np.zeros_like(raster), truth()), truth(), rtol=1e-6)
    noisy = paths(truth(), 4, 3)
    mean = noisy.mean(axis=0)
    for base in (raster, RASTERS["without texture"]):
        mixed = relmse(pulled(base, mean, noise_of(noisy), mean), truth())
        assert mixed < min(relmse(base, truth()), relmse(mean, truth()))
    assert relmse(pulled(truth(), mean, noise_of(noisy), mean), truth()) < 0.25 * relmse(mean, truth())
