"""The numbers of samples of tiles, for films whose noise is known."""

from __future__ import annotations

import numpy as np
import pytest

from viewer.image.neighbours import EPSILON
from viewer.settings import Settings
from viewer.trace.layout import TILE
from viewer.trace.paths.distribution import deviation_around
from viewer.trace.paths.film import relative_error
from viewer.trace.paths.schedule import LEAST, MAX_CHUNK, Schedule, dilated
from viewer.trace.paths.wavefront import SECOND, Work


class NoisyFilm:
    """Tiles, or with `size` pixels, whose samples have a known relative variance, as `viewer.trace.paths.film.Film`
    reports them.

    `scatter` is how uncertain the estimates are (relative, at one sample, falling with their root); `lost` the share of
    samples that are left out.
    """

    def __init__(self, variance: np.ndarray, size: tuple[int, int] | None = None, scatter: float = 0.0,
                 lost: float = 0.0) -> None:
        rows, columns = variance.shape
        self.size = size or (columns * TILE, rows * TILE)
        self.tiles = columns, rows
        width, height = self.size
        self.variance = np.kron(variance.astype(float), np.ones((TILE, TILE)))[:height, :width]
        self.samples = np.zeros((height, width))
        self.parts: tuple[object, ...] = ()
        self._scatter, self._kept = scatter, 1 - lost
        self._rng = np.random.default_rng(1)

    def add(self, work: list[Work]) -> None:
        for item in work:
            assert 0 <= item.tile_x < self.tiles[0] and 0 <= item.tile_y < self.tiles[1]
            assert item.first >= 0 and item.samples > 0
            own = self.samples[item.tile_y * TILE:, item.tile_x * TILE:][:TILE, :TILE]
            chosen = np.ones((TILE, TILE), bool) if item.pixels is None else item.pixels
            assert item.pixels is None or item.pixels.sum() == item.pixels[:own.shape[0], :own.shape[1]].sum() > 0
            own += item.samples * self._kept * chosen[:own.shape[0], :own.shape[1]]

    def by_tile(self, pixels: np.ndarray) -> np.ndarray:
        """The sums of (H, W) over tiles."""
        return np.add.reduceat(np.add.reduceat(pixels, range(0, pixels.shape[0], TILE), 0),
                               range(0, pixels.shape[1], TILE), 1)

    def tile_errors(self) -> np.ndarray:
        known, pixels = self.samples >= 2, np.ones_like(self.samples)
        relative = np.where(known, self.variance / np.maximum(self.samples, 1), 0)
        factor = np.exp(self._rng.normal(0, self._scatter / np.sqrt(np.maximum(self.samples[::TILE, ::TILE], 1))))
        return np.stack([self.by_tile(relative) * factor, self.by_tile(known * 1.0), self.by_tile(self.samples),
                         self.by_tile(pixels)], -1).astype(np.float32)

    def deviation_around(self) -> np.ndarray:
        """That of radiance 1 and these variances, each known to its `scatter`."""
        count = np.repeat(self.samples[..., None], 4, axis=2)
        factor = np.exp(self._rng.normal(0, self._scatter / np.sqrt(np.maximum(self.samples, 1))))
        spread = self.variance * factor * (1 + EPSILON) * np.maximum(self.samples - 1, 0)
        return deviation_around(count, count + spread[..., None])

    @property
    def tile_error(self) -> np.ndarray:
        """Of each tile, (rows, columns)."""
        return np.sqrt(self.by_tile(self.variance / self.samples) / self.by_tile(np.ones_like(self.samples)))

    @property
    def true_error(self) -> float:
        return float(np.sqrt((self.variance / self.samples).mean()))


def test_a_part_of_the_samples_has_their_numbers():
    schedule, given = Schedule(NoisyFilm(np.ones((2, 3))), Settings(mode="path", spp=24), first=40), []
    while not schedule.done:
        given += schedule.next(64, is_last=True)
    for tile in {(item.tile_x, item.tile_y) for item in given}:
        own = [k for item in given if (item.tile_x, item.tile_y) == tile
               for k in range(item.first, item.first + item.samples)]
        assert sorted(own) == list(range(40, 64))
    assert len({(item.tile_x, item.tile_y) for item in given}) == 6


def run(film: NoisyFilm, settings: Settings, count: int = 64, most: float = 1e9) -> list[Work]:
    """Two wavefronts in turn, as in a `PathRender`, until done or `most` samples are in the film."""
    schedule, given, wavefronts = Schedule(film, settings), [], [[], []]
    while film.samples.sum() < most:
        wavefronts.reverse()
        film.add(wavefronts[0])
        schedule.collected = film.samples.sum()
        wavefronts[0] = [] if schedule.done else schedule.next(count, is_last=not wavefronts[1])
        assert len(wavefronts[0]) <= count
        given += wavefronts[0]
        if schedule.done and not any(wavefronts):
            break
    return given


def rough(seed: int = 3, shape: tuple[int, int] = (6, 8)) -> np.ndarray:
    """Variances over five orders of magnitude; neighbours have similar ones."""
    rng = np.random.default_rng(seed)
    coarse = rng.uniform(-3, 2, (3, 4))
    return 10 ** np.kron(coarse, np.ones((3, 4)))[:shape[0], :shape[1]]


def test_with_a_time_budget_nothing_delays_the_first_sample_of_each_pixel():
    film = NoisyFilm(np.ones((3, 4)))
    schedule = Schedule(film, Settings(mode="path", time_budget=1.0))
    first, more = schedule.next(8, is_last=True), schedule.next(8, is_last=False)
    assert [item.samples for item in first + more] == [1] * 12
    film.add(first)
    assert schedule.next(8, is_last=False) == [] and not schedule.done
    film.add(more)
    assert film.samples.min() == 1 and len(schedule.next(8, is_last=True)) == 8


@pytest.mark.parametrize("size, spp, count", [
    ((16, 16), 64, 256), ((40, 30), 1, 16), ((200, 50), 37, 64), ((9, 1), 3, 2)])
def test_without_a_target_each_pixel_gets_exactly_its_samples(size, spp, count):
    tiles = -(-size[1] // TILE), -(-size[0] // TILE)
    film = NoisyFilm(np.ones(tiles), size, lost=0.01)
    work = run(film, Settings(mode="path", spp=spp), count)
    for y in range(tiles[0]):
        for x in range(tiles[1]):
            numbers = [n for w in work if (w.tile_x, w.tile_y) == (x, y) for n in range(w.first, w.first + w.samples)]
            assert sorted(numbers) == list(range(spp))


def test_few_samples_come_one_by_one_to_a_film_in_parts():
    """So that both parts have as many; later they come in larger items."""
    film = NoisyFilm(np.ones((4, 4)))
    film.parts = object(), object()
    given = run(film, Settings(mode="path", spp=12), count=16)
    assert [work.samples for work in given[:64]] == [1] * 64 and max(work.samples for work in given) > 1
    for start in (0, SECOND):  # and each part has a sequence of its own, without gaps
        own = [work for work in given if work.tile_x == work.tile_y == 2 and (work.first >= SECOND) == (start > 0)]
        numbers = sorted(k for work in own for k in range(work.first, work.first + work.samples))
        assert numbers == list(range(start, start + 6))


def test_a_picture_larger_than_a_wavefront_shows_one_sample_first():
    schedule = Schedule(NoisyFilm(np.ones((10, 10))), Settings(mode="path"))
    first = schedule.next(50, True) + schedule.next(50, True)
    assert len({work[:2] for work in first}) == 100 and {work[2:4] for work in first} == {(0, 1)}
    rounds = [{work.samples for _ in range(2) for work in schedule.next(50, True)} for _ in range(6)]
    assert rounds == [{1}, {2}, {4}, {4}, {4}, {4}]


@pytest.mark.parametrize("tiles, pixels, most", [(100, 256, 8), (10, 256, 4), (10, 128, 2), (10, 3, 1), (0, 0, None)])
def test_a_picture_that_a_wavefront_holds_fills_two_with_what_is_traced(tiles, pixels, most):
    """Its items take it to the end at once, if they are not too long; a tile that is not traced has a single one."""
    traced = np.zeros((10, 10), int)
    traced.flat[:tiles] = pixels
    schedule = Schedule(NoisyFilm(np.ones((10, 10))), Settings(mode="path"), traced=traced)
    work = schedule.next(100, True)
    assert len(work) == 100 and schedule.done == (tiles == 0)
    while not schedule.done:
        work += schedule.next(1000, False)
    items = {(x, y): [item.samples for item in work if item[:2] == (x, y)] for x in range(10) for y in range(10)}
    assert all(sum(own) == 64 for own in items.values())
    assert all(max(own) == most if traced[y, x] else len(own) == 1 for (x, y), own in items.items())
    paths = sum(traced[item.tile_y, item.tile_x] for item in work)
    assert most == 8 or paths <= 2 * 100 * TILE**2, "some would wait for a place"
    assert most in (None, 1, 8) or paths > 0.85 * 2 * 100 * TILE**2


def test_without_a_count_of_what_is_traced_a_picture_begins_with_small_rounds():
    work = Schedule(NoisyFilm(np.ones((10, 10))), Settings(mode="path")).next(100, True)
    assert {item.samples for item in work} == {1} and len({item[:2] for item in work}) == 100


def test_a_target_is_reached_everywhere_and_what_is_done_rests():
    tiles = rough(shape=(9, 16))
    film = NoisyFilm(tiles)
    run(film, Settings(mode="path", error=0.1))
    assert film.tile_error.max() <= 0.1 and relative_error(film.tile_errors()) <= 0.1
    quiet = dilated(tiles) <= 0.1**2 * LEAST
    samples = film.by_tile(film.samples) / TILE**2
    assert quiet.any() and (film.samples[np.kron(quiet, np.ones((TILE, TILE))) > 0] == LEAST).all()
    needed = np.maximum(np.ceil(dilated(tiles) / 0.1**2), LEAST)
    # Around a pixel at a tile's edge there is noise of the next tile, too, so its share is not what it needs.
    assert (samples <= 1.06 * needed).all() and samples.sum() <= 1.005 * needed.sum()


def test_spp_is_the_most_that_a_target_may_take():
    film = NoisyFilm(np.full((4, 4), 100.0))
    run(film, Settings(mode="path", error=1e-3, spp=200))
    assert (film.samples == 200).all()
    film = NoisyFilm(np.full((4, 4), 100.0))
    run(film, Settings(mode="path", error=1e-3, spp=5))
    assert (film.samples == 5).all()


def test_samples_that_are_left_out_do_not_hang_it():
    film = NoisyFilm(rough(), lost=0.2)
    run(film, Settings(mode="path", error=0.1))
    assert film.tile_error.max() * np.sqrt(0.8) <= 0.1


@pytest.mark.parametrize("variance", [np.zeros((3, 3)), np.full((1, 1), np.nan), np.diag([0.0, np.inf, 1.0])])
def test_films_without_noise_and_with_endless_noise_end(variance):
    film = NoisyFilm(variance)
    run(film, Settings(mode="path", error=0.1, spp=300))
    assert film.samples.min() >= LEAST and film.samples.mean() <= 300


@pytest.mark.parametrize("size", [(1, 1), (40, 37)])
def test_where_noise_is_even_a_target_takes_what_it_needs(size):
    film = NoisyFilm(np.ones((-(-size[1] // TILE), -(-size[0] // TILE))), size)
    run(film, Settings(mode="path", error=0.05))
    assert film.samples.min() >= 400 and film.samples.max() <= 400 + MAX_CHUNK  # what is on its way counts


@pytest.mark.parametrize("scatter", [0.0, 1.0])
@pytest.mark.parametrize("variance", [rough(3), rough(4), np.ones((6, 8)), np.where(np.eye(6, 8) > 0, 50.0, 0.1)])
def test_at_equal_cost_it_is_never_worse_than_uniform(variance, scatter):
    """For 64 to 256 samples per pixel, with estimates whose error is 12 % after the pilot."""
    for mean in (70, 128, 256):
        film = NoisyFilm(variance, scatter=scatter)
        run(film, Settings(mode="path", time_budget=1.0), most=mean * variance.size * TILE * TILE)
        spent = film.samples.mean()
        uniform = np.sqrt(variance.mean() / spent)
        assert film.true_error <= 1.002 * uniform
    if np.ptp(variance) > 1:
        assert film.true_error < 0.8 * uniform


def test_noise_counts_a_quarter_next_door():
    variance = np.zeros((5, 5))
    variance[2, 2] = 8
    expected = np.zeros((5, 5))
    expected[1:4, 1:4] = 2
    expected[2, 2] = 8
    assert np.array_equal(dilated(variance), expected)
