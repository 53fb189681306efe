"""Scenes with little or nothing in them, and numbers at the ends of their ranges: a picture, and every pixel finite."""

from __future__ import annotations

from dataclasses import replace
from itertools import product

import numpy as np
import pytest
from images import image_of
from little_scenes import NOTHING_MUCH, framing
from shapes import constant, facing_floor, lopsided, moved, orthographic, plate, scene, sphere

from viewer.errors import UsageError
from viewer.scene.camera import Camera
from viewer.scene.light import Light
from viewer.scene.material import Material, Texture, UVTransform
from viewer.settings import Settings

SIZE = (24, 24)


@pytest.mark.parametrize("name", NOTHING_MUCH)
@pytest.mark.parametrize("mode", ["pbr", "phong"])
def test_little_or_nothing(radiance, name, mode):
    lights = (Light.from_angles(0.2, 0.5, 2.0), Light("point", intensity=1.0, position=(1, 1, 1)))
    for environment in (None, constant(0.5)):
        model = replace(NOTHING_MUCH[name], environment=environment, lights=lights)
        picture = radiance(model, framing(model), SIZE, mode=mode, antialias="msaa-4")
        corners = picture[[0, 0, -1, -1], [0, -1, 0, -1]]
        assert np.abs(corners - ([0, 0, 0, 0] if environment is None else [0.5, 0.5, 0.5, 1])).max() < 1e-6


def test_a_single_point_is_seen(radiance):
    model = replace(NOTHING_MUCH["a single point"], materials=(Material(base_color=(1, 0.5, 0, 1)),))
    picture = radiance(model, framing(model), (25, 25), background="none")
    assert picture[12, 12].tolist() == [1, 0.5, 0, 1]
    assert (picture[..., 3] > 0).sum() == 1


ROUGHNESS, F0 = (0.0, 1e-4, 0.5, 1.0), ({"ior": 1.0}, {"ior": 1.0001}, {"ior": 0.0}, {"specular": 0.0}, {"ior": 1e4})
LIGHTS = (Light("directional", intensity=1e12, direction=(-1, -1e-5, 0)), Light.from_angles(0.1, 1e-3, 1e12),
          Light("point", intensity=1e12, position=(0, 0, 1.0)), Light("point", intensity=1.0, position=(0, 0, 0)),
          Light("spot", intensity=1e12, position=(0, 0, 1.0000001), direction=(0, 0, -1), outer_cone=1e-5),
          Light("directional", intensity=1e-30))


@pytest.mark.parametrize("mode", ["pbr", "phong"])
def test_light_from_straight_behind_a_bent_normal(radiance, mode):
    """The half vector of light that comes towards the eye is 0, and a normal map may turn such a surface to it."""
    bent = Texture(image_of(np.full((4, 4, 3), (128, 200, 20), np.uint8)))
    model = scene(plate(), materials=[Material(perceptual_roughness=0.5, normal_texture=bent)],
                  lights=(Light("directional", intensity=1.0, direction=(0, 0, 1)),))
    picture = radiance(model, orthographic(), SIZE, mode=mode, phong="blinn-phong", shadows="off")
    assert picture[..., :3].max() < 1


@pytest.mark.parametrize("ndf", ["ggx", "beckmann", "blinn-phong"])
@pytest.mark.parametrize("fresnel", ["schlick", "exact"])
@pytest.mark.parametrize("masking", ["smith", "v-cavity", "none"])
def test_extreme_materials_under_extreme_lights(radiance, ndf, fresnel, masking):
    """Balls for every corner of the parameters, from grazing to facing; radiance is finite and not negative. Each
    distribution and each masking is seen under an environment, for which it takes seconds to bake both together."""
    cases = list(product(ROUGHNESS, (0.0, 1.0), (0.0, 1.0)))[:16]
    materials = [Material(base_color=(base,) * 3 + (1.0,), metallic=metallic, perceptual_roughness=roughness,
                          **F0[k % len(F0)]) for k, (roughness, metallic, base) in enumerate(cases)]
    balls = [(sphere(k, 12), moved((2 * (k % 4) - 3, 2 * (k // 4) - 3, 0))) for k in range(len(cases))]
    environment = lopsided() if ndf == "ggx" or masking == "smith" else None
    model = scene(*balls, materials=materials, lights=LIGHTS, environment=environment)
    picture = radiance(model, orthographic(0.0, 0.0, 8.0, 20.0), (48, 48), ndf=ndf, fresnel=fresnel, masking=masking,
                       shadows="off")
    assert picture.min() >= 0


def test_every_f0_with_every_roughness(radiance):
    cases = list(product(ROUGHNESS, F0))
    materials = [Material(metallic=0.0, perceptual_roughness=roughness, **f0) for roughness, f0 in cases]
    balls = [(sphere(k, 12), moved((2 * (k % 5) - 4, 2 * (k // 5) - 3, 0))) for k in range(len(cases))]
    model = scene(*balls, materials=materials, lights=LIGHTS[:3], environment=lopsided())
    for mode in ("pbr", "phong"):
        assert radiance(model, orthographic(0.0, 0.0, 10.0, 20.0), (50, 50), mode=mode, shadows="off").min() >= 0


@pytest.mark.parametrize("exposure", [-20.0, 0.0, 20.0])
@pytest.mark.parametrize("tonemap", ["neutral", "agx", "aces", "none"])
def test_what_is_displayed_of_it(renderer, exposure, tonemap):
    """Half floats and samples averaged: 1e12 lux ends at white, 20 stops down nothing wraps round."""
    model = scene((plate(), facing_floor()), lights=(Light("directional", intensity=1e12, direction=(0, -1, 0)),),
                  materials=[Material(metallic=0.0)])
    shown = renderer.display(model, orthographic(0.0, 1.0, 1.0), Settings.of(
        exposure=exposure, tonemap=tonemap, antialias="msaa-4", shadows="off"), SIZE).srgb
    assert (shown[..., 3] == 255).all()
    assert np.ptp(shown[..., :3].astype(int)) <= 4  # dithering, and AgX' tints
    if exposure >= 0:
        assert shown[..., :3].min() > 245
    if exposure == -20 and tonemap == "none":
        assert 65 <= shown[..., :3].min() <= shown[..., :3].max() <= 72  # 65504 / 2**20 = 0.0625


def test_grazing_to_the_last_pixel(radiance):
    """A floor that runs to the horizon."""
    model = scene((plate(half=1000.0), facing_floor()), materials=[Material(perceptual_roughness=0.2)],
                  lights=(Light.from_angles(np.pi, 0.01, 3.0),), environment=lopsided())
    for mode in ("pbr", "phong"):
        radiance(model, Camera.look_at((0, 1e-3, 5), (0, 1e-3, 0)), SIZE, mode=mode)


@pytest.mark.parametrize("mode", ["pbr", "phong"])
def test_light_beyond_float32_leaves_room_for_highlights(radiance, mode):
    materials = [Material(metallic=1.0, perceptual_roughness=roughness) for roughness in (0.0, 0.5)]
    lights = Light("directional", intensity=1e200), Light("point", intensity=1e200, position=(0, 0, 1))
    for material in materials:
        radiance(scene(sphere(), materials=[material], lights=lights), orthographic(), SIZE, mode=mode, shadows="off")


@pytest.mark.parametrize("transform", [{"offset": (1e300, -1e300)}, {"scale": (1e300, 1e300)}, {"scale": (0.0, 1e-300)},
                                       {"rotation": 1e300}], ids=str)
def test_transforms_of_textures_beyond_float32(radiance, transform):
    texture = Texture(image_of(np.arange(48, dtype=np.uint8).reshape(4, 4, 3)), transform=UVTransform(**transform))
    radiance(scene(plate(), materials=[Material(base_color_texture=texture)], environment=constant()), orthographic(),
             SIZE)


@pytest.mark.parametrize("name", ["normal", "clearcoat_normal"])
def test_the_largest_scale_of_a_normal_map(radiance, name):
    """A normal that is scaled by 1e9 lies in the surface, and no larger one is taken."""
    texture = Texture(image_of(np.full((4, 4, 3), (128, 200, 220), np.uint8)))
    material = Material(clearcoat=1.0, **{f"{name}_texture": texture, f"{name}_scale": 1e9})
    radiance(scene(plate(), materials=[material], environment=constant()), orthographic(), SIZE)
    with pytest.raises(UsageError, match=r"_scale is 1e\+300, not from -1e\+09 to 1e\+09"):
        Material(**{f"{name}_scale": 1e300})


@pytest.mark.parametrize("reach", [1e-300, 1e-30, 1e38, 1e300])
def test_the_shortest_and_the_longest_range_of_a_light(radiance, reach):
    light = Light("point", intensity=10.0, position=(0, 0, 1.0), range=reach)
    picture = radiance(scene(plate(), materials=[Material(metallic=0.0)], lights=(light,)), orthographic(), SIZE)
    assert (picture[..., :3].max() > 0) == (reach > 1)
