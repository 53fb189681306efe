"""The table of what a fibre scatters about itself, against means of the model over the fibre's width."""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np
import pytest

from viewer.bake.fibre import ABSORPTIONS, ANGLES, COSINES, HALF_ABSORPTION, fibre_table

sys.path.append(str(Path(__file__).parents[1] / "shaders"))
from fibre_twin import attenuation, azimuthal, scale

H = (np.arange(20000) + 0.5) / 10000 - 1


@pytest.mark.parametrize("beta_n, ior", [(0.3, 1.55), (0.8, 1.4)])
def test_texels_are_means_over_the_offset(beta_n, ior):
    table = fibre_table(beta_n, ior)
    assert table.shape == (ABSORPTIONS, COSINES, ANGLES, 4)
    for k, j, i in ((0, 15, 3), (5, 15, 127), (11, 8, 64), (17, 3, 100), (2, 12, 40)):
        x, phi, theta = k / (ABSORPTIONS - 1), np.pi * (i + 0.5) / ANGLES, np.arccos(j / (COSINES - 1))
        m = {"eta": ior, "sigma_a": np.full(1, HALF_ABSORPTION * x / (1 - x))}
        A, gamma_t = attenuation(m, H, theta)
        around = [azimuthal(phi - (2 * p * gamma_t - 2 * np.arcsin(H) + p * np.pi), scale(beta_n)) for p in range(3)]
        expected = [(A[p, :, 0] * around[p]).mean() for p in range(3)] + [A[3].mean() / (2 * np.pi)]
        np.testing.assert_allclose(table[k, j, i], expected, rtol=0.01, atol=2e-4)


@pytest.mark.parametrize("beta_n", [0.0, 0.3, 1.0])
def test_no_light_is_lost_without_absorption_and_less_comes_with_more(beta_n):
    table = fibre_table(beta_n, 1.55).astype(np.float64)
    total = table.sum(axis=(2, 3)) * 2 * np.pi / ANGLES  # of both sides
    np.testing.assert_allclose(total[0], 1, atol=2e-3)
    assert (np.diff(total, axis=0) < 1e-6).all() and (table >= 0).all()
    reflected = table[..., 0].sum(axis=2)
    np.testing.assert_allclose(total[-1], reflected[-1] * 2 * np.pi / ANGLES, atol=1e-6)
