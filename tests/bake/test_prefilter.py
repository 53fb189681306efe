from __future__ import annotations

import numpy as np
import pytest
from maps import bilinear, convolved, noise_with_sun, random_directions
from needs import CORPUS, needs

from viewer.bake.prefilter import LEVEL_ROUGHNESS, LEVELS, MARGIN, level_integral, prefilter, row_angles
from viewer.bake.sun import extract_sun
from viewer.gpu.call import call_glsl
from viewer.scene.environment_files import load_environment
from viewer.scene.equirect import sphere_integral, texel_directions, texel_solid_angles

ENVIRONMENTS = CORPUS / "environments"


def test_levels_are_a_mip_chain():
    levels, _ = prefilter(noise_with_sun())
    assert [level.shape for level in levels[:-1]] == [(512 >> k, 1024 >> k, 3) for k in range(LEVELS - 1)]
    assert levels[-1].shape == (32, 64, 3)  # the mip level after the irradiance
    assert all(level.dtype == np.float32 and level.min() >= 0 for level in levels)


@pytest.mark.parametrize("size", [(1, 1), (4, 16), (100, 200), (512, 1024)])
def test_every_level_of_a_constant_map_is_that_constant(size):
    levels, _ = prefilter(np.full((*size, 3), 0.7, np.float32))
    assert max(np.abs(level / 0.7 - 1).max() for level in levels) < 1e-5


def test_black_stays_black():
    levels, _ = prefilter(np.zeros((32, 64, 3), np.float32))
    assert max(level.max() for level in levels) == 0


def test_every_level_holds_the_energy_of_the_map_and_of_its_sun():
    radiance = noise_with_sun(64)
    levels, _ = prefilter(radiance)
    for level in levels:
        assert level_integral(level) == pytest.approx(sphere_integral(radiance), rel=1e-5)
    # level_integral itself, against a fine sum of what a bilinear lookup sees
    directions = texel_directions(256, 512)
    for level in levels[2:]:
        seen = sphere_integral(bilinear(level, directions, MARGIN))
        assert level_integral(level) == pytest.approx(seen, rel=1e-3)


@pytest.mark.parametrize("direction", [(0.6, 0.48, 0.64), (-0.8, 0.0, -0.6), (0.0, -0.8, 0.6), (0.05, 0.998, 0.0)])
def test_a_bright_texel_is_brightest_where_it_is_at_every_level(direction):
    direction = np.array(direction) / np.linalg.norm(direction)
    aim = texel_directions(512, 1024)
    radiance = np.full((512, 1024, 3), 0.01, np.float32)
    radiance[np.unravel_index((aim @ direction).argmax(), (512, 1024))] = 1000
    levels, _ = prefilter(radiance)
    for level in levels:
        height = len(level)
        theta, phi = row_angles(height)[:, None], 2 * np.pi * ((np.arange(2 * height) + 0.5) / (2 * height) - 0.5)
        towards = np.stack([np.sin(theta) * np.cos(phi), np.cos(theta) + 0 * phi, np.sin(theta) * np.sin(phi)], axis=-1)
        brightest = np.unravel_index(level[:, :, 1].argmax(), level.shape[:2])
        assert np.arccos(min(1.0, towards[brightest] @ direction)) < 1.6 * np.pi / height


def test_the_widest_level_is_the_lobe_of_roughness_1_seen_at_a_grazing_angle():
    """NoL / (NoL + NoV) for NoV = 1/4, by a sum over the texels at the level's own places."""
    radiance = noise_with_sun(64, sun=30)
    level = prefilter(radiance)[0][-1]
    rows = row_angles(len(level))
    phi = 2 * np.pi * ((np.arange(2 * len(level)) + 0.5) / (2 * len(level)) - 0.5)
    n = np.stack([np.sin(rows)[:, None] * np.cos(phi), np.cos(rows)[:, None] + 0 * phi,
                  np.sin(rows)[:, None] * np.sin(phi)], axis=-1).reshape(-1, 3)
    NoL = np.maximum(n @ texel_directions(64, 128).reshape(-1, 3).T, 0)
    weight = NoL / (NoL + 0.25) * np.repeat(texel_solid_angles(64, 128), 128)
    exact = (weight @ radiance.reshape(-1, 3) / weight.sum(axis=1, keepdims=True)).reshape(level.shape)
    assert np.abs(level - exact).max() < 0.02 * exact.mean()


def test_levels_against_direct_quadrature():
    radiance = prefilter(noise_with_sun(64, sun=1000))[0][1]  # any smooth map will do that needs no interpolation
    radiance = np.ascontiguousarray(np.repeat(np.repeat(radiance, 2, axis=0), 2, axis=1))
    directions = random_directions(8)
    levels, _ = prefilter(radiance)
    for level, perceptual_roughness in list(zip(levels, LEVEL_ROUGHNESS))[2:]:
        exact = convolved(radiance, "ggx", perceptual_roughness**2, directions)
        found = bilinear(level, directions, MARGIN)
        assert np.abs(found - exact).max() < 0.03 * exact.max()
        assert np.abs(found - exact).mean() < 0.004 * exact.mean()


@needs("corpus")
@pytest.mark.parametrize("name", ["lightroom_14b_from_ktx", "noon_grass"])
def test_between_the_levels_a_lookup_is_near_the_exact_lobe(context, name):
    path = ENVIRONMENTS / f"{name}_1k.hdr"
    radiance = extract_sun(load_environment(path))[0].radiance
    levels, _ = prefilter(radiance)
    directions = random_directions(6)
    for perceptual_roughness in (0.3, 0.45, 0.75):
        lod = float(call_glsl("light/prefiltered.glsl", "lod_of_roughness", context=context,
                              perceptual_roughness=perceptual_roughness))
        k = int(lod)
        low, high = (bilinear(levels[i], directions, MARGIN) for i in (k, k + 1))
        found = low + (lod - k) * (high - low)
        exact = convolved(radiance, "ggx", perceptual_roughness**2, directions)
        assert (np.abs(found - exact) / (exact + 0.05 * radiance.mean())).mean() < 0.05
