from __future__ import annotations

import numpy as np
import pytest
from maps import convolved, noise_with_sun

from viewer.bake.lobes import lobe_spectrum
from viewer.bake.spherical_convolution import Filter, convolve, legendre_tables
from viewer.scene.equirect import sphere_integral, texel_directions
from viewer.settings import NDFS


def centre_rows(height: int) -> np.ndarray:
    return np.pi * (np.arange(height // 2) + 0.5) / height


def test_legendre_functions_are_orthonormal():
    nodes, weights = np.polynomial.legendre.leggauss(64)
    for first, table in legendre_tables(60, np.arccos(nodes)):
        for m, values in enumerate(table, start=first):
            gram = (values[m:].astype(np.float64) * weights) @ values[m:].T
            assert np.abs(gram - np.eye(61 - m)).max() < 2e-6


@pytest.mark.parametrize("ndf", NDFS)
@pytest.mark.parametrize(("alpha", "bound"), [(0.15, 1e-4), (0.4, 5e-4), (1.0, 6e-3)])
def test_against_direct_quadrature_under_a_sun(ndf, alpha, bound):
    # Wide lobes end in a kink at the horizon, and 64 degrees round it off: only there, 90 degrees from the sun.
    radiance = noise_with_sun(128)
    [result] = convolve(radiance, [Filter(centre_rows(64), lobe_spectrum(ndf, alpha, 63))])
    some = (slice(None, None, 5), slice(None, None, 7))  # the sun is at (16, 21)
    exact = convolved(radiance, ndf, alpha, texel_directions(64, 128)[some].reshape(-1, 3))
    assert np.abs(result[some].reshape(-1, 3) - exact).max() < bound * exact.max()


def test_a_constant_map_stays_constant():
    radiance = np.full((64, 128, 3), [0.1, 1, 1000], np.float32)
    results = convolve(radiance, [Filter(centre_rows(h), lobe_spectrum("ggx", 0.1, h - 1)) for h in (64, 32, 16)])
    for result in results:
        assert np.abs(result / radiance[0, 0] - 1).max() < 1e-5


def test_total_energy_does_not_change():
    radiance = noise_with_sun(128)
    [result] = convolve(radiance, [Filter(centre_rows(64), lobe_spectrum("ggx", 0.2, 63))])
    assert sphere_integral(result) == pytest.approx(sphere_integral(radiance), rel=1e-3)


def test_rows_beyond_a_pole_hold_what_lies_across_it():
    theta = np.pi * np.array([-0.5, 0.5, 1.5, 2.5]) / 6
    [result] = convolve(noise_with_sun(), [Filter(theta, lobe_spectrum("ggx", 0.3, 7))])
    assert np.ptp(result[0], axis=0).min() > 0.1
    assert np.abs(result[0] - np.roll(result[1], 8, axis=0)).max() < 1e-5 * result.max()
    assert np.abs(result[-1] - np.roll(result[-2], 8, axis=0)).max() < 1e-5 * result.max()
