from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from maps import irradiance_of, random_directions

from viewer.bake.irradiance import irradiance, irradiance_coefficients
from viewer.bake.prefilter import prefilter
from viewer.bake.sun import extract_sun
from viewer.scene.environment_files import load_environment
from viewer.scene.equirect import sphere_integral, texel_directions

ENVIRONMENTS = Path(__file__).resolve().parents[2].parent / "shared" / "corpus" / "environments"
NORMALS = random_directions(12)


def coefficients_of(radiance: np.ndarray) -> np.ndarray:
    return irradiance_coefficients(prefilter(radiance)[1])


@pytest.mark.parametrize(
    "function",
    [
        lambda x, y, z: 1 + 0 * x,
        lambda x, y, z: 1 + 0.5 * x - 0.3 * y + 0.2 * z,
        lambda x, y, z: 1 + x * y - 0.4 * y * z + 0.7 * x * z + 0.2 * y * y - 0.3 * z * z,
        lambda x, y, z: 1 + x * y**3 - x**3 * z + 0.4 * z**4 - y * z * (3 * x * x - z * z) + x * x * y * y,
    ],
)
def test_low_degrees_are_exact(function):
    x, y, z = np.moveaxis(texel_directions(512, 1024), 2, 0)
    radiance = np.repeat(function(x, y, z)[:, :, None], 3, axis=2).astype(np.float32) + 2
    exact = irradiance_of(radiance, NORMALS)
    assert irradiance(NORMALS, coefficients_of(radiance)) == pytest.approx(exact, rel=2e-5)


def test_a_single_light_on_one_side_is_missed_by_no_more_than_the_degrees_above_4():
    radiance = np.zeros((64, 128, 3), np.float32)
    radiance[20, 30] = 100
    exact = irradiance_of(radiance, NORMALS)
    found = irradiance(NORMALS, coefficients_of(radiance))
    assert found.min() >= 0
    # Degrees 6, 8, ... of a clamped cosine: sum (2l+1)/4 |A_l / pi| at the lit pole is 0.063 of the peak.
    assert np.abs(found - exact).max() < 0.08 * exact.max()


# The largest error over all normals, relative to the mean irradiance, measured: 0.058, 0.017, 0.013, 0.082.
@pytest.mark.parametrize(
    ("name", "bound"),
    [("lightroom_14b_from_ktx", 0.07), ("chinese_garden", 0.025), ("noon_grass", 0.02), ("studio_small_05", 0.1)],
)
def test_real_environments_without_their_sun(name, bound):
    path = ENVIRONMENTS / f"{name}_1k.hdr"
    if not path.is_file():
        pytest.skip("the corpus is not here")
    radiance = extract_sun(load_environment(path))[0].radiance
    exact = irradiance_of(radiance, NORMALS)
    error = np.abs(irradiance(NORMALS, coefficients_of(radiance)) - exact)
    assert error.max() < bound * sphere_integral(radiance).mean() / 4  # pi times the mean radiance
