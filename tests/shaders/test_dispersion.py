"""shaders/bsdf/dispersion.glsl against float64, and the two laws that its sampling owes: bands and weights."""

from __future__ import annotations

import numpy as np
import pytest

from viewer.gpu.call import call_glsl

FILE = "bsdf/dispersion.glsl"
BANDS = np.array([[609.0, 63.0], [541.0, 69.0], [452.0, 52.0]])


def cauchy(ior, dispersion, wavelength):
    """KHR_materials_dispersion: n_d + (n_d - 1) / V (523655 / lambda^2 - 1.5168), V = 20 / dispersion."""
    return np.maximum(ior + (ior - 1) / (20 / dispersion) * (523655 / wavelength**2 - 1.5168), 1)


def test_the_index_follows_cauchy():
    wavelength = np.linspace(390, 690, 50)
    for ior, dispersion in ((1.5, 1.0), (1.33, 0.36), (2.4, 5.0), (1.0, 5.0), (1.5, 40.0)):
        found = call_glsl(FILE, "ior_at_wavelength", ior=ior, dispersion=dispersion, wavelength=wavelength)
        np.testing.assert_allclose(found, cauchy(ior, dispersion, wavelength), rtol=1e-6)
    same = call_glsl(FILE, "ior_at_wavelength", ior=1.5, dispersion=0.0, wavelength=wavelength)
    np.testing.assert_array_equal(same, 1.5)


@pytest.mark.parametrize("dispersion", [0.5, 5.0])
def test_the_bands_have_their_mean_index(dispersion):
    """So that the raster's three indices stand for what paths see."""
    found = call_glsl(FILE, "ior_of_bands", ior=np.array([1.5]), dispersion=dispersion)[0]
    for index, (center, width) in zip(found, BANDS):
        x = np.linspace(-1, 1, 2001)
        mean = np.average(cauchy(1.5, dispersion, center + width * x), weights=1 - np.abs(x))
        assert abs(index - mean) < 1e-4 * dispersion


def test_wavelengths_are_weighted_without_bias():
    """Each channel's weight has mean 1, and its wavelengths the histogram of its band."""
    u = (np.arange(3 << 14) + 0.5) / (3 << 14)
    found = call_glsl(FILE, "sample_wavelength", u=u)
    wavelength, weight = found["return"].astype(float), found["weight"].astype(float)
    assert (weight >= 0).all() and weight.max() <= 3.001
    np.testing.assert_allclose(weight.mean(axis=0), 1, atol=1e-3)
    edges = np.linspace(390, 680, 30)
    for k, (center, width) in enumerate(BANDS):
        histogram = np.histogram(wavelength, edges, weights=weight[:, k])[0] / len(u)
        x = np.clip((edges - center) / width, -1, 1)
        np.testing.assert_allclose(histogram, np.diff(0.5 + x - np.sign(x) * x * x / 2), atol=1e-3)
