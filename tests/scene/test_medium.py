"""Media: what their coefficients say."""

import numpy as np

from viewer.scene.medium import VACUUM, Medium


def test_extinction_is_absorption_and_scattering():
    medium = Medium(sigma_t=(2.0, 1.0, 0.0), albedo=(0.25, 1.0, 1.0))
    np.testing.assert_allclose(medium.sigma_a, (1.5, 0.0, 0.0))
    assert medium.scatters
    assert not Medium(sigma_t=(2.0, 1.0, 0.0), albedo=(0.0, 0.0, 1.0)).scatters and not VACUUM.scatters
    assert Medium(sigma_t=(2.0, 1.0, 0.5)).sigma_a == (2.0, 1.0, 0.5)
