"""Filters on synthetic noise: how much they reduce the error, what they must preserve, and extreme input.

`fast` is the wavelet filter alone, which the denoiser of that name combines with the samples (test_combining.py).
"""

from __future__ import annotations

import sys
from dataclasses import dataclass, replace
from types import SimpleNamespace

import numpy as np
import pytest
from needs import require

from viewer.errors import UsageError
from viewer.gpu.programs import Programs
from viewer.trace.denoise.denoiser import make_denoiser
from viewer.trace.denoise.wavelet import Wavelet

SIZE = 96
HITS = np.s_[30:, :]
"""The rows above are background."""


@dataclass
class Truth:
    """A chequered floor in perspective with the edge of a shadow, and a sphere; (H, W, 3), (H, W)."""

    light: np.ndarray
    albedo: np.ndarray
    normal: np.ndarray
    depth: np.ndarray

    @property
    def radiance(self) -> np.ndarray:
        radiance = self.light[..., None] * self.albedo
        radiance[:30] = 0.4, 0.6, 0.9
        return radiance


@pytest.fixture(scope="module")
def truth() -> Truth:
    y, x = np.mgrid[0:SIZE, 0:SIZE] / SIZE
    dx, dy = (x - 0.3) / 0.2, (y - 0.65) / 0.2
    is_sphere = dx * dx + dy * dy < 1
    nz = np.sqrt(np.maximum(1 - dx * dx - dy * dy, 0))
    normal = np.where(is_sphere[..., None], np.stack([dx, -dy, nz], -1), [0.0, 1.0, 0.0])
    depth = np.where(is_sphere, 1.3 - 0.2 * nz, 0.5 / np.maximum(y - 0.2, 0.02))
    checker = 0.2 + 0.6 * ((np.floor(x * 24) + np.floor(y * 24)) % 2)
    albedo = np.where(is_sphere[..., None], [0.8, 0.3, 0.2], checker[..., None])
    light = np.where(is_sphere, 0.2 + 0.8 * np.maximum(0.6 * dx - 0.8 * dy, 0), np.where(x > 0.7, 0.15, 1.0))
    return Truth(light, albedo, normal, depth)


def noisy(truth: Truth, samples: int, spread: float = 1.0, seed: int = 1) -> dict[str, np.ndarray]:
    """The arrays of a film with log-normal samples of relative variance `spread`, and no samples in the background."""
    rng = np.random.default_rng(seed)
    factors = rng.lognormal(-np.log1p(spread) / 2, np.sqrt(np.log1p(spread)), (samples, SIZE, SIZE, 1))
    factors[:, :30] = 1
    values = truth.radiance * factors
    count = np.full((SIZE, SIZE, 1), float(samples))
    hits = count * (np.arange(SIZE) >= 30)[:, None, None]
    rgba = {"radiance": (values.mean(0), 0 * count + 0.75), "sum": (values.sum(0), count),
            "squares": ((values**2).sum(0), count), "albedo": (truth.albedo * hits, hits),
            "normal": (truth.normal * hits, truth.depth[..., None] * hits),
            "emission": (0 * values[0], 0 * count)}
    return {name: np.concatenate(parts, axis=-1).astype(np.float32) for name, parts in rgba.items()}


@pytest.fixture(scope="module")
def programs(context):
    return Programs(context)


@pytest.fixture(scope="module", params=["fast", "oidn"])
def denoise(request, context, programs):
    if request.param == "oidn":
        require("oidn")
    denoiser = Wavelet(context, programs) if request.param == "fast" else make_denoiser(context, programs, "oidn")

    def run(arrays: dict[str, np.ndarray]) -> np.ndarray:
        height, width = arrays["radiance"].shape[:2]
        textures = {name: context.gl.texture((width, height), 4, np.ascontiguousarray(array), dtype="f4")
                    for name, array in arrays.items()}
        result = denoiser.filter(SimpleNamespace(**textures))
        return np.frombuffer(result.read(), np.float32).reshape(height, width, 4)

    run.kind = request.param
    yield run
    denoiser.release()


def error(pixels: np.ndarray, truth: Truth) -> float:
    """Relative root mean square error over the pixels with hits."""
    relative = (pixels[..., :3] - truth.radiance) / (truth.radiance + 0.05)
    return float(np.sqrt((relative[HITS] ** 2).mean()))


@pytest.mark.parametrize("samples, spread, fast, oidn", [
    (1, 1, 3.5, 4), (4, 10, 3.5, 6), (16, 1, 3.8, 1.3), (64, 10, 3, 1.9)])
def test_the_error_shrinks_by_a_factor(denoise, truth, samples, spread, fast, oidn):
    arrays = noisy(truth, samples, spread)
    before, after = error(arrays["radiance"], truth), error(denoise(arrays), truth)
    assert after < before / (fast if denoise.kind == "fast" else oidn)


def test_it_fades_out_as_the_picture_converges(denoise, truth):
    """The wavelet filter does not increase the error; a network may (measured: 0.05)."""
    arrays = noisy(truth, 512, 0.1)
    raw, after = error(arrays["radiance"], truth), error(denoise(arrays), truth)
    assert after < (raw if denoise.kind == "fast" else 0.1)


def test_what_is_no_surface_stays_as_it_was(denoise, truth):
    arrays = noisy(truth, 4)
    rng = np.random.default_rng(3)
    arrays["radiance"][:30, :, :3] = rng.uniform(0, 1e5, (30, SIZE, 3))
    result = denoise(arrays)
    assert np.array_equal(result[:30], arrays["radiance"][:30]) and (result[..., 3] == 0.75).all()


@pytest.mark.parametrize("denoise", ["oidn"], indirect=True)
def test_rims_of_media_are_filtered_where_samples_missed_them_and_so_is_alpha(denoise):
    """White smoke that thins out to the right, of which each sample collides or not; beyond it nothing is changed."""
    share = np.clip(1 - np.arange(SIZE) / 64, 0, 1)[None, :, None] * np.ones((SIZE, 1, 1))
    count = np.full((SIZE, SIZE, 1), 8.0)
    hits = np.random.default_rng(1).binomial(8, share).astype(float)
    zero, alpha = np.zeros((SIZE, SIZE, 3)), hits / 8
    rgba = {"radiance": (zero + 0.5 * alpha, alpha), "sum": (zero + 0.5 * hits, count), "albedo": (zero + hits, hits),
            "squares": (zero + 0.25 * hits, count), "normal": (zero, hits), "emission": (zero, hits)}
    arrays = {name: np.concatenate(parts, axis=-1).astype(np.float32) for name, parts in rgba.items()}
    result = denoise(arrays)

    def wrong(picture: np.ndarray, columns: slice) -> np.ndarray:
        return np.sqrt(((picture - share * [0.5, 0.5, 0.5, 1])[:, columns] ** 2).mean(axis=(0, 1)))

    for columns in (slice(0, 48), slice(48, 66)):
        assert (wrong(result, columns) < 0.4 * wrong(arrays["radiance"], columns)).all()
    assert not result[:, 68:].any()


def test_an_edge_of_the_light_stays_where_it_is(denoise, truth):
    """At 64 samples of moderate noise, the pixels beside the shadow's edge on the lower floor do not mix much."""
    result = denoise(noisy(truth, 64, 0.5))
    edge = int(np.argmax(truth.light[95] == 0.15))
    light = (result[85:, :, :3] / truth.albedo[85:]).mean((0, 2))
    assert light[edge - 2:edge] == pytest.approx(1.0, abs=0.11)
    assert light[edge:edge + 2] == pytest.approx(0.15, abs=0.08)


def test_a_lamp_does_not_shine_into_its_surroundings(denoise):
    """A lamp of radiance 100 whose outline crosses pixels, at 16 samples: its surroundings get none of its light, and
    its own radiance does not change."""
    inside = np.clip(12.5 - np.hypot(*(np.mgrid[0:SIZE, 0:SIZE] - 55.0)), 0, 1)
    samples = np.random.default_rng(2).random((16, SIZE, SIZE)) < inside
    values = np.where(samples[..., None], 100, 0.5) * np.ones(3)
    albedo = np.where(samples[..., None], 1.0, 0.5) * np.ones(3)
    ones = np.ones((SIZE, SIZE, 1))
    rgba = {"radiance": (values.mean(0), ones), "sum": (values.sum(0), 16 * ones),
            "squares": ((values**2).sum(0), 16 * ones), "albedo": (albedo.sum(0), 16 * ones),
            "normal": (16 * ones * [0, 0, 1], 32 * ones),
            "emission": (np.where(samples[..., None], 100.0, 0.0).sum(0) * np.ones(3), 0 * ones)}
    result = denoise({name: np.concatenate(parts, axis=-1).astype(np.float32) for name, parts in rgba.items()})
    around = result[(np.hypot(*(np.mgrid[0:SIZE, 0:SIZE] - 55.0)) > 13.5) & (np.arange(SIZE)[:, None] > 30)][:, :3]
    assert result[inside == 1][:, :3].mean() == pytest.approx(100, rel=1e-4)
    assert around == pytest.approx(0.5, rel={"fast": 0.02, "oidn": 0.2}[denoise.kind])


@pytest.mark.parametrize("height, width", [(1, 1), (2, 2), (1, 20)])
def test_a_picture_of_few_pixels_keeps_its_light(denoise, height, width):
    values = {"radiance": [0.3, 0.3, 0.3, 1], "sum": [4.8, 4.8, 4.8, 16], "squares": [1.44, 1.44, 1.44, 16],
              "albedo": [8, 8, 8, 16], "normal": [0, 0, 16, 32], "emission": [0, 0, 0, 0]}
    result = denoise({name: np.float32([[texel] * width] * height) for name, texel in values.items()})
    assert result[..., :3].mean() == pytest.approx(0.3, rel=0.05)


def test_the_light_is_kept(denoise, truth):
    """The mean stays the same to 1 %. A network may lose light, more if the noise has heavy tails."""
    for samples, spread in ((1, 1), (4, 10), (64, 10)):
        arrays = noisy(truth, samples, spread)
        ratio = denoise(arrays)[HITS][..., :3].mean() / arrays["radiance"][HITS][..., :3].mean()
        assert ratio == pytest.approx(1, abs=0.01 if denoise.kind == "fast" else 0.1)


def test_a_constant_stays_constant(denoise, truth):
    for value in (0.0, 1e-6, 1.0, 1e5):
        flat = Truth(np.full((SIZE, SIZE), value), 0 * truth.albedo + 0.5, 0 * truth.normal + 1, 0 * truth.depth + 2)
        arrays = noisy(flat, 4)
        arrays["radiance"][..., :3] = value / 2
        arrays["sum"][..., :3], arrays["squares"][..., :3] = 2 * value, value * value
        result = denoise(arrays)[HITS][..., :3]
        bound = 1e-5 * value if denoise.kind == "fast" else 0.2 * value + 1e-4
        assert np.abs(result - value / 2).max() <= bound


def test_fireflies_and_suns_leave_no_ring(denoise, truth):
    """The output lies between the smallest and the largest input.

    It has no negative value and no NaN, and no light is lost.
    """
    truth = replace(truth, albedo=0 * truth.albedo + 0.5)  # light that moves to a darker texel is dimmed
    arrays = noisy(truth, 4)
    spots = np.random.default_rng(5).integers(32, SIZE, (40, 2))
    for number, (row, column) in enumerate(spots):
        value = 10.0 ** (number % 6)
        arrays["radiance"][row, column, :3] = value
        arrays["sum"][row, column, :3], arrays["squares"][row, column, :3] = 4 * value, 16 * value * value
    result = denoise(arrays)
    assert np.isfinite(result).all() and result.min() >= 0 and result.max() <= 1.001e5
    if denoise.kind == "fast":
        assert result.sum() == pytest.approx(arrays["radiance"].sum(), rel=1e-4)


@pytest.mark.parametrize("value", [np.nan, np.inf, 3e38, 1e20, 1e-38, 0.0])
def test_what_is_not_finite_does_not_spread(denoise, truth, value):
    arrays = noisy(truth, 2)
    arrays["radiance"][60, 60, :3] = value
    with np.errstate(over="ignore"):
        arrays["sum"][60, 60, :3], arrays["squares"][60, 60, :3] = np.float32(2) * value, np.float32(value) ** 2
    arrays["normal"][62, 62] = 0
    arrays["normal"][64:66, 64] *= 1e18
    result = denoise(arrays)
    others = np.ones((SIZE, SIZE), bool)
    others[60, 60] = False
    assert np.isfinite(result[others]).all()
    if denoise.kind == "fast":
        assert result[others].max() < 30


def test_one_pixel_and_another_size(context, programs, truth):
    wavelet = Wavelet(context, programs)
    arrays = noisy(truth, 4)
    for cut in (np.s_[40:41, 40:41], np.s_[:, 3:50], np.s_[40:41, 40:41]):
        part = {name: np.ascontiguousarray(array[cut]) for name, array in arrays.items()}
        size = part["sum"].shape[1::-1]
        film = SimpleNamespace(**{name: context.gl.texture(size, 4, array, dtype="f4") for name, array in part.items()})
        result = np.frombuffer(wavelet.filter(film).read(), np.float32)
        assert result.size == part["sum"].size and np.isfinite(result).all()
        if size == (1, 1):
            assert result == pytest.approx(part["radiance"].ravel(), rel=1e-6)
    wavelet.release()


def test_without_the_extra_the_fix_is_told(context, programs, monkeypatch):
    monkeypatch.setitem(sys.modules, "pyoidn", None)
    with pytest.raises(UsageError, match=r"^--denoise oidn needs Open Image Denoise: pip install 'pbr-viewer\[oidn\]'"):
        make_denoiser(context, programs, "oidn")
