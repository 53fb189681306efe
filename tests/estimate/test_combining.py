"""The combination of samples with pictures that have less noise, of which the samples' halves tell the error."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest
from right_pictures import RASTERS, SIZE, truth

from viewer.gpu.programs import Programs
from viewer.measure.compare.relmse import relmse
from viewer.trace.denoise import combine, fast
from viewer.trace.denoise.combine import RADIUS, combined
from viewer.trace.denoise.denoiser import make_denoiser

DARK = np.full((SIZE, SIZE, 3), 0.1, np.float32)


def halves(right: np.ndarray, samples: int, seed: int = 0) -> tuple[np.ndarray, np.ndarray]:
    """Means of samples that are right times a number of mean 1 and variance 1."""
    rng = np.random.default_rng(seed)
    first, second = (right * rng.gamma(samples / 2, 2 / samples, (*right.shape[:2], 1)) for _ in range(2))
    return first.astype(np.float32), second.astype(np.float32)


def share(right: np.ndarray, guides: list[np.ndarray], samples: int) -> float:
    """What is left of the relMSE of the samples."""
    first, second = halves(right, samples)
    mixed = combined((first, second), [(guide, guide) for guide in guides])
    return relmse(mixed, right) / relmse((first + second) / 2, right)


@pytest.mark.parametrize("samples, most", [(4, 0.35), (16, 0.4), (64, 0.5)])
def test_the_error_shrinks_whatever_the_guide(samples, most):
    right = truth()
    shares = [share(right, [guide], samples) for guide in RASTERS.values()]
    assert max(shares) < 0.9 and np.median(shares) < most
    assert share(right, [right], samples) < 0.3


def test_a_step_is_as_long_as_least_error_asks(monkeypatch):
    """Of a picture b that lacks a texture to c: a = (t^2 + var b) / (t^2 + var b + var c), of their means of both
    halves, whatever noise they have in common. Doubt takes off a little."""
    def measured(texture: float, of_base: float, of_other: float, common: float) -> float:
        rng = np.random.default_rng(2)
        truth = 1.0 + texture * rng.choice([-1, 1], (96, 96, 1)).astype(np.float32)
        base, other, samples = [], [], []
        for _ in range(2):
            shared, own, others, apart = rng.normal(size=(4, 96, 96, 1)).astype(np.float32)
            base.append(1.0 + of_base * own + common * shared)
            other.append(truth + of_other * others + common * shared)
            samples.append(truth + apart)
        first, second = combine._mixed(tuple(base), tuple(other), tuple(samples), 0.5, np.ones((96, 96, 1), np.float32))
        return float(np.median((first + second - sum(base)) / (sum(other) - sum(base))))

    noise = (0.7, 0.5, 1.2, 0.6)
    doubted = measured(*noise)
    monkeypatch.setattr(combine, "_DOUBT", 0.0)
    squared, of_base, of_other = 0.7**2, 0.5**2 / 2, 1.2**2 / 2
    assert measured(*noise) == pytest.approx((squared + of_base) / (squared + of_base + of_other), rel=0.03)
    assert 0.85 * measured(*noise) < doubted < 0.97 * measured(*noise)


def test_light_comes_back_that_both_halves_have_lost():
    picture = np.ones((20, 20, 3), np.float32)
    for first, second, lost in ((1.3, 1.1, 0.1), (1.3, 0.8, 0.0), (0.9, 0.6, -0.1)):
        found = combine._lost(picture, (picture, picture), (first * picture, second * picture))
        np.testing.assert_allclose(found, lost, atol=1e-6)


def test_fits_leave_out_what_is_far_brighter_than_what_is_around():
    spiked = DARK.copy()
    spiked[24, 24] = 1000
    calm = combine._calm(spiked)
    assert calm[24, 24].max() <= 1.01 and np.array_equal(np.delete(calm.reshape(-1, 3), 24 * SIZE + 24, 0),
                                                         np.delete(spiked.reshape(-1, 3), 24 * SIZE + 24, 0))


def test_films_are_combined_without_their_emission():
    """Of halves of different size; and no light comes back where nothing is hit."""
    right, rng = truth(), np.random.default_rng(4)
    emission = np.linspace(0, 3, SIZE, dtype=np.float32)[:, None, None] * np.float32([1, 0.5, 0.2])
    hits = (np.arange(SIZE)[:, None, None] >= 12) * np.ones((1, SIZE, 1), np.float32)
    samples = [right * rng.gamma(n, 1 / n, (SIZE, SIZE, 1)).astype(np.float32) for n in (12, 4)]
    filtered, guide = [0.9 * right, 1.1 * right], 0.7 * right
    parts = [fast._Part(half + emission, emission, hits, np.full((SIZE, SIZE, 1), n, np.float32))
             for half, n in zip(samples, (12, 4), strict=True)]
    whole = fast._Part(0.75 * parts[0].radiance + 0.25 * parts[1].radiance, emission, hits, 0 * hits + 16)
    found = fast._denoised(whole, parts, [half + emission for half in filtered], guide + emission)
    expected = combined(tuple(samples), [(guide, guide), tuple(filtered)], 0.75, hits > 0) + emission
    np.testing.assert_allclose(found, expected, rtol=1e-3, atol=1e-4)


def test_a_second_guide_is_used_where_it_is_better():
    right, is_upper = truth(), np.arange(SIZE)[:, None, None] < SIZE // 2
    even = np.full_like(right, right.mean())
    first, second = np.where(is_upper, even, right), np.where(is_upper, right, even)
    alone, both = share(right, [first], 16), share(right, [first, second], 16)
    assert both < 0.7 * alone < 0.7


def test_a_small_lamp_in_a_mirror_stays_where_it_is():
    """Which the guide does not have. Around it, nothing gets brighter; and likewise for a lamp of the guide alone."""
    lamp = DARK.copy()
    lamp[20:22, 30:32] = 500
    for right, guide in ((lamp, DARK), (DARK, lamp)):
        for samples in (4, 16, 64):
            assert share(right, [guide], samples) < 1
    samples = halves(lamp, 16)
    mixed = combined(samples, [(DARK, DARK)])
    assert mixed[20:22, 30:32].mean() == pytest.approx(sum(samples)[20:22, 30:32].mean() / 2, rel=0.05)
    mixed[20:22, 30:32] = 0.1
    assert mixed.max() < 1


@pytest.mark.parametrize("samples", [4, 64])
def test_rare_light_of_a_lamp_does_not_come_back_in_the_dark_beside_it(samples):
    """One sample in a hundred has half of the light. What the mixture lacks of the bright rows is given back there."""
    rng, right = np.random.default_rng(0), DARK / 2
    right[20:22] = 50
    first, second = ((right * (0.5 + rng.binomial(samples // 2, 0.01, (SIZE, SIZE, 1)) / (0.01 * samples))).astype(
        np.float32) for _ in range(2))
    mixed = combined((first, second), [(right / 2, right / 2)])
    assert relmse(mixed, right) < 0.3 * relmse((first + second) / 2, right)
    assert np.delete(mixed, (20, 21), axis=0).max() < 0.5


def test_a_single_bright_sample_is_no_lamp():
    """One that only one half has met is taken for noise, and is not spread."""
    first, second = (half.copy() for half in halves(DARK, 16))
    first[24, 24] = 1000
    mixed = combined((first, second), [(DARK, DARK)])
    assert mixed[24, 24].max() < 50 and np.delete(mixed.reshape(-1, 3), 24 * SIZE + 24, axis=0).max() < 0.5


def test_it_is_the_samples_when_they_have_no_noise():
    for guide in RASTERS.values():
        np.testing.assert_allclose(combined((truth(), truth()), [(guide, guide)]), truth(), rtol=1e-3)
    black = np.zeros((8, 9, 3), np.float32)
    assert not combined((black, black), [(black, black)]).any()


def test_halves_of_different_size():
    """Three quarters of the samples in the first half: as good as halves of one size, if that is told."""
    right, rng = truth(), np.random.default_rng(1)
    first, second = (right * rng.gamma(n, 1 / n, (SIZE, SIZE, 1)).astype(np.float32) for n in (12, 4))
    guide = RASTERS["too bright"]
    told, even = (relmse(combined((first, second), [(guide, guide)], part), right) for part in (0.75, 0.5))
    assert told < 0.4 * relmse(0.75 * first + 0.25 * second, right) and told < even


def test_suns_and_darkness():
    """Values over ten decades stay finite, not negative, and do not touch what is far away."""
    right = truth()
    right[::7, ::5] = 1e5
    right[30:] *= 1e-6
    samples = halves(right, 4)
    mixed = combined(samples, [(right, right)], np.full((SIZE, SIZE, 1), 0.5, np.float32))
    assert np.isfinite(mixed).all() and mixed.min() >= 0
    assert mixed[40, 22].max() < 1e-3 and RADIUS < 3


def test_the_fit_has_the_texture_of_its_guide():
    """The guided filter's twin in float64, at one pixel in the middle."""
    from viewer.trace.denoise.combine import _fitted

    guide, picture = truth(), truth() * 0.5 + 0.2
    np.testing.assert_allclose(_fitted(picture, guide)[4:-4, 4:-4], picture[4:-4, 4:-4], rtol=0.02)


def film(right: np.ndarray, samples: int, context, seed: int = 3, bad: float | None = None,
         of: list[np.ndarray] | None = None) -> SimpleNamespace:
    """A film in two parts, with the means `of` these, of a plane of white material; the upper rows show nothing."""
    parts = []
    for half in of or halves(right, samples, seed):
        count = np.full((SIZE, SIZE, 1), samples / 2, np.float32)
        hits = count * (np.arange(SIZE)[:, None, None] >= 8)
        if bad is not None:
            half[30, 30] = bad
        rgba = {"sum": (half * count, count), "squares": (2 * half**2 * count, count), "albedo": (hits,) * 4,
                "normal": (0 * hits, 0 * hits, hits, hits), "emission": (0 * half, 0 * count)}
        parts.append({name: np.concatenate(values, axis=-1) for name, values in rgba.items()})
    whole = {name: parts[0][name] + parts[1][name] for name in parts[0]}

    def textures(arrays: dict[str, np.ndarray]) -> SimpleNamespace:
        sums = np.concatenate([arrays["sum"][..., :3], arrays["squares"][..., 3:]], axis=-1)
        radiance = sums / arrays["sum"][..., 3:]
        made = {name: context.gl.texture((SIZE, SIZE), 4, np.ascontiguousarray(array[::-1], np.float32), dtype="f4")
                for name, array in (arrays | {"radiance": radiance}).items()}
        return SimpleNamespace(**made, develop=lambda: None, is_split=False, parts=())

    split = textures(whole)
    split.is_split, split.parts = True, [textures(part) for part in parts]
    return split


def read(texture) -> np.ndarray:
    return np.frombuffer(texture.read(), np.float32).reshape(SIZE, SIZE, 4)[::-1]


def test_films(context):
    right, denoiser = truth(), make_denoiser(context, Programs(context), "fast")
    split = film(right, 16, context)
    raw, fast = read(split.radiance), read(denoiser.filter(split))
    raster = read(denoiser.filter(split, RASTERS["too bright"]))
    errors = [relmse(picture[8:, :, :3], right[8:]) for picture in (raw, fast, raster)]
    assert errors[1] < 0.7 * errors[0] and errors[2] < 0.5 * errors[0]
    assert np.array_equal(fast[:8], raw[:8]) and np.array_equal(fast[..., 3], raw[..., 3])
    assert relmse(raster[:8, :, :3], right[:8]) < 0.5 * relmse(raw[:8, :, :3], right[:8])
    split.is_split = False
    np.testing.assert_allclose(read(denoiser.filter(split)), read(denoiser._wavelet.filter(split)))
    denoiser.release()


def test_rare_light_is_kept_beside_a_picture_that_lacks_it(context):
    """Half of the light comes by one sample in fifty."""
    right, denoiser, rng = truth(), make_denoiser(context, Programs(context), "fast"), np.random.default_rng(0)
    rare = [(right * (0.5 + rng.binomial(32, 0.02, (SIZE, SIZE, 1)) / 1.28)).astype(np.float32) for _ in range(2)]
    split = film(right, 64, context, of=rare)
    kept = read(denoiser.filter(split, 0.5 * right))[8:, :, :3]
    assert kept.mean() == pytest.approx(sum(rare)[8:].mean() / 2, rel=0.02)
    assert relmse(kept, right[8:]) < 0.5 * relmse(sum(rare)[8:] / 2, right[8:])
    denoiser.release()


@pytest.mark.parametrize("bad", [np.nan, np.inf, 1e20])
def test_what_is_not_finite_does_not_spread(context, bad):
    denoiser = make_denoiser(context, Programs(context), "fast")
    with np.errstate(over="ignore", invalid="ignore"):
        split = film(truth(), 4, context, bad=bad)
    for guide in (None, np.where(np.arange(SIZE)[:, None, None] == 20, np.float32(bad), truth())):
        result = read(denoiser.filter(split, guide)).copy()
        result[30, 30] = 0
        assert np.isfinite(result).all() and result[..., :3].max() < 10
    denoiser.release()
