from __future__ import annotations

import numpy as np
import pytest

from viewer.scene.equirect import resample, shrink, sphere_integral, texel_directions, texel_solid_angles


@pytest.mark.parametrize("size", [(1, 1), (3, 7), (64, 128)])
def test_texels_cover_the_sphere_once(size):
    assert texel_solid_angles(*size).sum() * size[1] == pytest.approx(4 * np.pi, rel=1e-12)


def test_directions_invert_the_texture_mapping():
    d = texel_directions(16, 32)
    u = 0.5 + np.arctan2(d[..., 2], d[..., 0]) / (2 * np.pi)
    v = np.arccos(d[..., 1]) / np.pi
    assert np.abs(u - (np.arange(32) + 0.5) / 32).max() < 1e-12
    assert np.abs(v - (np.arange(16)[:, None] + 0.5) / 16).max() < 1e-12
    assert np.array_equal(texel_directions(16, 32, slice(3, 5)), d[3:5])


@pytest.mark.parametrize("old", [(64, 128), (48, 80), (37, 101)])
def test_shrinking_keeps_the_integral_over_the_sphere(old):
    radiance = np.random.default_rng(1).random((*old, 3), np.float32) ** 8
    small = resample(radiance, 16, 32)
    assert small.shape == (16, 32, 3)
    assert sphere_integral(small) == pytest.approx(sphere_integral(radiance), rel=2e-3)
    assert small.min() >= 0


def test_shrinking_by_a_whole_factor_is_exact_and_stops_at_the_size_asked_for():
    radiance = np.random.default_rng(2).random((64, 128, 3), np.float32) ** 8
    assert shrink(radiance, 20, 40) is radiance  # the factor would be 3, which divides neither 64 nor 128
    small = shrink(radiance, 16, 32)
    assert small.shape == (16, 32, 3)
    assert sphere_integral(small) == pytest.approx(sphere_integral(radiance), rel=1e-6)


def test_growing_interpolates_across_the_seam():
    radiance = np.zeros((2, 4, 3), np.float32)
    radiance[:, 0] = 1
    large = resample(radiance, 2, 8)
    assert large[0, :, 0] == pytest.approx([0.75, 0.75, 0.25, 0, 0, 0, 0, 0.25])
