"""Clear coats in the raster: their own normal and roughness, and what they take from what lies below."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from images import image_of, noise
from shapes import constant, lopsided, orthographic, plate, scene, sphere

from viewer.bake.dfg import directional_albedo
from viewer.scene.light import Light
from viewer.scene.material import Material, Texture

CAMERA, SIZE = orthographic(0.5, 0.4, height=2.1), (48, 48)
LIGHT = {"environment": lopsided(), "lights": (Light.from_angles(0.4, 0.6, 3.0),)}
BLACK = {"base_color": (0.0, 0.0, 0.0, 1.0), "metallic": 0.0}
BUMPS = Texture(image_of((np.array([128, 128, 255]) + (noise(8, 8, 3, 5) / 3 - 42) * [1, 1, 0]).astype(np.uint8)))


@pytest.mark.parametrize("roughness", [0.1, 0.6])
def test_a_coat_over_black_is_a_black_dielectric(radiance, roughness):
    """Of the same roughness and normal map, under lights and an environment."""
    coat = Material(clearcoat=1.0, clearcoat_roughness=roughness, clearcoat_normal_texture=BUMPS, specular=0.0, **BLACK)
    glossy = Material(perceptual_roughness=roughness, normal_texture=BUMPS, **BLACK)
    found, expected = (radiance(scene(plate(), materials=[m], **LIGHT), CAMERA, SIZE) for m in (coat, glossy))
    np.testing.assert_allclose(found, expected, rtol=2e-3, atol=2e-3)
    assert expected[..., :3].max() > 0.05


@pytest.mark.parametrize("layer, antialias", [("normal", "deferred-4"), ("clearcoat_normal", "none")])
def test_what_steep_maps_reflect_grazes_the_surface(radiance, layer, antialias):
    """Slopes of 60 and 75 degrees look alike: the mirror direction would be below the plate, and is raised to it."""
    camera = orthographic(0.0, 0.0, height=1.0)
    shown = []
    for slope in np.radians([60, 75]):
        normal = np.array([np.sin(slope), 0, np.cos(slope)])
        texel = Texture(image_of(np.full((4, 4, 3), np.rint(127.5 + 127.5 * normal)).astype(np.uint8)))
        steep = Material(clearcoat=float(layer != "normal"), clearcoat_roughness=0.1, perceptual_roughness=0.1,
                         specular=float(layer == "normal"), **{f"{layer}_texture": texel}, **BLACK)
        shown.append(radiance(scene(plate(), materials=[steep], environment=lopsided()), camera, (8, 8),
                              background="none", antialias=antialias)[..., :3])
    np.testing.assert_allclose(shown[0], shown[1], rtol=5e-3)
    assert shown[0].min() > 0.01 and shown[0].max() < 0.2


def test_a_coat_does_not_follow_the_bumps_below(radiance):
    """Nor does what its highlight of a lamp is averaged over, whose mirror image the camera sees."""
    flat = Material(clearcoat=1.0, clearcoat_roughness=0.2, specular=0.0, **BLACK)
    bumpy = replace(flat, normal_texture=BUMPS)
    light = LIGHT | {"lights": (Light.from_angles(-0.5, -0.4, 3.0),)}
    found, expected = (radiance(scene(plate(), materials=[m], **light), CAMERA, SIZE) for m in (bumpy, flat))
    np.testing.assert_allclose(found, expected, rtol=1e-4, atol=1e-5)


@pytest.mark.parametrize("roughness", [0.0, 0.7])
def test_emission_shines_through_what_the_coat_does_not_reflect(radiance, roughness):
    shining = Material(emissive=(1.0, 0.5, 0.25), specular=0.0, clearcoat=0.8, clearcoat_roughness=roughness, **BLACK)
    for elevation in (0.2, 1.3):
        camera = orthographic(0.0, elevation, height=0.2)
        found = radiance(scene(plate(), materials=[shining]), camera, (4, 4), background="none")
        albedo = 0.8 * directional_albedo("ggx", "smith", np.array([np.cos(elevation)]),
                                          roughness ** 2) @ [0.04, 1.0]
        np.testing.assert_allclose(found[..., :3] / [1.0, 0.5, 0.25], 1 - albedo[0], atol=3e-3)


@pytest.mark.parametrize("coat", [0.0, 0.3, 1.0])
@pytest.mark.parametrize("base", [{"metallic": 1.0, "perceptual_roughness": 0.3},
                                  {"metallic": 0.0, "perceptual_roughness": 0.7},
                                  {"metallic": 0.0, "perceptual_roughness": 0.2, "transmission": 1.0}], ids=str)
def test_white_vanishes_under_a_coat(radiance, coat, base):
    """With bumps in one of the two layers, too; rough glass is white to half a percent without a coat."""
    white = Material(clearcoat=1.0, clearcoat_roughness=coat, **base)
    ball = sphere(segments=128)
    found = radiance(scene(ball, materials=[white], environment=constant()), CAMERA, SIZE)
    np.testing.assert_allclose(found[..., :3], 1, atol=6e-3 if base.get("transmission") else 2e-4)
    bumpy = replace(white, clearcoat_normal_texture=BUMPS)
    found = radiance(scene(plate(), materials=[bumpy], environment=constant()), CAMERA, SIZE)
    np.testing.assert_allclose(found[..., :3], 1, atol=6e-3 if base.get("transmission") else 2e-4)


def test_every_map_at_once_is_drawn(radiance):
    """More maps than there are samplers: some are left out, and the picture is made."""
    image = Texture(image_of(noise(8, 8, 4, 1)))
    names = [name for name in Material.__dataclass_fields__ if name.endswith("_texture")]
    material = Material(metallic=0.5, emissive=(0.1, 0.1, 0.1), clearcoat=1.0, clearcoat_roughness=0.5,
                        anisotropy_strength=0.5, transmission=0.5, thickness=0.2, **dict.fromkeys(names, image))
    found = radiance(scene(plate(), materials=[material], **LIGHT), CAMERA, SIZE, environment_shadows="64")
    assert found[..., :3].max() > 0.05
