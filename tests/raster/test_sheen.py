"""Sheen in the raster: its albedo, what it takes from the cloth, and its extremes."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from images import image_of
from shapes import constant, lopsided, orthographic, plate, scene, sphere

from viewer.gpu.call import call_glsl
from viewer.scene.light import Light
from viewer.scene.material import Material, Texture

CAMERA, SIZE = orthographic(0.5, 0.4, height=2.1), (48, 48)
ROUGHNESS = (0.05, 0.2, 0.4, 0.7, 1.0)


@pytest.mark.parametrize("roughness", ROUGHNESS)
def test_the_albedo_is_that_of_the_lobe_or_half_a_hundredth_more(roughness):
    """By quadrature of the lobe; so that what the fibres take from the cloth is at least what they reflect."""
    x, weight = np.polynomial.legendre.leggauss(64)
    mu, phi = ((x + 1) / 2) ** 2, (np.arange(96) + 0.5) / 96 * np.pi
    weights = ((weight * (x + 1) / 2 * mu)[:, None] * 2 * np.pi / 96) + 0 * phi
    NoL, cosine = np.broadcast_arrays(mu[:, None], np.cos(phi))
    for NoV in (1.0, 0.7, 0.4, 0.2, 0.1, 0.05, 0.01, 0.003):
        LoV = NoV * NoL + np.sqrt((1 - NoV**2) * (1 - NoL**2)) * cosine
        s2 = 1 - (NoV + NoL) ** 2 / (2 + 2 * LoV)
        f = call_glsl("bsdf/charlie.glsl", "charlie", NoV=np.full_like(NoL, NoV), NoL=NoL, s2=s2,
                      perceptual_roughness=np.full_like(NoL, roughness))
        assert np.isfinite(f).all() and f.min() >= 0
        found = call_glsl("bsdf/charlie.glsl", "charlie_albedo", mu=NoV, perceptual_roughness=roughness)
        assert -2e-4 < float(found) - (f * weights).sum() < 0.0055


@pytest.mark.parametrize("roughness", [0.0, 0.01, 0.3, 1.0])
def test_zeltners_lobe_integrates_to_1_and_its_albedo_is_at_most_1(roughness):
    """In the stretched frame of the cosine, whose nodes the lobe takes to its own directions."""
    x, weight = np.polynomial.legendre.leggauss(64)
    z2, phi = (x + 1) / 2, (np.arange(64) + 0.5) / 64 * 2 * np.pi
    c = np.stack(np.broadcast_arrays(np.sqrt(1 - z2)[:, None] * np.cos(phi), np.sqrt(1 - z2)[:, None] * np.sin(phi),
                                     np.sqrt(z2)[:, None]), axis=-1)  # z^2 is even for a cosine
    for NoV in (1.0, 0.7, 0.1, 1e-3, 1e-6):
        a, b = call_glsl("bsdf/zeltner.glsl", "zeltner_transform", mu=NoV, r=roughness).astype(float)
        wi = np.stack([(c[..., 0] - b * c[..., 2]) / a, c[..., 1] / a, c[..., 2]], axis=-1)
        length = np.linalg.norm(wi, axis=-1)
        wi /= length[..., None]
        expected = c[..., 2] / np.pi * length**3 * a**2
        LoV = wi[..., 2] * NoV + wi[..., 0] * np.sqrt(1 - NoV**2)
        found = wi[..., 2] * call_glsl("bsdf/zeltner.glsl", "zeltner_over_cosine", ab=np.array([a, b]), NoV=NoV,
                                       NoL=wi[..., 2], LoV=LoV)
        assert (np.abs(found / expected - 1) * weight[:, None]).sum() / 128 < 2e-3
        E = call_glsl("bsdf/zeltner.glsl", "zeltner_albedo", mu=NoV, r=roughness)
        assert 0 <= E <= 1 and (E < 1e-4 or roughness > 0.01 or NoV < 0.1)


@pytest.mark.parametrize("lobe", ["charlie", "zeltner"])
@pytest.mark.parametrize("roughness", ROUGHNESS)
@pytest.mark.parametrize("cloth", [{"metallic": 0.0}, {"metallic": 0.0, "clearcoat": 1.0}, {"metallic": 1.0}], ids=str)
def test_white_vanishes_under_sheen(radiance, roughness, cloth, lobe):
    white = Material(sheen_color=(1.0, 1.0, 1.0), sheen_roughness=roughness, perceptual_roughness=0.6, **cloth)
    found = radiance(scene(sphere(segments=96), materials=[white], environment=constant()), CAMERA, SIZE, sheen=lobe)
    np.testing.assert_allclose(found[..., :3], 1, atol=2e-4)


@pytest.mark.parametrize("lobe", ["charlie", "zeltner"])
@pytest.mark.parametrize("roughness", [0.0, 1e-4, 0.1, 1.0])
def test_extremes_are_finite_and_no_roughness_is_no_sheen(radiance, roughness, lobe):
    light = {"environment": lopsided(), "lights": (Light.from_angles(2.9, 0.1, 3.0),)}
    plain = Material(metallic=0.0, base_color=(0.2, 0.1, 0.1, 1))
    cloth = Material(metallic=0.0, base_color=(0.2, 0.1, 0.1, 1), sheen_color=(1, 1, 1), sheen_roughness=roughness)
    found, bare = (radiance(scene(sphere(), materials=[m], **light), CAMERA, SIZE, sheen=lobe)
                   for m in (cloth, plain))
    assert found.min() >= 0
    if lobe == "charlie" or roughness in (0.0, 1.0):
        assert (np.abs(found - bare).max() < 1e-5) == (roughness == 0)


def test_the_base_has_no_say_in_what_the_fibres_reflect_of_the_environment(radiance):
    black = {"metallic": 0.0, "specular": 0.0, "base_color": (0.0, 0.0, 0.0, 1.0)}
    cloths = [Material(sheen_color=(1, 1, 1), sheen_roughness=0.5, diffuse_roughness=r, **black) for r in (0.0, 1.0)]
    even, rough = (radiance(scene(sphere(), materials=[m], environment=lopsided()), CAMERA, SIZE) for m in cloths)
    np.testing.assert_allclose(rough, even, atol=1e-5 * even.max())


def test_what_hides_light_of_the_base_hides_the_same_part_of_the_light_of_the_fibres(radiance):
    """However much more or less comes from where they look: the left half of the map hides four fifths."""
    hidden = Texture(image_of(np.repeat(np.uint8([[[51] * 3, [255] * 3]]), 8, axis=1)))
    cloth = Material(metallic=0.0, specular=0.0, base_color=(0.0, 0.0, 0.0, 1.0), sheen_color=(1, 1, 1),
                     sheen_roughness=0.5)
    plain, found = (radiance(scene(plate(), materials=[m], environment=lopsided()), orthographic(0.5, 0.4), (32, 32))
                    for m in (cloth, replace(cloth, occlusion_texture=hidden)))
    left, right = np.s_[12:20, 6:12, :3], np.s_[12:20, 20:26, :3]
    assert plain[left].min() > 0.01
    np.testing.assert_allclose(found[left], 0.2 * plain[left], rtol=5e-3)
    np.testing.assert_allclose(found[right], plain[right], rtol=5e-3)
