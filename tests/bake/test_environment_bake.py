from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from viewer.bake.environment import bake_environment
from viewer.bake.prefilter import level_integral
from viewer.scene.environment import Environment
from viewer.scene.environment_files import load_environment
from viewer.scene.equirect import sphere_integral


def energy(baked, level: int) -> np.ndarray:
    suns = sum((np.array(sun.color) * sun.intensity for sun in baked.suns), np.zeros(3))
    return level_integral(baked.levels[level].astype(np.float32)) * baked.scale + suns


def test_a_sky_keeps_its_energy_in_levels_and_sun():
    environment = load_environment("sky")
    baked = bake_environment(environment)
    assert len(baked.suns) == 1
    for level in range(6):
        assert baked.levels[level].dtype == np.float16
        assert energy(baked, level) == pytest.approx(sphere_integral(environment.radiance), rel=1e-3)


@pytest.mark.parametrize("unit", [1e-20, 1e-6, 1.0, 1e9])
def test_half_floats_hold_any_unit_of_radiance(unit):
    radiance = np.random.default_rng(6).random((32, 64, 3)).astype(np.float32) * np.float32(unit)
    baked = bake_environment(Environment("noise", radiance), cache=False)
    assert np.log2(baked.scale) % 1 == 0
    for level in range(6):
        assert np.isfinite(baked.levels[level]).all()
        assert energy(baked, level) == pytest.approx(sphere_integral(radiance), rel=1e-3)
    assert baked.irradiance.astype(np.float64) * baked.scale / unit == pytest.approx(0.5, rel=0.1)


def test_black_is_black():
    baked = bake_environment(Environment("black", np.zeros((32, 64, 3), np.float32)), cache=False)
    assert max(level.max() for level in baked.levels) == 0
    assert not baked.irradiance.any()


def test_a_cached_bake_is_the_same_and_does_not_touch_the_pixels():
    def never() -> np.ndarray:
        raise AssertionError("decoded")

    environment = load_environment("sky")
    baked = bake_environment(environment)
    again = bake_environment(replace(environment, source=never))
    assert again.scale == baked.scale
    assert again.suns == baked.suns
    assert np.array_equal(again.irradiance, baked.irradiance)
    assert all(np.array_equal(a, b) for a, b in zip(again.levels, baked.levels))
    with pytest.raises(AssertionError, match="decoded"):
        bake_environment(replace(environment, source=never), cache=False)
    with pytest.raises(AssertionError, match="decoded"):
        bake_environment(replace(environment, source=never), ndf="beckmann")


def test_without_a_digest_the_pixels_are_the_key(own_cache):
    one = Environment("a", np.ones((16, 32, 3), np.float32))
    bake_environment(one)
    bake_environment(replace(one, name="b", rotation=1.0, intensity=2.0))
    assert len(list(own_cache.iterdir())) == 1
    bake_environment(replace(one, source=one.radiance * 2))
    assert len(list(own_cache.iterdir())) == 2


def test_switched_off_nothing_is_written(own_cache):
    bake_environment(load_environment("furnace"), cache=False)
    assert not own_cache.exists()


def test_an_unknown_lobe_is_refused():
    with pytest.raises(ValueError, match="there is no distribution 'gxx'"):
        bake_environment(load_environment("furnace"), ndf="gxx")
