"""Fog in the raster, where it can be worked out on paper or by quadrature."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from fog_truth import optical_depth, rays, single_scattering
from images import image_of, noise
from shapes import WHITE, constant, facing_floor, moved, orthographic, plate, scene, sphere

from viewer.bake.many_lights import uniform_lights
from viewer.raster.media_light import MediaLight
from viewer.scene.camera import Camera
from viewer.scene.color import srgb_to_linear
from viewer.scene.fog import REACH, fog_of
from viewer.scene.light import Light
from viewer.scene.material import Material, Texture
from viewer.settings import Settings

BLACK = replace(WHITE, base_color=(0, 0, 0, 1))
GREY = replace(BLACK, base_color=(0.5, 0.5, 0.5, 1.0))
GLOWING = replace(BLACK, emissive=(4.0, 1.0, 0.5))
FINE = {"media_steps": "224", "media_rays": "all"}
SIZE = (16, 16)
FEW = (8, 8)
"""Where each pixel takes a quadrature in two dimensions."""


def perspective(distance: float, target=(0, 0, 0)) -> Camera:
    return Camera.orbit(target, distance, 0.3, 0.2)


@pytest.mark.parametrize("fog", [1e-6, 0.3, 3.0, 1e18])
@pytest.mark.parametrize("g", [0.0, 0.7, -0.4])
def test_a_white_furnace_stays_white(radiance, fog, g):
    """Fog and a surface that absorb nothing, under light from everywhere, seen from inside, outside and without
    perspective: one bake of the light in the fog serves all three."""
    model = scene(sphere(segments=24), environment=constant())
    for camera in (perspective(2.8), perspective(9.0), orthographic(height=3.0)):
        found = radiance(model, camera, SIZE, fog=fog, fog_g=g)
        assert np.abs(found[..., :3] - 1).max() < 0.01, camera


@pytest.mark.parametrize("camera", [perspective(2.8), orthographic(azimuth=0.4, height=2.0)],
                         ids=["perspective", "orthographic"])
@pytest.mark.parametrize("height", [0.0, 0.4])
@pytest.mark.parametrize("sigma", [1e-3, 0.5, 4.0])
def test_light_is_lost_on_the_way_to_the_eye(radiance, camera, height, sigma):
    """exp(-optical depth) of what glows, by quadrature along each ray."""
    model = scene(plate(half=3.0), materials=[GLOWING])
    found = radiance(model, camera, SIZE, fog=sigma, fog_albedo=(0, 0, 0), fog_height=height, **FINE)
    fog = fog_of(model, Settings.of(fog=sigma, fog_height=height))
    start, direction = rays(camera)
    distance = -start[..., 2] / direction[..., 2]
    expected = np.exp(-optical_depth(fog, start, direction, distance))
    lit = found[..., 3] == 1
    assert lit.any()
    assert found[..., 0][lit] == pytest.approx(4 * expected[lit], rel=2e-3, abs=4e-3 if height else 1e-6)


@pytest.mark.parametrize("height", [0.0, 0.5])
@pytest.mark.parametrize("camera", [perspective(2.8, (0, 0.6, 0)), orthographic(azimuth=0.4, height=2.0)],
                         ids=["perspective", "orthographic"])
def test_light_scattered_once(radiance, camera, height):
    """By quadrature, of a red sun and of a green lamp, whose light passes the camera, and is near in one case."""
    lights = (Light("directional", (1, 0, 0), 3.0, direction=(0, -0.6, -0.8)),
              Light("point", (0, 1, 0), 2.0, position=(0.4, 0.5, 0.3)))
    model = scene((sphere(segments=8), moved((0, -0.9, 0), 0.1)), (sphere(segments=8), moved((0, 0.9, 0), 0.1)),
                  materials=[BLACK], lights=lights)
    settings = {"fog": 0.35, "fog_g": 0.5, "fog_albedo": (0.8, 0.8, 0.8), "fog_height": height}
    found = radiance(model, camera, FEW, shadows="off", media_scattering="single", **FINE, **settings)
    fog = fog_of(model, Settings.of(**settings))
    start, direction = rays(camera, FEW)
    free = found[..., 3] < 1
    assert free.sum() > 40
    for channel, light in enumerate(lights):
        expected = single_scattering(fog, light, start, direction, 30.0)
        assert found[..., channel][free] == pytest.approx(expected[free], rel=0.02)


def test_shafts_of_shadow(radiance):
    """A plate hides a sun from all that lies straight behind it."""
    sun = Light("directional", intensity=3.0, direction=(0, -1, 0))
    lid = np.eye(4)[[0, 2, 1, 3]]
    model = scene((plate(half=0.5), moved((0, 1, 0)) @ lid), (plate(half=0.5), moved((0, -1, 0)) @ lid),
                  materials=[replace(BLACK, double_sided=True)], lights=(sun,))
    camera = Camera.orbit((0, 0, 0), 3.0, 0.0, 0.0)
    settings = {"fog": 0.3}
    fog = fog_of(model, Settings.of(**settings))
    start, direction = rays(camera, FEW)

    def blocked(points):
        return (np.abs(points[..., 0]) < 0.5) & (np.abs(points[..., 2]) < 0.5) & (points[..., 1] < 1)

    found = radiance(model, camera, FEW, media_scattering="single", **FINE, **settings)
    lit = single_scattering(fog, sun, start, direction, 20.0)
    expected = single_scattering(fog, sun, start, direction, 20.0, blocked)
    free = found[..., 3] < 1
    assert (expected < 0.95 * lit)[free].sum() > 10
    assert found[..., 0][free] == pytest.approx(expected[free], rel=0.03)


PANES = {"thin": Material(metallic=0.0, transmission=1.0, perceptual_roughness=0.0, specular=0.0),
         "solid": Material(metallic=0.0, transmission=1.0, perceptual_roughness=0.0, specular=0.0, thickness=0.01,
                           ior=1.0),
         "blend": Material(metallic=0.0, base_color=(1, 1, 1, 0.0), alpha_mode="blend", specular=0.0)}


@pytest.mark.parametrize("background", ["env", "none"])
def test_clear_panes_in_fog_are_not_seen(radiance, background):
    """Light that a pane lets through is neither lost nor doubled by the fog before and behind it."""
    lamp = Light("point", intensity=1.0, position=(0.5, 0.5, 2.0), casts_shadow=False)
    model = scene((plate(0, half=0.7), moved((0, 0, -1))), (plate(1, half=0.5), moved((0.5, 0, 0.5))),
                  materials=[GLOWING, Material(alpha_mode="mask", base_color=(0, 0, 0, 0))], lights=(lamp,),
                  environment=constant(0.3))
    camera = Camera.orbit((0, 0, 0), 3.5, 0.0, 0.0)
    settings = {"fog": 0.4, "background": background}
    without = radiance(model, camera, SIZE, **settings)[..., :3]
    for name, glass in PANES.items():
        found = radiance(replace(model, materials=(GLOWING, glass)), camera, SIZE, **settings)[..., :3]
        assert found == pytest.approx(without, abs=0.01), name


def test_a_blended_surface_lies_in_its_own_fog(radiance):
    """Half of it, seen through the fog before it, over half of what is seen without it."""
    glow = replace(GLOWING, base_color=(0, 0, 0, 0.5), alpha_mode="blend")
    camera = orthographic(height=0.5)
    settings = {"fog": 0.5, "fog_albedo": (0, 0, 0)}
    model = scene((plate(0), moved((0, 0, -1))), (plate(1), moved((0, 0, 1))), materials=[GLOWING, glow])
    [found] = radiance(model, camera, (1, 1), **settings)[0]
    far = REACH * model.radius  # the ball starts that far before the middle
    near, behind = np.exp(-0.5 * (far - 1)), np.exp(-0.5 * (far + 1))
    assert found[:3] == pytest.approx(np.array([4, 1, 0.5]) * (near + behind) / 2, rel=2e-3)


def test_the_scale_of_the_scene_does_not_matter(radiance):
    def picture(scale: float) -> np.ndarray:
        lamp = Light("point", intensity=2.0 * scale**2, position=(0.8 * scale, 0.5 * scale, 0.9 * scale))
        model = scene((sphere(segments=24), moved((0, 0, 0), scale)), lights=(lamp,), environment=constant(0.2))
        return radiance(model, perspective(2.8 * scale), SIZE, fog=0.4 / scale, fog_height=0.7 * scale, fog_g=0.3)

    expected = picture(1.0)
    for scale in (1e-6, 1e6):
        assert picture(scale) == pytest.approx(expected, rel=1e-3, abs=1e-4), scale


@pytest.mark.parametrize("settings", [
    {"fog": 1e18}, {"fog": 1e-18}, {"fog": 1e6, "fog_g": 0.99, "fog_albedo": (1, 0.5, 0)},
    {"fog": 1.0, "fog_height": 1e-12}, {"fog": 1.0, "fog_height": 1e18}, {"fog": 5.0, "mode": "phong"},
], ids=str)
def test_extremes_stay_finite(radiance, settings):
    """From the middle, from far away and without perspective."""
    lamps = (Light("point", intensity=2.0, position=(0, 0, 0)), Light("spot", intensity=2.0, position=(0, 2, 0)),
             Light("directional", intensity=3.0, direction=(0, -1, 0)))
    model = scene(sphere(segments=12), lights=lamps, environment=constant(0.2))
    for camera in (perspective(1e-3), perspective(1e4), orthographic(distance=1e-9)):
        assert (radiance(model, camera, SIZE, **settings) >= 0).all(), camera


def test_more_scattering_adds_light(radiance):
    sun = Light("directional", intensity=3.0, direction=(0, -1, 0))
    model = scene((sphere(segments=12), moved((0, 0, 0), 0.2)), lights=(sun,))
    once, often = (radiance(model, perspective(3.0), SIZE, fog=1.0, media_scattering=choice)[..., :3].mean()
                   for choice in ("single", "multiple"))
    assert often > 1.3 * once


def test_meshes_hide_the_sky_from_fog(radiance):
    """Thin fog between two wide black lids sees the sky at the sides only. What it scatters once is an integral over
    the ray of the share of the sphere between the lids, by quadrature; they hide an eighth of it."""
    lid = np.eye(4)[[0, 2, 1, 3]]
    model = scene(*((plate(half=2.0), moved((0, y, 0)) @ lid) for y in (-0.5, 0.5)),
                  materials=[replace(BLACK, double_sided=True)], environment=constant())
    camera = orthographic(0.0, 0.0, height=0.1)
    found = radiance(model, camera, (4, 4), fog=1e-3, media_scattering="single", background="none", **FINE)
    fog = fog_of(model, Settings.of(fog=1e-3))
    z = np.linspace(-fog.radius, fog.radius, 400)
    rng = np.random.default_rng(1)
    d = rng.normal(size=(4000, 3))
    d /= np.linalg.norm(d, axis=1, keepdims=True)
    seen = np.ones((len(z), len(d)), bool)
    for y in (-0.5, 0.5):
        t = y / d[:, 1]
        hits = (t > 0) & (np.abs(t * d[:, 0]) < 2) & (np.abs(z[:, None] + t * d[:, 2]) < 2)
        seen &= ~hits
    expected = 1e-3 * np.trapezoid(seen.mean(axis=1), z)
    assert expected < 0.9 * 1e-3 * 2 * fog.radius
    assert found[..., :3].mean() == pytest.approx(expected, rel=0.05)


LAMP = Light("point", intensity=3.0, position=(0.2, 0.8, 0.1))
SUN = Light("directional", intensity=3.0, direction=(0, -1, 0))


@pytest.mark.parametrize("lights, sigma", [((LAMP,), 1e-3), ((LAMP, SUN), 1e-3), ((LAMP,), 0.15)],
                         ids=["lamp", "lamp and sun", "lamp in dense fog"])
def test_a_lit_floor_lights_fog(radiance, lights, sigma):
    """What a grey floor reflects of lights, scattered once in a row of pixels above it, by quadrature over the floor.
    A black floor sends nothing; its picture is that of the lights themselves in the fog."""
    camera = replace(orthographic(height=0.02), pose=moved((0, 0.3, 5)))
    grey, black = (radiance(scene((plate(), facing_floor()), materials=[material], lights=lights), camera, (1, 1),
                            fog=sigma, media_scattering="single", background="none", **FINE)[0, 0, :3]
                   for material in (GREY, BLACK))
    side = (np.arange(40) + 0.5) / 20 - 1
    floor = np.stack(np.meshgrid(side, [0.0], side, indexing="ij"), axis=-1).reshape(-1, 3)
    to_lamp = LAMP.position - floor
    distance = np.linalg.norm(to_lamp, axis=1)
    irradiance = 3.0 * (to_lamp[:, 1] / distance**3 * np.exp(-sigma * distance) + (SUN in lights))
    end = REACH * np.sqrt(2)  # of the fog, on both sides
    z = np.linspace(-end, end, 200)
    away = np.stack([0 * z, 0 * z + 0.3, z], axis=-1)[:, None] - floor
    way = np.linalg.norm(away, axis=-1)
    solid_angles = away[..., 1] / way**3 * 4 / len(floor)
    sent = (0.5 / np.pi * irradiance * solid_angles * np.exp(-sigma * way)).sum(axis=1) / (4 * np.pi)
    expected = sigma * np.trapezoid(sent * np.exp(-sigma * (end - z)), z)
    assert grey - black == pytest.approx(np.full(3, expected), rel=0.05)


def test_no_light_off_a_floor_comes_through_a_ceiling(radiance):
    """A lamp is between both. The fog far above the ceiling is looked at from the side, past all surfaces."""
    camera = replace(orthographic(height=0.02), pose=moved((0, 3.0, 5)))
    floor, ceiling = ((plate(half=2.0), facing_floor(y=y)) for y in (-0.5, 1.0))

    def sent(*meshes) -> float:
        grey, black = (radiance(scene(*meshes, materials=[replace(material, double_sided=True)], lights=(LAMP,)),
                                camera, (1, 1), fog=1e-3, media_scattering="single", background="none",
                                **FINE)[0, 0, 0] for material in (GREY, BLACK))
        return grey - black

    assert sent(floor, ceiling) < 0.05 * sent(floor)


def test_the_strongest_lamp_lights_fog_as_others_do(radiance):
    """In proportion to its light, also where fog scatters that again, close to the lamp."""
    weak, strong = (radiance(scene((plate(half=2.0), facing_floor()), lights=(replace(LAMP, intensity=intensity),)),
                             perspective(5.0, (0, 0.5, 0)), SIZE, fog=0.35, background="none")[..., :3]
                    for intensity in (1.0, 1e30))
    assert strong / 1e30 == pytest.approx(weak, rel=1e-3)


def test_meshes_send_light_by_the_means_of_their_textures(radiance):
    """Fog between two lids, which are not in the picture: a textured one sends as much as one of its mean colour."""
    texels = noise(16, 16, 3, 1) // np.uint8([1, 2, 8])
    mean = srgb_to_linear(texels / 255).mean(axis=(0, 1))
    lid = np.eye(4)[[0, 2, 1, 3]]
    kinds = (replace(BLACK, double_sided=True, base_color=(1, 1, 1, 1), base_color_texture=Texture(image_of(texels))),
             replace(BLACK, double_sided=True, base_color=(*mean, 1)))
    textured, plain = (radiance(
        scene(*((plate(half=2.0), moved((0, y, 0)) @ lid) for y in (-0.5, 0.5)), materials=[kind],
              environment=constant()), orthographic(0.0, 0.0, height=0.1), (4, 4), fog=0.5, background="none")
        for kind in kinds)
    assert textured == pytest.approx(plain, rel=1e-3)
    assert plain[..., 2].mean() < 0.99 * plain[..., 0].mean()


@pytest.mark.parametrize("albedo", [1.0, 0.0])
def test_light_arrives_in_the_middle_of_fog_from_more_sides(radiance, monkeypatch, albedo):
    """White fog in uniform light changes nothing, and black fog of this optical depth leaves a share of it."""
    baked, bake = [], MediaLight.bake
    monkeypatch.setattr(MediaLight, "bake", lambda light, *how: (bake(light, *how), baked.append(light)))
    model = scene(sphere(segments=8), environment=constant())
    sigma = 0.25 / model.radius
    radiance(model, perspective(3.0), FEW, fog=sigma, fog_albedo=(albedo,) * 3)
    sky = uniform_lights(64, (1.0, 2.0, 3.0))
    [light] = baked
    found = light.arriving(sky).irradiance / sky.solid_angles[:, None]
    share = np.exp(-sigma * fog_of(model, Settings.of(fog=sigma)).radius)
    assert found == pytest.approx(np.broadcast_to(share * np.array([1, 2, 3]) + (1 - share) * albedo, found.shape),
                                  rel=0.03)
