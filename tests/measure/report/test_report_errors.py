from __future__ import annotations

import numpy as np
import pytest

from viewer.image.image import Image
from viewer.measure.compare.relmse import Halves, relmse
from viewer.measure.report.errors import errors, relmse_floor, trimmed_floor, trimmed_relmse


def gray(value: float, shape: tuple[int, int] = (16, 16)) -> np.ndarray:
    return np.concatenate([np.full((*shape, 3), value, np.float32), np.ones((*shape, 1), np.float32)], axis=-1)


def left() -> np.ndarray:
    mask = np.zeros((16, 16), bool)
    mask[:, :8] = True
    return mask


def test_the_errors_of_known_pictures_within_the_mask():
    truth, ours = gray(0.5), gray(0.6)
    ours[:, 8:] = 0.7
    found = errors(Image.from_linear(ours), Image.from_linear(truth), left())
    assert found.rmse == pytest.approx(0.1, rel=1e-5)
    assert found.relmse == pytest.approx(0.01 / 0.26, rel=1e-5) and found.bad_pixels == 0
    assert found.too_bright == 1
    assert trimmed_relmse(ours, truth, left()) == pytest.approx(found.relmse, rel=1e-5)
    assert found.relmse_trimmed == pytest.approx(found.relmse)
    assert found.flip == pytest.approx(found.map[left()].mean())
    assert 0 < found.flip < found.map[:, 12:].mean() < 1


def test_the_same_picture_has_no_error():
    found = errors(Image.from_linear(gray(0.5)), Image.from_linear(gray(0.5)), left())
    assert (found.rmse, found.relmse, found.flip) == (0, 0, 0)


def test_what_is_not_finite_counts_as_black_and_is_told():
    ours = gray(0.5)
    ours[0, 0, 1], ours[0, 1, 0], ours[0, 9, 0] = np.nan, np.inf, np.nan
    found = errors(Image.from_linear(ours), Image.from_linear(gray(0.5)), left())
    assert found.too_bright == 0 and found.bad_pixels == 2
    assert found.relmse == pytest.approx(2 / 128 * 0.25 / 0.26, rel=1e-5)


def test_the_floor_is_what_the_references_noise_adds():
    rng = np.random.default_rng(0)
    truth = np.full((128, 128, 3), 0.5)
    halves = Halves(*(truth + rng.normal(0, 0.05, truth.shape) for _ in range(2)))
    mask = np.ones(truth.shape[:2], bool)
    measured = relmse(truth, halves.mean)
    assert relmse_floor(halves, mask) == pytest.approx(measured, rel=0.05)
    assert trimmed_floor(halves, mask) == pytest.approx(measured, rel=0.05)
    assert measured == pytest.approx(0.05**2 / 2 / 0.26, rel=0.05)


def test_one_pixel_is_left_out_of_a_thousand():
    ours, truth = gray(0.5, (50, 40)), gray(0.5, (50, 40))
    ours[..., :3] += 0.05
    ours[3, 4, :3], ours[20, 7, :3] = 100.0, 50.0
    found = errors(Image.from_linear(ours), Image.from_linear(truth), np.ones((50, 40), bool))
    assert found.relmse > 10 and found.relmse_trimmed == pytest.approx(0.05**2 / 0.26, rel=1e-4)
