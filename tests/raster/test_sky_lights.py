"""The lights that stand for an environment, as media and the ground take them."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
from shapes import lopsided

from viewer.raster.environment import EnvironmentLight
from viewer.settings import Settings


def test_their_irradiance_is_that_of_the_environment_whatever_is_baked(context):
    """Where nothing reflects, irradiance alone is baked, in a unit of its own."""
    environment = lopsided()
    found = []
    for with_levels in (False, True):
        light = EnvironmentLight(context, environment, Settings(), use_cache=False)
        light.bake(with_levels)
        lights = light.sky_lights(SimpleNamespace(ambient=False), 160)
        found.append(lights.irradiance)
        light.release()
    np.testing.assert_array_equal(*found)
    width, height = 2 * 64, 64
    theta = np.pi * (np.arange(height) + 0.5) / height
    solid_angle = np.sin(theta) * (np.pi / height) * (2 * np.pi / width)
    expected = np.einsum("h,hwc->c", solid_angle, environment.radiance)
    np.testing.assert_allclose(found[0].sum(axis=0), expected, rtol=0.02)
