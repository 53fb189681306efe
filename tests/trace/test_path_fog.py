"""Fog in path-traced pictures whose radiance is known: furnaces, transmittance, and light scattered once against
quadrature."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from fog_truth import optical_depth, rays, single_scattering
from pictures import picture
from shapes import WHITE, constant, facing_floor, moved, orthographic, plate, scene, sphere

from viewer.scene.camera import Camera
from viewer.scene.fog import REACH, fog_of
from viewer.scene.light import Light
from viewer.scene.material import Material
from viewer.scene.scene import Scene
from viewer.scene.volume import Volume
from viewer.settings import Settings
from viewer.trace.scene.traced_scene import plan_without_device
from viewer.trace.tracer import Tracer

BLACK = replace(WHITE, base_color=(0, 0, 0, 1))
GLOWING = replace(BLACK, emissive=(4.0, 1.0, 0.5))
NO_ALBEDO = {"fog_albedo": (0.0, 0.0, 0.0)}
FEW = (8, 8)
INSIDE, OUTSIDE = (replace(Camera.orbit((0, 0, 0), distance, 0.3, 0.2), fov_y=2 / distance) for distance in (2.8, 9.0))
PARALLEL = orthographic(0.4, height=2.0)
SUN = Light("directional", intensity=3.0, direction=(0, -0.6, -0.8))
LAMP = Light("point", intensity=2.0, position=(0.4, 0.5, 0.3))


@pytest.mark.parametrize(("camera", "settings"), [
    (PARALLEL, {"fog": 1e-6}), (INSIDE, {"fog": 0.5, "fog_g": 0.7}), (OUTSIDE, {"fog": 0.5, "fog_g": -0.4}),
    (OUTSIDE, {"fog": 1.5, "fog_height": 0.5}),
], ids=["thin", "inside", "outside", "thinning"])
def test_a_white_furnace_stays_white(tracer, camera, settings):
    """Fog and a surface that absorb nothing, under light from everywhere."""
    model = scene(sphere(segments=48), environment=constant())
    found = picture(tracer, model, camera, FEW, spp=64, bounces=255, **settings)[..., :3]
    assert found.mean() == pytest.approx(1, abs=0.012)


@pytest.mark.parametrize("camera", [INSIDE, OUTSIDE, PARALLEL], ids=["inside", "outside", "orthographic"])
@pytest.mark.parametrize("height", [0.0, 0.4])
def test_light_is_lost_on_the_way_to_the_eye(tracer, camera, height):
    """exp(-optical depth) of what glows and of what is behind it, by quadrature along each ray."""
    model = scene(plate(half=0.7), materials=[replace(GLOWING, double_sided=True)], environment=constant(0.5))
    settings = {"fog": 0.5, "fog_height": height, **NO_ALBEDO}
    fog = fog_of(model, Settings.of(**settings))
    found = picture(tracer, model, camera, (16, 16), spp=64, **settings)[..., 0]
    start, direction = rays(camera, (32, 32))
    distance = -start[..., 2] / direction[..., 2]
    across = np.abs((start + distance[..., None] * direction)[..., :2]).max(axis=-1)
    lit = _of_pixels(4 * np.exp(-optical_depth(fog, start, direction, distance)))
    sky = _of_pixels(0.5 * np.exp(-optical_depth(fog, start, direction, 40.0)))
    is_seen, is_beside = _of_pixels(across < 0.6) == 1, _of_pixels(across > 0.8) == 1
    assert is_seen.sum() > 10 and is_beside.sum() > 10
    assert found[is_seen] == pytest.approx(lit[is_seen], rel=0.02)
    assert found[is_beside] == pytest.approx(sky[is_beside], rel=0.04)


def _of_pixels(rays: np.ndarray) -> np.ndarray:
    """The means of 2 x 2 rays."""
    return rays.reshape(16, 2, 16, 2).mean(axis=(1, 3))


@pytest.mark.parametrize("height", [0.0, 0.5])
@pytest.mark.parametrize(("camera", "light"), [(INSIDE, LAMP), (OUTSIDE, SUN), (OUTSIDE, LAMP), (PARALLEL, SUN)],
                         ids=["inside, lamp", "outside, sun", "outside, lamp", "orthographic, sun"])
def test_light_scattered_once(tracer, camera, light, height):
    """By quadrature; at an albedo of 0.003 nothing else counts."""
    model = scene((sphere(segments=8), moved((0, -0.9, 0), 0.01)), (sphere(segments=8), moved((0, 0.9, 0), 0.01)),
                  materials=[BLACK], lights=(light,))
    settings = {"fog": 0.35, "fog_g": 0.5, "fog_albedo": (0.003, 0.003, 0.003), "fog_height": height}
    fog = fog_of(model, Settings.of(**settings))
    narrow = replace(camera, height=0.1) if camera.height else replace(camera, fov_y=0.02)
    start, direction = rays(narrow, FEW)
    expected = single_scattering(fog, light, start, direction, 30.0).mean()
    found = picture(tracer, model, narrow, FEW, spp=256, **settings)[..., :3].mean()
    assert found == pytest.approx(expected, rel=0.015)


@pytest.mark.parametrize("height", [0.0, 0.4])
@pytest.mark.parametrize("intersector", ["embree", "bvh"])
def test_fog_dims_a_sun_as_far_as_it_reaches(context, intersector, height):
    """A plate on the floor under a sun, by the optical depths of both ways."""
    sun = Light("directional", intensity=2.0, direction=(0.6, -0.8, 0.0))
    model = scene((plate(), facing_floor()), lights=(sun,))
    camera = replace(Camera.look_at((0, 2, 0), (0, 0, 0), up=(0, 0, 1)), height=0.02)
    settings = {"fog": 0.3, "fog_height": height, **NO_ALBEDO}
    fog = fog_of(model, Settings.of(**settings))
    up, to_sun = np.array([0.0, 1, 0]), np.array([-0.6, 0.8, 0.0])
    tau = sum(optical_depth(fog, np.zeros(3), d, REACH * model.radius) for d in (up, to_sun))
    with_tracer = Tracer(context, intersector=intersector)
    found = picture(with_tracer, model, camera, (4, 4), spp=4, **settings)[..., 0]
    with_tracer.release()
    assert found == pytest.approx(2 / np.pi * 0.8 * np.exp(-tau), rel=2e-3)


@pytest.mark.parametrize("what", ["volume", "glass", "boundary"])
@pytest.mark.parametrize("place", ["outside", "inside"])
def test_solids_and_volumes_displace_fog(tracer, what, place):
    """Rays along an axis miss as much of the fog as lies in the middle."""
    clear = Material(metallic=0.0, perceptual_roughness=0.0, transmission=1.0, thickness=1.0, ior=1.0,
                     base_color=(1, 0.999, 1, 1) if what == "glass" else (1, 1, 1, 1))
    if what == "volume":
        model = replace(scene((sphere(1, segments=8), moved((0, 1, 0), 0.01)), materials=[BLACK, BLACK]), volumes=(
            Volume.in_box(np.zeros((1, 1, 1), np.float32), [[-1, -1, -1], [1, 1, 1]]),))
    else:
        model = scene((sphere(segments=192), moved((0, 0, 0), 1.0)), materials=[clear])
    model = model.relit(environment=constant(), lights=())
    camera = orthographic(0.0, 0.0, height=0.02)
    if place == "inside":
        camera = Camera.look_at((0, 0, 0), (0, 0, -1), fov_y=1e-3)
    found = picture(tracer, model, camera, (8, 8), spp=16, fog=0.2, fresnel="exact", **NO_ALBEDO)[..., 0]
    ways = 1 if place == "inside" else 2
    assert found.mean() == pytest.approx(np.exp(-0.2 * ways * (REACH * model.radius - 1)), rel=3e-3)


def everything() -> Scene:
    glass = Material(metallic=0.0, perceptual_roughness=0.0, transmission=1.0, thickness=1.0, ior=1.4)
    hole = replace(glass, ior=1.0, scatter_color=(0.5, 0.5, 0.5), attenuation_color=(0.5, 0.6, 0.7),
                   attenuation_distance=0.5)
    pane = Material(base_color=(0.5, 0.5, 0.5, 0.5), alpha_mode="blend", double_sided=True)
    smoke = Volume("smoke", np.random.default_rng(1).random((4, 5, 6)).astype(np.float32), moved((-1, 0, -1), 0.2))
    model = scene((plate(0, 2.0), facing_floor(y=-1.0)), (sphere(1), moved((0.5, 0, 0), 0.4)),
                  (sphere(2), moved((-0.6, -0.4, 0.4), 0.4)), (plate(3), moved((0, 0, 0.9))),
                  materials=[WHITE, glass, hole, pane], environment=constant(0.3),
                  lights=(Light("point", intensity=2.0, position=(1.5, 1.5, 1.0)),
                          Light("directional", intensity=1.0, direction=(0, -1, 0))))
    return replace(model, volumes=(smoke,))


def test_both_intersectors_trace_the_same(context):
    pictures = []
    for intersector in ("embree", "bvh"):
        tracer = Tracer(context, intersector=intersector)
        camera = Camera.look_at((1, 1, 4), (0, 0, 0))
        pictures.append(picture(tracer, everything(), camera, (12, 12), spp=8, fog=0.3, fog_height=0.5)[..., :3])
        tracer.release()
    assert np.median(np.abs(pictures[0] - pictures[1])) < 1e-4  # rounding sends few paths another way
    assert pictures[0].mean() == pytest.approx(pictures[1].mean(), rel=0.01)


@pytest.mark.parametrize("scale", [1e-6, 1e6])
def test_the_scale_of_the_scene_does_not_matter(tracer, scale):
    lamp = Light("point", intensity=2.0, position=(0.8, 0.5, 0.9))
    model = scene(sphere(segments=24), lights=(lamp,), environment=constant(0.2))
    big = scene((sphere(segments=24), moved((0, 0, 0), scale)), environment=constant(0.2), lights=(
        replace(lamp, intensity=2.0 * scale**2, position=tuple(scale * np.array(lamp.position))),))
    camera, far = (Camera.orbit((0, 0, 0), 2.8 * s, 0.3, 0.2) for s in (1.0, scale))
    settings = {"fog_height": 0.7, "fog": 0.4, "fog_g": 0.3}
    expected = picture(tracer, model, camera, FEW, spp=64, **settings)[..., :3].mean()
    found = picture(tracer, big, far, FEW, spp=64, **settings | {"fog": 0.4 / scale, "fog_height": 0.7 * scale})
    assert found[..., :3].mean() == pytest.approx(expected, rel=0.015)


@pytest.mark.parametrize("settings", [
    {"fog": 1e18}, {"fog": 1e-18}, {"fog": 1e6, "fog_g": 0.99, "fog_albedo": (0.9, 0.5, 0)},
    {"fog": 1.0, "fog_height": 1e-12}, {"fog": 1.0, "fog_height": 1e18}, {"fog": 1e6, "fog_height": 1e-3},
], ids=str)
def test_extremes_stay_finite(tracer, settings):
    lamps = (Light("point", intensity=2.0, position=(0, 0, 0)), Light("spot", intensity=2.0, position=(0, 2, 0)),
             Light("directional", intensity=3.0, direction=(0, -1, 0)))
    albedo = {"fog_albedo": (0.9, 0.9, 0.9)} | settings
    model = scene(sphere(segments=12), lights=lamps, environment=constant(0.2))
    for camera in (Camera.orbit((0, 0, 0), 1e-3, 0.3, 0.2), Camera.orbit((0, 0, 0), 1e4, 0.3, 0.2)):
        assert (picture(tracer, model, camera, (4, 4), spp=2, **albedo) >= 0).all()


def test_fog_may_change_between_pictures(tracer):
    """Of one scene, without another one between them."""
    model = scene(plate(half=0.7), materials=[GLOWING])
    camera = orthographic(height=0.02)
    for sigma in (0.5, 0.25, 0.0, 0.5):
        found = picture(tracer, model, camera, (2, 2), spp=2, fog=sigma, **NO_ALBEDO if sigma else {})[..., 0]
        assert found == pytest.approx(4 * np.exp(-sigma * REACH * model.radius), rel=1e-3)


def test_a_scene_without_fog_has_no_code_for_it():
    model = scene(sphere(), environment=constant())
    clear, foggy, thinning = (plan_without_device(model, Settings.of(mode="path", **more)) for more in (
        {}, {"fog": 0.5}, {"fog": 0.5, "fog_height": 1.0}))
    assert {p["HAS_FOG"] for n, p in clear.programs.items() if n in ("generate", "classify", "surface")} == {0}
    assert "medium" not in clear.programs and "fog: the scene has none" in clear.left_out
    assert "fog" in foggy.used and foggy.programs["medium"]["HAS_FOG"] == 1
    assert thinning.programs["medium"]["HAS_FOG"] == 2
