"""Empty, tiny and extreme scenes: the picture is right and every sample is finite."""

from __future__ import annotations

from dataclasses import replace
from itertools import product

import numpy as np
import pytest
from little_scenes import NOTHING_MUCH, framing
from pictures import picture
from shapes import WHITE, constant, facing_floor, lopsided, moved, orthographic, plate, scene, sphere

from viewer.scene.camera import Camera
from viewer.scene.environment import Environment
from viewer.scene.light import Light
from viewer.scene.material import Material
from viewer.scene.mesh import Mesh
from viewer.scene.scene import Scene
from viewer.settings import Settings
from viewer.trace.plan import TracePlan
from viewer.trace.tracer import Tracer

SIZE = (24, 24)
GLASS = Material(metallic=0.0, perceptual_roughness=0.0, transmission=1.0, thickness=1.0)


def plan_of(tracer: Tracer, model: Scene) -> TracePlan:
    path_render = tracer.begin(model, framing(model), Settings.of(mode="path", spp=1), (8, 8))
    path_render.release()
    return path_render.plan


@pytest.mark.parametrize("reach", [1e-320, 1e-30, 1e38])
def test_the_shortest_and_the_longest_range_of_a_light(tracer, reach):
    light = Light("point", intensity=10.0, position=(0, 0, 1.0), range=reach)
    with np.errstate(over="raise"):
        pixels = picture(tracer, scene(plate(), lights=(light,)), orthographic(), SIZE, spp=1)
    assert (pixels[..., :3].max() > 0) == (reach > 1)


@pytest.mark.parametrize("name", NOTHING_MUCH)
def test_little_or_nothing(tracer, name):
    lights = (Light.from_angles(0.2, 0.5, 2.0), Light("point", intensity=1.0, position=(1, 1, 1)))
    for environment in (None, constant(0.5)):
        model = replace(NOTHING_MUCH[name], environment=environment, lights=lights)
        pixels = picture(tracer, model, framing(model), SIZE, spp=4)
        corners = pixels[[0, 0, -1, -1], [0, -1, 0, -1]]
        assert np.abs(corners - ([0, 0, 0, 0] if environment is None else [0.5, 0.5, 0.5, 1])).max() < 1e-6


def test_no_light_at_all(tracer):
    model = scene((plate(), facing_floor()), sphere())
    pixels = picture(tracer, model, framing(model), SIZE, spp=4)
    assert (pixels[..., :3] == 0).all()
    assert pixels[12, 12, 3] == 1


def test_one_triangle(tracer):
    corner = Mesh("triangle", np.float32([[-1, -1, 0], [1, -1, 0], [0, 1, 0]]), 0,
                  normals=np.float32([[0, 0, 1]] * 3))
    model = scene(corner, lights=(Light("directional", intensity=np.pi, direction=(0, 0, -1)),))
    pixels = picture(tracer, model, orthographic(height=2.0), (64, 64), spp=16)
    assert pixels[40, 32] == pytest.approx([1, 1, 1, 1], abs=1e-5)
    assert pixels[..., 3].mean() == pytest.approx(0.5, abs=0.005)


def test_a_hundred_thousand_lights(tracer):
    """Many lights in one place equal one light, also if one of them is as bright as all others together."""
    floor = (plate(half=2.0), facing_floor())
    count = 100_000
    faint = [Light("point", intensity=1.0 / count, position=(0, 1, 0))] * count
    bright = Light("point", intensity=1.0, position=(0, 1, 0))
    above = orthographic(0.0, 1.2, height=2.0)
    many = picture(tracer, scene(floor, lights=(*faint, bright)), above, (16, 16), spp=64)[..., :3]
    one = picture(tracer, scene(floor, lights=(replace(bright, intensity=2.0),)), above, (16, 16), spp=64)[..., :3]
    assert many.mean() == pytest.approx(one.mean(), rel=0.01)


def test_a_thousand_glowing_triangles(tracer):
    """An emissive panel gives the same light if it is tessellated finely."""
    glow = Material(base_color=(0, 0, 0, 1), metallic=0.0, specular=0.0, emissive=(3.0, 3.0, 3.0), double_sided=True)
    cut = sphere(1, 48)
    whole = scene((plate(0, half=4.0), facing_floor(y=-2.0)), cut, materials=[WHITE, glow])
    above = orthographic(0.0, 1.2, height=1.0)
    pose = above.pose.copy()
    pose[:3, 3] += (3, -2, 0)
    above = replace(above, pose=pose)
    pixels = picture(tracer, whole, above, (16, 16), spp=64)
    # A ball of radiance L and radius 1 at distance d, seen from a floor: E = pi L cos(theta) / d^2.
    x = 3.0
    assert pixels[..., :3].mean() == pytest.approx(3.0 * (2 / np.hypot(x, 2)) / (x * x + 4), rel=0.03)


@pytest.mark.parametrize("roughness", [0.0, 0.5])
@pytest.mark.parametrize("ior", [1.0, 1.5])
def test_a_camera_inside_glass(tracer, ior, roughness):
    """In the furnace, whatever rough glass reflects inside."""
    model = scene(sphere(segments=96), materials=[replace(GLASS, ior=ior, perceptual_roughness=roughness)],
                  environment=constant())
    inside = Camera.look_at((0.2, 0.1, 0.3), (1, 0.3, -0.5), fov_y=np.radians(70))
    pixels = picture(tracer, model, inside, SIZE, spp=128, fresnel="exact")[..., :3]
    if roughness == 0:
        assert pixels.mean() == pytest.approx(1, abs=0.01)
    assert 0.98 < pixels.mean() < 1.01


@pytest.mark.parametrize("interface", [
    {"iridescence": 1.0, "iridescence_ior": 2.4, "iridescence_thickness_maximum": 300.0},
    {"specular_color": (5.0, 1.0, 0.0)}], ids=["film", "specular colour"])
def test_rough_glass_with_another_interface_makes_no_light(tracer, interface):
    model = scene(sphere(segments=96), materials=[replace(GLASS, ior=1.5, perceptual_roughness=0.5, **interface)],
                  environment=constant())
    inside = Camera.look_at((0.2, 0.1, 0.3), (1, 0.3, -0.5), fov_y=np.radians(70))
    pixels = picture(tracer, model, inside, SIZE, spp=128, fresnel="exact")[..., :3]
    assert pixels.mean(axis=(0, 1)).max() < 1.005


def test_a_sun_of_a_hundred_thousand(tracer):
    """One texel has nearly all the light. The floor's radiance is its irradiance over pi, within noise."""
    texels = np.zeros((64, 128, 3), np.float32)
    texels[16, 40] = 1e5
    model = scene((plate(half=4.0), facing_floor()), environment=Environment("sun", texels))
    pixels = picture(tracer, model, orthographic(0.0, 1.2, height=1.0), (16, 16), spp=64)
    # The bilinear filter is a tent over the neighbouring texels with the same integral.
    theta = (np.array([15, 16, 17]) + 0.5) / 64 * np.pi
    weight = np.array([1 / 8, 3 / 4, 1 / 8])
    solid_angle = weight * np.sin(theta) * (np.pi / 64) * (2 * np.pi / 128)
    assert pixels[..., :3].mean() == pytest.approx(1e5 * (solid_angle * np.cos(theta)).sum() / np.pi, rel=0.02)


@pytest.mark.parametrize("scale", [1e-6, 1e-3, 1e3, 1e6])
def test_the_same_picture_at_any_scale(tracer, scale):
    """In metres or in micrometres, the same samples hit the same triangles."""
    def still_life(scale: float) -> tuple[Scene, Camera]:
        things = [(plate(0, half=3.0), facing_floor(scale)), (sphere(1, 48), moved((0, 0.8 * scale, 0), 0.6 * scale)),
                  (sphere(2, 48), moved((1.2 * scale, 0.5 * scale, 0.4 * scale), 0.5 * scale))]
        materials = [WHITE, Material(base_color=(0.9, 0.7, 0.3, 1), perceptual_roughness=0.2),
                     replace(GLASS, attenuation_color=(0.5, 0.9, 0.6), attenuation_distance=scale)]
        lamp = Light("point", intensity=3.0 * scale**2, position=(-scale, 2 * scale, scale))
        model = scene(*things, materials=materials, environment=lopsided(), lights=(lamp,))
        return model, Camera.look_at((0, 2 * scale, 5 * scale), (0, 0.5 * scale, 0))

    one, other = (picture(tracer, *still_life(s), (32, 32), spp=8)[..., :3] for s in (1.0, scale))
    assert np.median(np.abs(other - one)) < 1e-5
    assert (np.abs(other - one) < 1e-3 * (1 + one)).mean() > 0.98
    assert other.mean() == pytest.approx(one.mean(), rel=0.01)


ROUGHNESS, F0 = (0.0, 1e-4, 0.5, 1.0), ({"ior": 1.0}, {"ior": 1.0001}, {"ior": 0.0}, {"specular": 0.0}, {"ior": 1e4})
LIGHTS = (Light("directional", intensity=1e12, direction=(-1, -1e-5, 0)), Light.from_angles(0.1, 1e-3, 1e12),
          Light("point", intensity=1e12, position=(0, 0, 1.0)), Light("point", intensity=1.0, position=(0, 0, 0)),
          Light("spot", intensity=1e12, position=(0, 0, 1.0000001), direction=(0, 0, -1), outer_cone=1e-5),
          Light("directional", intensity=1e-30))


@pytest.mark.parametrize("fresnel", ["schlick", "exact"])
@pytest.mark.parametrize("ndf", ["ggx", "beckmann", "blinn-phong"])
def test_extreme_materials_under_extreme_lights(tracer, ndf, fresnel):
    cases = list(product(ROUGHNESS, F0, (0.0, 1.0), (0.0, 1.0)))
    materials = [Material(base_color=(metallic,) * 3 + (1.0,), metallic=metallic, perceptual_roughness=roughness,
                          transmission=transmission, thickness=0.5, **f0)
                 for roughness, f0, metallic, transmission in cases]
    balls = [(sphere(k, 12), moved((2 * (k % 10) - 9, 2 * (k // 10) - 7, 0))) for k in range(len(cases))]
    model = scene(*balls, materials=materials, lights=LIGHTS, environment=lopsided())
    pixels = picture(tracer, model, orthographic(0.0, 0.0, 20.0, 40.0), (48, 48), spp=2, ndf=ndf, fresnel=fresnel)
    assert pixels.min() >= 0


def test_a_light_on_a_surface_and_an_eye_on_a_light(tracer):
    model = scene((plate(half=2.0), facing_floor()), lights=(Light("point", intensity=1.0, position=(0, 0, 0)),
                                                             Light("point", intensity=1.0, position=(0, 1, 0))))
    assert picture(tracer, model, Camera.look_at((0, 1, 0), (0.3, 0, 0)), SIZE, spp=4).max() < 1e6


def test_what_no_path_can_find_is_said(tracer):
    """Below smooth glass there is only the shadow of a point light, and the plan says so.

    Rough glass transmits its light.
    """
    lamp = Light("point", intensity=10.0, position=(0, 4, 0))
    for roughness, is_lost in ((0.0, True), (0.4, False)):
        glass = replace(GLASS, perceptual_roughness=roughness)
        model = scene((plate(0, half=3.0), facing_floor()), (sphere(1, 48), moved((0, 1.5, 0), 0.6)),
                      materials=[WHITE, glass], lights=(lamp,))
        below = Camera.look_at((0, 0.4, 1.6), (0, 0, 0), fov_y=np.radians(5))
        pixels = picture(tracer, model, below, (16, 16), spp=64, bounces=4)[..., :3]
        said = [line for line in plan_of(tracer, model).left_out if "through smooth glass" in line]
        assert bool(said) == is_lost
        assert (pixels.mean() < 0.05) == is_lost
