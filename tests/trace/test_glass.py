"""Glass whose pictures are known analytically: panes and slabs seen along their normals, and mixtures."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from pictures import picture
from shapes import constant, moved, orthographic, plate, scene, sphere

from viewer.scene.camera import Camera
from viewer.scene.environment import Environment
from viewer.scene.equirect import texel_directions
from viewer.scene.light import Light
from viewer.scene.material import Material
from viewer.scene.mesh import Mesh
from viewer.scene.scene import Scene

FRONT = orthographic(0.0, 0.0, height=0.5)
GLASS = Material(metallic=0.0, perceptual_roughness=0.0, transmission=1.0)
R = ((1.5 - 1) / (1.5 + 1)) ** 2


def box(x: float, y: float, z: float) -> Mesh:
    """A closed box from (-x, -y, -z) to (x, y, z) whose faces point outwards."""
    points, normals = [], []
    for axis in range(3):
        for side in (-1.0, 1.0):
            n = np.insert(np.zeros(2), axis, side)
            u = np.roll(n, 1)
            v = np.cross(n, u)
            corners = np.array([n - u - v, n + u - v, n + u + v, n - u + v]) * [x, y, z]
            points.append(corners)
            normals.append([n] * 4)
    indices = (4 * np.arange(6)[:, None] + [0, 1, 2, 0, 2, 3]).ravel()
    return Mesh("box", np.concatenate(points).astype(np.float32), 0, indices=indices.astype(np.uint32),
                normals=np.concatenate(normals).astype(np.float32))


def mean(tracer, model: Scene, camera: Camera = FRONT, spp: int = 64, **settings) -> np.ndarray:
    return picture(tracer, model, camera, (16, 16), spp=spp, **settings)[..., :3].mean(axis=(0, 1))


def test_a_wall(tracer):
    """2 R / (1 + R) is reflected, and the rest is transmitted and tinted once."""
    wall = replace(GLASS, base_color=(0.9, 0.5, 0.1, 1), double_sided=True)
    found = mean(tracer, scene(plate(half=4.0), materials=[wall], environment=constant()))
    back = 2 * R / (1 + R)
    assert found == pytest.approx(back + (1 - back) * np.array([0.9, 0.5, 0.1]), abs=2e-3)


def test_a_slab_absorbs(tracer):
    """The radiance is R + T^2 a / (1 - R a) in uniform light: the sum over internal reflections, with transmittance a
    per crossing."""
    slab = replace(GLASS, thickness=1.0, attenuation_distance=0.25, attenuation_color=(0.8, 0.3, 0.01))
    found = mean(tracer, scene(box(4, 4, 0.25), materials=[slab], environment=constant()))
    a = np.array([0.8, 0.3, 0.01]) ** 2
    assert found == pytest.approx(R + (1 - R) ** 2 * a / (1 - R * a), abs=2e-3)


@pytest.mark.parametrize("sampling", ["bsdf", "lights"])
def test_light_from_outside_of_an_open_mesh_is_absorbed_alike(tracer, sampling):
    """Behind a single sheet of solid glass there is only medium. Light samples and BSDF samples travel the same
    distance in it."""
    glass = replace(GLASS, perceptual_roughness=1.0, thickness=1.0, attenuation_distance=1.0,
                    attenuation_color=(0.9, 0.7, 0.4))
    sheet = scene(plate(), materials=[glass], environment=constant())
    expected = mean(tracer, sheet, spp=1024)
    assert mean(tracer, sheet, spp=1024, sampling=sampling) == pytest.approx(expected, rel=0.01)


def test_a_slab_is_tinted_once_on_the_way_through(tracer):
    slab = replace(GLASS, thickness=1.0, base_color=(0.64, 0.25, 1, 1))
    found = mean(tracer, scene(box(4, 4, 0.25), materials=[slab], environment=constant()), bounces=2)
    assert found == pytest.approx(R + (1 - R) ** 2 * np.array([0.64, 0.25, 1]), abs=2e-3)


def test_what_is_inside_is_seen_through_all_of_the_way(tracer):
    """A lamp in a slab behind a pane of coverage 0: the slab absorbs all the way from its front, and radiance is
    divided by the index squared."""
    slab = replace(GLASS, thickness=1.0, attenuation_distance=0.25, attenuation_color=(0.8, 0.3, 0.01))
    pane = Material(base_color=(1, 1, 1, 0), metallic=0.0, alpha_mode="blend")
    lamp = Material(base_color=(0, 0, 0, 1), metallic=0.0, specular=0.0, emissive=(4.0, 4.0, 4.0))
    model = scene(box(4, 4, 0.5), (plate(1, half=3.0), moved((0, 0, 0.25))), plate(2, half=3.0),
                  materials=[slab, pane, lamp])
    seen = 4 * (1 - R) / 1.5**2 * np.array([0.8, 0.3, 0.01]) ** 2
    assert mean(tracer, model) == pytest.approx(seen, rel=5e-3)


def test_from_inside_a_ball_light_is_absorbed_on_the_way(tracer):
    """From the middle of the sphere, every way out is one radius long and crosses the surface along its normal."""
    ball = replace(GLASS, thickness=1.0, attenuation_distance=1.0, attenuation_color=(0.5, 0.2, 0.9))
    model = scene(sphere(segments=192), materials=[ball], environment=constant())
    camera = Camera.look_at((0, 0, 0), (0, 0.3, -1), fov_y=1.0)
    a = np.array([0.5, 0.2, 0.9])
    expected = (1 - R) * a / (1 - R * a**2)
    assert mean(tracer, model, camera) == pytest.approx(expected, abs=4e-3)


@pytest.mark.parametrize("thickness", [0.0, 1.0])
def test_a_mixture_is_the_sum_of_its_parts(tracer, thickness):
    """With transmission 0.4 and metallic 0.3, one bounce is linear in both."""
    base = Material(base_color=(0.8, 0.4, 0.2, 1), perceptual_roughness=0.5, thickness=thickness, double_sided=True)
    model = scene(plate(half=4.0), materials=[base], environment=lit())

    def of(**changes) -> np.ndarray:
        return mean(tracer, replace(model, materials=(replace(base, **changes),)), tilted(), 256, fresnel="exact")

    whole = of(transmission=0.4, metallic=0.3)
    glass, opaque, metal = of(transmission=1.0, metallic=0.0), of(metallic=0.0), of(metallic=1.0)
    assert whole == pytest.approx(0.3 * metal + 0.7 * (0.4 * glass + 0.6 * opaque), rel=0.01)


@pytest.mark.parametrize("thickness", [0.0, 1.0])
def test_rough_glass_is_lossless(tracer, thickness):
    """A tenth of the light and more is lost by facets that scatter once."""
    glass = replace(GLASS, perceptual_roughness=0.5, thickness=thickness, double_sided=True)
    model = scene(sphere(segments=48), materials=[glass], environment=constant())
    found, lossy = (mean(tracer, model, multiscatter=multiscatter, bounces=64) for multiscatter in ("on", "off"))
    assert found == pytest.approx(1.0, abs=0.03)
    assert lossy.max() < 0.95


def test_lights_and_lobes_agree(tracer):
    """Rough glass in front of a small bright patch, which both BSDF samples and light samples find."""
    model = scene(plate(half=4.0), materials=[replace(GLASS, perceptual_roughness=0.6, double_sided=True)],
                  environment=lit(behind=True))
    pixels = picture(tracer, model, FRONT, (16, 16), spp=256, multiscatter="off")[..., :3]
    # By quadrature over the environment's texels, T' D V cos
    from viewer.measure.check.lobes import LOBES

    lobe = next(lobe for lobe in LOBES if lobe.name == "thin_dielectric")
    environment = model.environment
    assert environment is not None
    d = texel_directions(*environment.radiance.shape[:2]).reshape(-1, 3)
    f = lobe.eval({"eta": 1.5, "alpha": 0.36}, np.array([0.0, 0.0, 1.0]), d, tracer.context)[:, 0]
    rows = np.pi * np.arange(65) / 64
    solid_angle = np.repeat(np.cos(rows[:-1]) - np.cos(rows[1:]), 128) * 2 * np.pi / 128
    expected = (f[:, None] * environment.radiance.reshape(-1, 3) * (np.abs(d[:, 2]) * solid_angle)[:, None]).sum(axis=0)
    assert pixels.mean(axis=(0, 1)) == pytest.approx(expected, rel=0.02)


def test_without_specular_nothing_reflects(tracer):
    """The factor applies to f90, too, so that it also shows at grazing angles."""
    wall = replace(GLASS, specular=0.0, double_sided=True, base_color=(0.7, 0.7, 0.7, 1))
    model = scene(plate(half=40.0), materials=[wall], environment=constant())
    for camera in (FRONT, tilted()):
        assert mean(tracer, model, camera) == pytest.approx([0.7] * 3, abs=3e-3)


def test_a_point_light_is_not_found_through_smooth_glass_but_through_rough(tracer):
    """Smooth glass that the camera sees sends it light from one direction alone, whether it bends that or not."""

    def wall(roughness: float) -> Scene:
        material = replace(GLASS, perceptual_roughness=roughness, double_sided=True)
        lamp = Light("point", intensity=1.0, position=(0, 0, -1))
        return scene(plate(half=4.0), materials=[material], lights=(lamp,))

    assert (mean(tracer, wall(0.0)) == 0).all()
    assert mean(tracer, wall(0.5)).min() > 0.05


def tilted() -> Camera:
    return orthographic(0.7, 0.4, height=0.5)


def lit(behind: bool = False) -> Environment:
    """A bright patch on the viewer's side, or on the other side."""
    d = texel_directions(64, 128)
    axis = np.array([0.3, 0.2, -1.0 if behind else 1.0])
    patch = np.exp(60 * (d @ (axis / np.linalg.norm(axis)) - 1))
    return Environment("patch", (0.2 + 8 * patch[..., None] * [1.0, 0.8, 0.6]).astype(np.float32))


def test_dispersion_parts_the_colours_of_white_light(tracer):
    """A ball before the edge between a black and a white half of the world: blue is bent more than red. Without
    dispersion, or with wavelengths that are not weighted by colour, all is grey."""
    sky = np.repeat(texel_directions(32, 64)[..., :1] > 0, 3, axis=-1).astype(np.float32)

    def seen(dispersion: float) -> np.ndarray:
        ball = replace(GLASS, thickness=1.0, dispersion=dispersion)
        model = scene(sphere(segments=96), materials=[ball], environment=Environment("halves", sky))
        return picture(tracer, model, orthographic(0.0, 0.0, height=2.0), (16, 16), spp=128)[..., :3]

    grey, rainbow = seen(0.0), seen(8.0)
    assert np.abs(grey[..., 0] - grey[..., 2]).max() < 1e-5
    parted = rainbow[..., 2] - rainbow[..., 0]
    assert np.abs(parted).max() > 0.2
    assert abs(rainbow.mean() / grey.mean() - 1) < 0.05
