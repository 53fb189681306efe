"""Which pixels get more samples: in proportion, within bounds, and never because of their own samples."""

from __future__ import annotations

import numpy as np
import pytest

from viewer.image.neighbours import EPSILON
from viewer.settings import Settings
from viewer.trace.layout import TILE
from viewer.trace.paths.distribution import DEFENSIVE, allocate, around, deviation_around
from viewer.trace.paths.schedule import LEAST, Schedule


class RandomFilm:
    """Grey samples of value / chance with that chance, else 0, for each pixel; as `viewer.trace.paths.film.Film`."""

    parts: tuple[object, ...] = ()

    def __init__(self, chance: np.ndarray, value: np.ndarray) -> None:
        self.chance, self.value = chance, value / chance
        self.size, self.tiles = chance.shape[::-1], (chance.shape[1] // TILE, chance.shape[0] // TILE)
        self.count, self.hits = np.zeros(chance.shape), np.zeros(chance.shape)
        self.rng = np.random.default_rng(5)

    def trace(self, schedule: Schedule) -> None:
        while not schedule.done:
            for item in schedule.next(64, is_last=True):
                at = (slice(item.tile_y * TILE, (item.tile_y + 1) * TILE),
                      slice(item.tile_x * TILE, (item.tile_x + 1) * TILE))
                chosen = True if item.pixels is None else item.pixels
                self.hits[at] += chosen * self.rng.binomial(item.samples, self.chance[at])
                self.count[at] += chosen * item.samples

    def tile_errors(self) -> np.ndarray:
        return np.ones((*self.tiles[::-1], 4))

    def deviation_around(self) -> np.ndarray:
        sums = [np.stack([self.hits * self.value**power] * 3 + [self.count], axis=-1) for power in (1, 2)]
        return deviation_around(*sums)

    @property
    def mean(self) -> np.ndarray:
        return self.hits * self.value / self.count


def test_rare_light_is_neither_lost_nor_gained():
    """A sample in 400 has it. Its mean is known to 1.4 %; pixels that decide by their own samples lose 12 % of it."""
    film = RandomFilm(np.full((160, 160), 1 / 400), np.ones((160, 160)))
    film.trace(Schedule(film, Settings(mode="path", error=1e-5, spp=32)))
    assert film.count.mean() == pytest.approx(32, abs=0.01) and film.count.std() > 5
    assert film.mean.mean() == pytest.approx(1, abs=4 * np.sqrt(400 * (1 / film.count).mean() / film.count.size))


def test_samples_go_where_there_is_noise():
    """With a quarter of the picture noisy, the error is less than with as many samples everywhere."""
    chance, noisy = np.ones((64, 64)), np.zeros((64, 64), bool)
    noisy[20:52, 20:52] = True
    film = RandomFilm(np.where(noisy, 0.1, chance), np.ones((64, 64)))
    film.trace(Schedule(film, Settings(mode="path", error=1e-5, spp=64)))
    assert film.count[noisy].mean() > 2 * 64 and film.count[~noisy].min() >= 16
    assert ((film.mean - 1)**2).mean() < 0.6 * (9 / 64) * noisy.mean()


def test_an_allocation_is_in_proportion_within_its_bounds():
    deviation, given = np.array([[1.0, 2.0, 4.0, 0.0]]), np.array([[8, 8, 8, 8]])
    most = np.array([[1e4, 1e4, 20, 1e4]])
    assert (given + allocate(deviation, given, most, 100, 4)).tolist() == [[24, 48, 20, 8]]
    assert (given + allocate(deviation, given, most, 100, 1)).tolist() == [[24, 48, 20, 8]]
    assert (given + allocate(deviation, given, most, 1.0, 4)).tolist() == [[8, 8, 8, 8]]
    assert (given + allocate(deviation, given, most, 1e12, 4))[0, :3].tolist() == [10000, 10000, 20]


def test_what_is_left_of_a_step_goes_to_the_next_pixel():
    more = allocate(np.ones((5, 7)), np.full((5, 7), 16), np.full((5, 7), 1e4), 35 * 21, 4)
    assert set(more.ravel().tolist()) == {4, 8} and more.sum() == 35 * 5 // 4 * 4


def test_a_pixel_does_not_decide_by_its_own_samples():
    """But for the mean of the picture, which all pixels share."""
    rng = np.random.default_rng(2)
    total = np.concatenate([rng.uniform(0, 40, (9, 12, 3)), np.full((9, 12, 1), 16.0)], axis=-1)
    squares = total**2 / 16 * rng.uniform(1, 3, (9, 12, 1))
    before = deviation_around(total, squares)
    squares[4, 5] *= 90
    change = deviation_around(total, squares) - before
    assert change[4, 5] == pytest.approx(change[0, 0], rel=1e-9)
    assert (change[1:8, 2:9] > 1.01 * change[0, 0]).sum() == 48


@pytest.mark.parametrize("count", [2, 16])
def test_it_is_the_deviation_of_one_sample_over_the_mean_of_each_channel(count):
    """For samples whose unbiased variance is known, twice: the mean of the picture is added."""
    mean, variance = np.array([0.05, 2.0, 0.4]), np.array([0.3, 5.0, 0.02])
    total = np.full((9, 12, 4), count, float)
    total[..., :3] *= mean
    squares = np.broadcast_to(count * mean**2 + (count - 1) * variance, (9, 12, 3))
    expected = (np.sqrt(variance) / np.sqrt(mean**2 + EPSILON)).mean()
    assert deviation_around(total, squares) == pytest.approx((1 + DEFENSIVE) * expected, rel=1e-6)


def test_a_sun_does_not_hide_what_is_around_it():
    values = np.full((9, 12), 1e-3, np.float32)
    values[4, 5] = 1e15
    assert around(values, 3)[4, 5] == pytest.approx(48e-3, rel=1e-5) and around(values, 3)[3, 3] > 1e14


def test_a_total_is_met_whatever_the_bounds():
    rng = np.random.default_rng(4)
    deviation, given = 10 ** rng.uniform(-4, 3, (40, 50)), rng.integers(1, 60, (40, 50))
    most = given * rng.uniform(1, 30, (40, 50))
    for total in np.linspace(given.sum(), most.sum(), 7):
        samples = given + allocate(deviation, given, most, total, 1)
        assert samples.sum() == pytest.approx(total, abs=1.001) and (samples < most + 1).all()
        between = (samples > given + 1) & (samples < most - 1)  # by less than a sample to either side in proportion
        low, high = ((samples + side)[between] / deviation[between] for side in (-1, 1))
        assert low.max(initial=0) <= high.min(initial=np.inf)


def test_pixels_without_two_samples_tell_nothing():
    total, squares = np.ones((20, 20, 4)) * 16, np.ones((20, 20, 4)) * 48
    total[:10], squares[:10] = [[[5, 5, 5, 1.0]]], 25.0
    found = deviation_around(total, squares)
    assert found[10:] == pytest.approx(found[19, 19]) and (found[:6] > found[19, 19]).all()
    assert np.isfinite(deviation_around(np.zeros((4, 4, 4)), np.zeros((4, 4, 4)))).all()
    assert around(np.ones((1, 1)), 3) == 0


def test_a_picture_of_one_pixel_has_samples_until_its_error_is_met():
    for samples in (16, 64):
        total, squares = np.full((1, 1, 4), samples), np.full((1, 1, 4), 3.0 * samples)
        assert deviation_around(total, squares).tolist() == [[1.0]]


def test_pictures_without_noise_still_have_the_least_samples():
    """All pixels may have missed the light so far."""
    film = RandomFilm(np.full((32, 16), 1e-9), np.zeros((32, 16)))
    film.trace(Schedule(film, Settings(mode="path", time_budget=60.0)))
    assert (film.count == LEAST).all()
