"""Punctual lights on a plate, against the formulas worked out in float64."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from shapes import WHITE, facing_floor, orthographic, plate, scene, seen_plane, sphere

from viewer.bake.dfg import directional_albedo
from viewer.scene.camera import Camera
from viewer.scene.light import Light
from viewer.scene.material import Material

SIZE = (24, 24)


def lit(light: Light, material: Material = WHITE):
    return scene(plate(half=4.0), materials=[material], lights=(light,))


def test_pi_lux_on_white_is_radiance_one(radiance):
    light = Light("directional", intensity=np.pi, direction=(0, 0, -1))
    for mode in ("pbr", "phong"):
        picture = radiance(lit(light), orthographic(), mode=mode, shadows="off")
        assert np.abs(picture - 1).max() < 1e-5
    # What a smooth interface reflects does not reach the base, nor leave it: (1 - 0.04)^2, over the mean of 1 - F.
    smooth = replace(WHITE, specular=1.0, perceptual_roughness=0.0)
    picture = radiance(lit(light, smooth), orthographic(), lobes="uniform-diffuse", shadows="off")
    assert np.abs(picture[..., :3] - 0.96**2 / (1 - 0.04 - 0.96 / 21)).max() < 1e-3


@pytest.mark.parametrize("elevation", [0.0, 0.7, 1.3, 1.55])
def test_cosine_law(radiance, elevation):
    light = Light.from_angles(0.0, elevation, 2.0)
    for mode in ("pbr", "phong"):
        picture = radiance(lit(light), orthographic(0.5, 0.3), mode=mode, shadows="off")
        assert np.abs(picture[..., :3] - 2 / np.pi * np.cos(elevation)).max() < 1e-5
    behind = Light.from_angles(np.pi, elevation, 2.0)
    assert radiance(lit(behind), orthographic(0.5, 0.3), shadows="off")[..., :3].max() < 1e-6


def cook_torrance(wo, wi, material: Material) -> np.ndarray:
    """Coupled base + D V F and D V F, by the textbook forms (Walter 2007; Heitz 2014; Kelemen & Szirmay-Kalos 2001)."""
    n = np.array([0.0, 0.0, 1.0])
    h = (wo + wi) / np.linalg.norm(wo + wi)
    alpha = material.perceptual_roughness**2
    base = np.array(material.base_color[:3])
    d = alpha**2 / (np.pi * ((n @ h) ** 2 * (alpha**2 - 1) + 1) ** 2)

    def smith_lambda(w):
        return (np.sqrt(1 + alpha**2 * (1 / (n @ w) ** 2 - 1)) - 1) / 2

    dv = d / (1 + smith_lambda(wo) + smith_lambda(wi)) / (4 * (n @ wo) * (n @ wi))
    f0 = np.minimum(((material.ior - 1) / (material.ior + 1)) ** 2 * np.array(material.specular_color), 1)
    f = material.specular * (f0 + (1 - f0) * (1 - wo @ h) ** 5)

    def through(mu):
        """1 - E of the interface, the largest channel, (N,)."""
        return 1 - directional_albedo("ggx", "smith", mu, alpha, 64) @ [f0.max() * material.specular, material.specular]

    x, weight = np.polynomial.legendre.leggauss(32)
    mean = weight * (x + 1) / 2 @ through((x + 1) / 2)
    dielectric = through(np.array([n @ wo, n @ wi])).prod() / mean * base / np.pi + dv * f
    metal = dv * (base + (1 - base) * (1 - wo @ h) ** 5)
    return (1 - material.metallic) * dielectric + material.metallic * metal


MATERIALS = {
    "rough plastic": Material(base_color=(0.8, 0.3, 0.1, 1), metallic=0.0, perceptual_roughness=0.9),
    "smooth plastic": Material(base_color=(0.2, 0.3, 0.9, 1), metallic=0.0, perceptual_roughness=0.2),
    "gold": Material(base_color=(1.0, 0.77, 0.34, 1), metallic=1.0, perceptual_roughness=0.4),
    "half metal": Material(base_color=(0.5, 0.6, 0.7, 1), metallic=0.5, perceptual_roughness=0.6),
    "diamond": Material(base_color=(0.1, 0.1, 0.1, 1), metallic=0.0, perceptual_roughness=0.5, ior=2.4),
    "tinted": Material(metallic=0.0, perceptual_roughness=0.3, specular=0.7, specular_color=(1, 0.2, 0.5)),
}


@pytest.mark.parametrize("name", MATERIALS)
@pytest.mark.parametrize(("azimuth", "elevation"), [(0.1, 0.1), (1.2, 0.4), (-0.6, 1.1), (-1.5, 0.05)])
def test_the_whole_brdf(radiance, name, azimuth, elevation):
    light, camera = Light.from_angles(azimuth, elevation, 3.0), orthographic(0.7, 0.2)
    expected = 3 * -light.direction[2] * cook_torrance(-camera.forward, -np.array(light.direction), MATERIALS[name])
    picture = radiance(lit(light, MATERIALS[name]), camera, shadows="off", multiscatter="off")
    assert np.abs(picture[..., :3] / expected - 1).max() < 2e-4


def distances(camera: Camera, position) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """From the points seen on the plate: distance to the light, NoL, direction from the light."""
    to_light = np.array(position) - seen_plane(camera, SIZE)
    d = np.linalg.norm(to_light, axis=-1)
    return d, to_light[..., 2] / d, -to_light / d[..., None]


@pytest.mark.parametrize("mode", ["pbr", "phong"])
def test_point_light(radiance, mode):
    """I NoL / (pi d^2), with color, and windowed by range."""
    camera, position = orthographic(0.3, 0.2, height=3.0), (0.4, -0.3, 0.7)
    d, NoL, _ = distances(camera, position)
    for reach in (None, 1.5):
        light = Light("point", (1.0, 0.5, 0.25), 5.0, position, range=reach)
        window = np.clip(1 - (d / reach) ** 4, 0, 1) if reach else 1.0
        expected = (5 / np.pi * NoL / d**2 * window)[..., None] * light.color
        picture = radiance(lit(light), camera, SIZE, mode=mode, shadows="off")[..., :3]
        assert np.abs(picture - expected).max() < 1e-4 * expected.max()
        assert (picture == 0).any() == (reach is not None)


@pytest.mark.parametrize("mode", ["pbr", "phong"])
def test_spot_light(radiance, mode):
    camera, position = orthographic(height=3.0), (0.3, 0.2, 1.5)
    axis = np.array([-0.2, 0.1, -1.0]) / np.linalg.norm([-0.2, 0.1, -1.0])
    light = Light("spot", intensity=4.0, position=position, direction=tuple(axis), inner_cone=0.3, outer_cone=0.6)
    d, NoL, away = distances(camera, position)
    cone = np.clip((away @ axis - np.cos(0.6)) / (np.cos(0.3) - np.cos(0.6)), 0, 1) ** 2
    picture = radiance(lit(light), camera, SIZE, mode=mode, shadows="off")[..., 0]
    assert np.abs(picture - 4 / np.pi * NoL / d**2 * cone).max() < 1e-3 * picture.max()
    assert (picture == 0).any() and (cone == 1).any()


def test_lights_add_up(radiance):
    """All kinds together, in any order, give what they give alone."""
    lights = [Light("spot", (1, 0, 0), 6.0, (0.5, 0, 2), (0, 0, -1)), Light("point", (0, 1, 0), 2.0, (-1, 1, 1)),
              Light.from_angles(0.4, 0.4, 1.0), Light("point", (0, 0, 1), 3.0, (1, 1, 1)),
              Light.from_angles(-1.0, 0.2, 2.0)]
    rough = Material(metallic=0.3, perceptual_roughness=0.5)
    alone = sum(radiance(lit(light, rough), orthographic(), SIZE)[..., :3] for light in lights)
    together = scene(plate(half=4.0), materials=[rough], lights=tuple(lights))
    turned = replace(together, lights=tuple(reversed(lights)))
    for each in (together, turned):
        assert np.abs(radiance(each, orthographic(), SIZE)[..., :3] - alone).max() < 1e-5 * alone.max()


@pytest.mark.parametrize("elevation", [0.0, 0.8, 1.3])
def test_a_mirror_shows_a_sun_no_brighter_than_it_is(radiance, elevation):
    radius = 0.05
    sun = Light.from_angles(0.0, elevation, np.pi * radius**2)  # of radiance 1
    mirror = Material(metallic=1.0, perceptual_roughness=0.0)
    for size, least, most in ((radius, 0.99, 1.001), (0.0, 100.0, 1e9)):
        seen = radiance(lit(replace(sun, angular_radius=size), mirror), orthographic(0.0, -elevation), shadows="off")
        assert least < seen[..., 1].min() <= seen[..., 1].max() < most


@pytest.mark.parametrize("coat", [0.0, 1.0])
def test_highlights_finer_than_a_pixel_keep_their_light(radiance, coat):
    """On a ball of 12 pixels, beside the same with 16 x 16 as many: most of its highlight lies between the points that
    are shaded."""
    shiny = Material(base_color=(0, 0, 0, 1), perceptual_roughness=0.15, metallic=0.0, clearcoat=coat,
                     clearcoat_roughness=0.1, specular=1.0 - coat)
    ball = scene(sphere(), materials=[shiny], lights=(Light.from_angles(0.4, 0.3, 1.0),))
    camera = orthographic(height=2.3)
    fine, coarse = (radiance(ball, camera, (size, size), shadows="off")[..., 1] for size in (224, 14))
    blocks = fine.reshape(14, 16, 14, 16).mean(axis=(1, 3))
    assert coarse.sum() == pytest.approx(blocks.sum(), rel=0.15)  # by D at the points alone, 3 % and 13 % of it
    assert np.abs(coarse - blocks).max() < 0.6 * blocks.max()


def test_highlights_reach_the_horizon(radiance):
    """Where a floor ends, pixels above it only help with derivatives: those past its horizon have no place on it."""
    floor = scene((plate(), facing_floor(20.0, 0.0)), materials=[Material(metallic=1.0, perceptual_roughness=0.25)],
                  lights=(Light("directional", intensity=3.0, direction=(0, -0.12, 1)),))
    camera = Camera.look_at((0, 0.15, 3), (0, 0, -2), fov_y=0.6)
    coarse = radiance(floor, camera, (64, 64), antialias="msaa-4", background="none", shadows="off")
    fine = radiance(floor, camera, (512, 512), background="none", shadows="off").reshape(64, 8, 64, 8, 4)
    last = np.flatnonzero(coarse[..., 3].any(axis=1))[0]
    shown, expected = coarse[last].sum(axis=0), fine[last].sum(axis=(0, 1, 2))
    assert shown[1] / shown[3] == pytest.approx(expected[1] / expected[3], rel=0.2)  # of what is covered
