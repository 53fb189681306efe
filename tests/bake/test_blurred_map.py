"""The blurred background against harmonics and Gaussians that are known on paper."""

from __future__ import annotations

import numpy as np
import pytest

from viewer.bake.background import blurred, is_magnified
from viewer.scene.equirect import sphere_integral, texel_directions


@pytest.mark.parametrize("degrees", [2.0, 20.0, 90.0])
def test_harmonics_are_scaled_by_the_heat_kernel(degrees):
    """cos(theta) has degree 1, 3 cos^2(theta) - 1 degree 2; the mean stays."""
    def harmonics(y: np.ndarray, first: float, second: float) -> np.ndarray:
        return np.stack([2 + first * y, 2 + second * (1.5 * y * y - 0.5), 2 + 0 * y], axis=-1)

    y = texel_directions(64, 128)[..., 1]
    out = blurred(np.broadcast_to(harmonics(y, 1, 1), (64, 128, 3)).astype(np.float32), degrees)
    variance = np.radians(degrees) ** 2
    height = len(out)
    y = texel_directions(height, 2 * height)[..., 1]
    expected = np.broadcast_to(harmonics(y, np.exp(-variance), np.exp(-3 * variance)), out.shape)
    assert np.abs(out - expected).max() < 2e-3


@pytest.mark.parametrize("row", [0, 100, 511])
def test_a_lamp_becomes_a_gaussian_of_its_light_anywhere(row):
    """Also at a pole, where texels are slivers."""
    map_ = np.zeros((512, 1024, 3), np.float32)
    map_[row, 700] = 1e5
    out = blurred(map_, 3.0)
    height, sigma = len(out), np.radians(3.0)
    angle = np.arccos(np.clip(texel_directions(height, 2 * height) @ texel_directions(512, 1024)[row, 700], -1, 1))
    power = sphere_integral(map_)[0]
    expected = power * np.exp(-angle**2 / (2 * sigma**2)) / (2 * np.pi * sigma**2)
    assert np.abs(out[..., 0] - expected).max() < 0.01 * expected.max() and out.min() >= 0
    assert sphere_integral(out) == pytest.approx([power] * 3, rel=3e-3)


def test_a_blur_below_the_least_is_the_least(monkeypatch):
    monkeypatch.setattr("viewer.bake.background.LEAST_BLUR", 9.0)
    map_ = np.random.default_rng(2).random((64, 128, 3)).astype(np.float32)
    assert np.array_equal(blurred(map_, 1e-3), blurred(map_, 9.0))
    assert np.allclose(blurred(np.ones((32, 64, 3), np.float32), 9.0), 1, atol=1e-6)


def test_a_map_is_magnified_where_a_texel_covers_two_pixels():
    pixel = np.pi / 1000
    assert is_magnified(500, pixel) and not is_magnified(501, pixel) and is_magnified(4096, 0.0)
