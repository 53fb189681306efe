"""The film: sums at their places, means, and estimates of the error."""

from __future__ import annotations

import numpy as np
import pytest

from viewer.errors import UsageError
from viewer.gpu.programs import Programs
from viewer.trace.layout import TILE
from viewer.trace.paths.film import Film, relative_error
from viewer.trace.paths.wavefront import STATE, Wavefront, Work


@pytest.fixture(scope="module")
def programs(context) -> Programs:
    return Programs(context)


def film_of(context, programs, samples: np.ndarray) -> Film:
    """A film with `samples`, (n, H, W, 3), all of them opaque; NaN stands for no sample."""
    height, width = samples.shape[1:3]
    film = Film(context.gl, programs, (width, height), has_layers=False)
    known = np.isfinite(samples).all(axis=-1)
    light = np.where(known[..., None], samples, 0)
    count = known.sum(axis=0)[..., None]
    for texture, total in ((film.sum, light), (film.squares, light**2)):
        texture.write(np.concatenate([total.sum(axis=0), count], axis=-1).astype(np.float32)[::-1].tobytes())
    return film


def test_a_waves_blocks_come_to_their_tiles(context, programs):
    """Blocks are cut off at the picture's edge, several blocks of one tile are added, and no other block is."""
    film = Film(context.gl, programs, (40, 20), has_layers=True)
    wavefront = Wavefront(context, 4, 2, textures=len(STATE), has_layers=True)
    work = [Work(0, 0, 0, 1), Work(2, 1, 0, 1), Work(2, 1, 1, 1), Work(1, 0, 0, 1)]
    blocks = np.array([1, 6, 3, 0])
    wavefront.assign(blocks, work)
    rng = np.random.default_rng(5)
    gathered = [rng.integers(0, 100, (32, 64, 4)).astype(np.float32) for _ in range(5)]
    for texture, values in zip((*wavefront.sums.textures, *wavefront.layers.textures), gathered, strict=True):
        texture.write(values.tobytes())
    film.add(wavefront, blocks[:3])
    found = [array[::-1] for array in (*film.read_sums(), *film.read_layers())]
    for values, shown in zip(gathered, found, strict=True):
        expected = np.zeros((32, 48, 4), np.float32)
        for block, item in zip(blocks[:3], work, strict=False):
            x, y = block % 4 * TILE, block // 4 * TILE
            place = np.s_[item.tile_y * TILE:(item.tile_y + 1) * TILE, item.tile_x * TILE:(item.tile_x + 1) * TILE]
            expected[place] += values[y:y + TILE, x:x + TILE]
        np.testing.assert_array_equal(shown, expected[:20, :40])
    wavefront.release()
    film.release()


def test_developing_gives_the_mean(context, programs):
    samples = np.random.default_rng(1).uniform(0, 9, (5, 21, 35, 3))
    samples[:3, 4, 5] = np.nan
    film = film_of(context, programs, samples)
    film.develop()
    found = film.read_radiance()
    np.testing.assert_allclose(found[..., :3], np.nanmean(samples, axis=0), rtol=1e-6)
    np.testing.assert_array_equal(found[..., 3], 1)
    film.release()


def test_nothing_gathered_is_black_and_unsure(context, programs):
    film = film_of(context, programs, np.full((1, 4, 4, 3), np.nan))
    film.develop()
    assert not film.read_radiance().any()
    assert relative_error(film.tile_errors()) == np.inf
    film.release()


def test_the_error_of_a_tile_is_its_pixels_variance(context, programs):
    """The estimate for a uniform picture, in which every pixel is as bright as its neighbours."""
    samples = 5 + np.random.default_rng(2).normal(0, 0.5, (400, 20, 40, 3))
    film = film_of(context, programs, samples)
    tiles = film.tile_errors()
    assert tiles.shape == (2, 3, 4)
    assert tiles[..., 1:].tolist() == [[[256, 102400, 256], [256, 102400, 256], [128, 51200, 128]],
                                       [[64, 25600, 64], [64, 25600, 64], [32, 12800, 32]]]
    relative = (samples.var(axis=0, ddof=1) / 400 / (samples.mean(axis=0)**2 + 0.01)).mean(axis=-1)[::-1]
    expected = [[relative[y:y + 16, x:x + 16].sum() for x in (0, 16, 32)] for y in (0, 16)]
    np.testing.assert_allclose(tiles[..., 0], expected, rtol=0.02)
    assert relative_error(tiles) == pytest.approx(0.5 / 5 / np.sqrt(400), rel=0.02)
    film.release()


def test_a_lucky_pixel_does_not_vouch_for_itself(context, programs):
    """One sample of a hundred is 1000, all others are 1. The standard deviation of that pixel's mean is 10, ten times
    its true mean."""
    samples = np.ones((100, 16, 16, 3))
    samples[7, 8, 8] = 1000
    film = film_of(context, programs, samples)
    assert relative_error(film.tile_errors()) == pytest.approx(9.99 / np.sqrt(1.01) / 16, rel=0.01)
    film.release()


def test_a_lamp_in_the_dark_does_not_look_uncertain(context, programs):
    """A quarter of a pixel's 400 samples are 1e4, and its neighbours are black. Its standard deviation is sqrt(3 / 400)
    = 0.087 of its mean, and 0.095 of its mean minus the deviation."""
    samples = np.zeros((400, 16, 16, 3))
    samples[::4, 8, 8] = 1e4
    film = film_of(context, programs, samples)
    assert relative_error(film.tile_errors()) == pytest.approx(0.0949 / 16, rel=0.01)
    film.release()


def test_one_sample_is_not_enough_for_an_error(context, programs):
    samples = np.ones((2, 5, 5, 3))
    samples[1, 2, 2] = np.nan
    film = film_of(context, programs, samples)
    tiles = film.tile_errors()
    assert tiles[0, 0].tolist() == [0, 24, 49, 25]
    assert relative_error(tiles) == np.inf
    film.release()


def test_a_size_that_cannot_be(context, programs):
    limit = context.gl.info["GL_MAX_TEXTURE_SIZE"]
    with pytest.raises(UsageError, match=f"this OpenGL draws from 1x1 to {limit}x{limit}"):
        Film(context.gl, programs, (limit + 1, 1), has_layers=False)
