"""Clear coats in paths: energy with normals that differ, emission through the coat, and coats over glass."""

from __future__ import annotations

import numpy as np
import pytest
from images import image_of, noise
from pictures import picture
from shapes import constant, facing_floor, moved, orthographic, plate, scene, sphere

from viewer.bake.dfg import directional_albedo
from viewer.scene.camera import Camera
from viewer.scene.material import Material, Texture

BLACK = {"base_color": (0.0, 0.0, 0.0, 1.0), "metallic": 0.0, "specular": 0.0}
BUMPS = Texture(image_of((np.array([128, 128, 255]) + (noise(8, 8, 3, 5) / 6 - 21) * [1, 1, 0]).astype(np.uint8)))
GLASS = {"metallic": 0.0, "transmission": 1.0, "perceptual_roughness": 0.0}


@pytest.mark.parametrize("base", [{"metallic": 1.0, "perceptual_roughness": 0.3},
                                  {"metallic": 0.0, "perceptual_roughness": 0.8, "specular": 0.0}, GLASS], ids=str)
@pytest.mark.parametrize("roughness", [0.0, 0.4])
def test_white_stays_white_under_a_coat_with_bumps(tracer, base, roughness):
    """The furnace, seen under 45 degrees: no path is lost or gained where the normals of coat and base differ."""
    white = Material(clearcoat=1.0, clearcoat_roughness=roughness, clearcoat_normal_texture=BUMPS, double_sided=True,
                     **base)
    found = picture(tracer, scene(plate(), materials=[white], environment=constant()), orthographic(0.0, 0.8, 0.5),
                    (16, 16), spp=64)[..., :3]
    assert found.mean() == pytest.approx(1, abs=4e-3)


@pytest.mark.parametrize("roughness", [0.0, 0.7])
def test_emission_shines_through_what_the_coat_does_not_reflect(tracer, roughness):
    shining = Material(emissive=(1.0, 1.0, 1.0), clearcoat=0.8, clearcoat_roughness=roughness, **BLACK)
    for elevation in (0.2, 1.3):
        found = picture(tracer, scene(plate(), materials=[shining]), orthographic(0.0, elevation, 0.2), (4, 4), spp=1)
        albedo = 0.8 * directional_albedo("ggx", "smith", np.array([np.cos(elevation)]),
                                          max(roughness**2, 1e-4)) @ [0.04, 1.0]
        np.testing.assert_allclose(found[..., :3], 1 - albedo[0], atol=3e-3)


def test_a_coated_lamp_gives_the_same_light_hit_or_sampled(tracer):
    """A floor beside a shining plate, seen by BSDF samples alone and by light samples alone."""
    lamp = Material(emissive=(3.0, 3.0, 3.0), clearcoat=1.0, clearcoat_roughness=0.3, clearcoat_texture=Texture(
        image_of(noise(4, 4, 3, 2))), clearcoat_normal_texture=BUMPS, **BLACK)
    white = Material(metallic=0.0, specular=0.0)
    model = scene((plate(0), facing_floor()), (plate(1, 0.6), moved((0, 1.0, -0.5))), materials=[white, lamp])
    camera = orthographic(0.0, 1.2, 1.2)
    hit, sampled, both = (picture(tracer, model, camera, (12, 12), spp=128, sampling=way, bounces=1)[..., :3].mean()
                          for way in ("bsdf", "lights", "mis"))
    assert hit == pytest.approx(both, rel=0.015) and sampled == pytest.approx(both, rel=0.015)
    bare = scene((plate(0), facing_floor()), (plate(1, 0.6), moved((0, 1.0, -0.5))),
                 materials=[white, Material(emissive=(3.0, 3.0, 3.0), **BLACK)])
    assert picture(tracer, bare, camera, (12, 12), spp=64, bounces=1)[..., :3].mean() > 1.02 * both


@pytest.mark.parametrize("layer", [{}, {"clearcoat": 1.0}, {"sheen_color": (1.0, 1.0, 1.0), "sheen_roughness": 0.6}],
                         ids=str)
def test_a_solid_that_lets_light_through_has_coat_and_fibres_outside_alone(tracer, layer):
    """Seen from its inside, a black one shows half of what shines on it, with nothing in front of that."""
    wax = Material(thickness=1.0, diffuse_transmission=0.5, **BLACK, **layer)
    found = picture(tracer, scene(sphere(), materials=[wax], environment=constant()),
                    Camera.look_at((0, 0, 0), (0, 0, -1)), (8, 8), spp=64, bounces=1)[..., :3]
    assert found.mean() == pytest.approx(0.5, abs=3e-3)
