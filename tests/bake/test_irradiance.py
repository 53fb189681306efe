"""Irradiance from the bake against direct summation over an environment's texels."""

from __future__ import annotations

import numpy as np
import pytest
from maps import bilinear, irradiance_of, random_directions
from needs import CORPUS, needs

from viewer.bake.dominant import ambient_and_key
from viewer.bake.irradiance import cosine_spectrum
from viewer.bake.prefilter import MARGIN, prefilter
from viewer.bake.sun import extract_sun
from viewer.scene.environment_files import load_environment
from viewer.scene.equirect import sphere_integral, texel_directions

ENVIRONMENTS = CORPUS / "environments"
NORMALS = np.concatenate([random_directions(12), np.eye(3), -np.eye(3)])


def looked_up(radiance: np.ndarray) -> np.ndarray:
    return np.pi * bilinear(prefilter(radiance)[1], NORMALS, MARGIN)


def test_the_cosine_s_spectrum_is_what_quadrature_gives():
    x, weights = np.polynomial.legendre.leggauss(400)
    x, weights = (x + 1) / 2, weights / 2  # the cosine is clamped: 0 to 1 only
    found = [2 * weights @ (x * np.polynomial.legendre.legval(x, np.eye(32)[n])) for n in range(32)]
    assert cosine_spectrum(31) == pytest.approx(np.array(found), abs=1e-12)


def test_a_constant_map_stays_constant():
    irradiance = prefilter(np.full((64, 128, 3), 3.0, np.float32))[1]
    assert irradiance == pytest.approx(3.0, rel=1e-5)


def test_a_single_light():
    radiance = np.zeros((64, 128, 3), np.float32)
    radiance[20, 30] = 100
    exact = irradiance_of(radiance, NORMALS)
    # The cosine's kink, where the light sets, is what degrees up to 63 and 3 degrees of spacing blur.
    assert np.abs(looked_up(radiance) - exact).max() < 0.005 * exact.max()


# The largest error over all normals, relative to the mean irradiance; 0.0031 was measured.
@needs("corpus")
@pytest.mark.parametrize("name", ["lightroom_14b_from_ktx", "chinese_garden", "noon_grass", "studio_small_05"])
def test_real_environments_without_their_sun(name):
    path = ENVIRONMENTS / f"{name}_1k.hdr"
    radiance = extract_sun(load_environment(path))[0].radiance
    error = np.abs(looked_up(radiance) - irradiance_of(radiance, NORMALS))
    assert error.max() < 0.004 * sphere_integral(radiance).mean() / 4  # pi times the mean radiance


def test_a_lone_light_is_its_own_key_light():
    radiance = np.zeros((64, 128, 3), np.float32)
    radiance[20, 30] = [100, 50, 25]
    ambient, key = ambient_and_key(prefilter(radiance)[1])
    lux = sphere_integral(radiance)
    assert np.multiply(key.color, key.intensity) == pytest.approx(lux, rel=0.01)
    assert -np.array(key.direction) @ texel_directions(64, 128)[20, 30] > 0.9999
    assert ambient.max() < 0.01 * lux.max()


def test_an_even_environment_is_all_ambient():
    ambient, key = ambient_and_key(prefilter(np.full((64, 128, 3), 2.0, np.float32))[1])
    assert ambient == pytest.approx(2 * np.pi, rel=1e-3)
    assert key.intensity < 1e-3
