from __future__ import annotations

import math

import numpy as np
import pytest

from viewer.scene.environment_files import load_environment
from viewer.scene.environment_presets import PRESETS, SUN_ELEVATION, SUN_RADIUS
from viewer.scene.equirect import sphere_integral, texel_directions, texel_solid_angles

LUMINANCE = np.array([0.2126, 0.7152, 0.0722])


def irradiance(radiance: np.ndarray, normal) -> np.ndarray:
    height, width = radiance.shape[:2]
    cosine = np.maximum(texel_directions(height, width) @ np.asarray(normal, np.float64), 0)
    return np.einsum("hwc,hw,h->c", radiance, cosine, texel_solid_angles(height, width))


@pytest.mark.parametrize("name", PRESETS)
def test_presets_are_radiance_maps(name):
    environment = load_environment(name)
    radiance = environment.radiance
    assert environment.name == name
    assert environment.digest
    assert radiance.dtype == np.float32
    assert radiance.shape[1] == 2 * radiance.shape[0]
    assert np.isfinite(radiance).all()
    assert radiance.min() >= 0
    PRESETS[name].cache_clear()
    assert np.array_equal(PRESETS[name](), radiance)


def test_the_furnace_is_one_everywhere():
    assert np.all(load_environment("furnace").radiance == 1)


def test_the_studio_is_neutral_and_lights_the_side_that_is_seen():
    radiance = load_environment("studio").radiance
    assert np.ptp(radiance, axis=2).max() == 0
    elevation, azimuth = math.radians(15), math.radians(30)
    to_camera = [math.cos(elevation) * math.sin(azimuth), math.sin(elevation), math.cos(elevation) * math.cos(azimuth)]
    assert irradiance(radiance, to_camera)[0] / np.pi == pytest.approx(1, abs=0.1)
    assert irradiance(radiance, [0, -1, 0])[0] / np.pi < 0.2
    assert radiance.max() < 10


def test_the_ground_fades_into_the_sky_at_the_horizon_and_is_grey_below():
    """Aerial perspective: of the ground, exp(-0.02 / sin of the angle below the horizon) is left."""
    radiance = load_environment("sky").radiance
    height = len(radiance)
    above, below = (radiance[row].astype(float) @ LUMINANCE for row in (height // 2 - 1, height // 2))
    assert np.abs(below / above - 1).max() < 0.01
    ground = 0.2  # of a white surface's 1
    angles = np.pi * (np.arange(height // 2) + 0.5) / height
    left = np.exp(-0.02 / np.sin(angles))
    expected = left * ground + (1 - left) * above[0]
    assert np.allclose(radiance[height // 2:, 0] @ LUMINANCE, expected, rtol=3e-3)


def test_the_sky_lights_the_ground_with_pi_and_most_of_it_is_sun():
    radiance = load_environment("sky").radiance
    assert irradiance(radiance, [0, 1, 0]) @ LUMINANCE == pytest.approx(np.pi, rel=2e-3)
    bright = radiance[:, :, 1] > 1000
    solid_angle = (bright * texel_solid_angles(*radiance.shape[:2])[:, None]).sum()
    disk = 2 * np.pi * (1 - math.cos(SUN_RADIUS))
    assert disk < solid_angle < 6 * disk  # the texels the disk touches
    sun = np.einsum("hwc,hw,h->c", radiance, bright, texel_solid_angles(*radiance.shape[:2]))
    share = sun @ LUMINANCE * math.sin(SUN_ELEVATION) / np.pi
    assert 0.6 < share < 0.85  # a clear day
    assert sun[0] > sun[1] > sun[2]
    assert radiance[0, 0, 2] > 1.5 * radiance[0, 0, 0]  # blue above
    assert sphere_integral(radiance[256:])[1] > 0
