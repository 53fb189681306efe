"""Volumes in path-traced pictures whose radiance is known: slabs of one density, media of albedo 1 in a furnace, and
light scattered once against quadrature."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from pictures import picture
from shapes import WHITE, constant, moved, orthographic, plate, scene, sphere

from viewer.scene.camera import Camera
from viewer.scene.light import Light
from viewer.scene.material import Material
from viewer.scene.scene import Scene
from viewer.scene.volume import Volume
from viewer.settings import Settings
from viewer.trace.tracer import Tracer

BLACK = (0.0, 0.0, 0.0)
ALONG_Z = orthographic(0.0, 0.0, height=0.8)
WIDE = [[-2, -2, -0.5], [2, 2, 0.5]]
"""A slab that the parallel rays of ALONG_Z cross over a distance of 1."""


def slab(density=1.0, box=WIDE, shape=(3, 4, 5), dtype=np.float32) -> Volume:
    return Volume.in_box(np.full(shape, density, dtype), np.array(box, float))


def with_volumes(*volumes: Volume, model: Scene | None = None, environment=None, lights=()) -> Scene:
    model = model if model is not None else Scene("test", (), (), ())
    return replace(model, volumes=volumes).relit(environment=environment, lights=lights)


def mean(tracer, model, camera=ALONG_Z, size=(16, 16), spp=64, **settings):
    """The mean radiance of a picture, (3,)."""
    return picture(tracer, model, camera, size, spp=spp, **settings)[..., :3].mean(axis=(0, 1))


@pytest.mark.parametrize("dtype", [np.float32, np.float16])
@pytest.mark.parametrize("tau", [0.0, 0.3, 2.0])
def test_absorption_in_a_slab(tracer, tau, dtype):
    model = with_volumes(slab(dtype=dtype), environment=constant())
    found = mean(tracer, model, spp=128, volume_density=tau, volume_albedo=BLACK)
    assert found == pytest.approx(np.exp(-tau), abs=0.006)


def test_slabs_that_overlap_add_up(tracer):
    half = slab(0.5, [[-2, -2, -0.5], [2, 2, 0.0]])
    model = with_volumes(slab(), half, slab(0.25, shape=(1, 1, 1)), environment=constant())
    found = mean(tracer, model, spp=128, volume_density=1.0, volume_albedo=BLACK)
    assert found == pytest.approx(np.exp(-1 - 0.25 - 0.25), abs=0.006)


def test_a_surface_inside_hides_what_is_behind_it(tracer):
    """A glowing plate in the middle of the slab: half of the slab is in front of it."""
    glow = Material(base_color=(0, 0, 0, 1), metallic=0.0, specular=0.0, emissive=(1.0, 0.5, 2.0))
    model = with_volumes(slab(), model=scene(plate(half=2.0), materials=[glow]), environment=constant())
    found = mean(tracer, model, spp=128, volume_density=2.0, volume_albedo=BLACK)
    assert found == pytest.approx(np.exp(-1) * np.array([1, 0.5, 2]), abs=0.012)


@pytest.mark.parametrize(("z", "way"), [(0.0, 0.5), (0.5, 1.0), (-0.5, 0.0), (0.25, 0.75)])
def test_camera_inside_and_on_the_faces(tracer, z, way):
    camera = Camera.look_at((0.1, 0.1, z), (0.1, 0.1, -5), fov_y=np.radians(0.5))
    model = with_volumes(slab(), environment=constant())
    found = mean(tracer, model, camera, spp=128, volume_density=1.5, volume_albedo=BLACK)
    assert found == pytest.approx(np.exp(-1.5 * way), abs=0.006)


def test_shadow_of_a_volume(tracer):
    """A plate under a slab that absorbs, in the light of a sun from above."""
    floor = scene((plate(half=2.0), moved((0, 0, -1.5))))
    sun = Light("directional", intensity=2.0, direction=(0, 0, -1))
    under = Camera.look_at((0, 0, -0.6), (0, 0, -1.5), fov_y=np.radians(10), up=(0, 1, 0))
    model = with_volumes(slab(), model=floor, lights=(sun,))
    found = mean(tracer, model, under, spp=64, volume_density=1.0, volume_albedo=BLACK)
    assert found == pytest.approx(2 / np.pi * np.exp(-1), rel=0.02)


@pytest.mark.parametrize("scale", [1e-6, 1.0, 1e6])
def test_emission_of_a_slab(tracer, scale):
    """L = e / sigma_t (1 - exp(-tau)), at any scale."""
    box = scale * np.array(WIDE)
    camera = replace(ALONG_Z, height=0.8 * scale)
    camera = replace(camera, pose=moved((0, 0, 3 * scale)))
    model = with_volumes(slab(box=box))
    found = mean(tracer, model, camera, spp=128, volume_density=1.2 / scale, volume_albedo=BLACK,
                 volume_emission=(0.6 / scale, 1.2 / scale, 0.0))
    expected = -np.expm1(-1.2) * np.array([0.5, 1.0, 0.0])
    assert found == pytest.approx(expected, abs=0.008)


@pytest.mark.parametrize(("tau", "g"), [(1e-6, 0.0), (0.5, 0.9), (0.5, -0.9), (4.0, 0.0), (4.0, 0.99), (4.0, -0.99),
                                        (6.0, 0.5)])
def test_white_media_vanish_in_the_furnace(tracer, tau, g):
    """Nothing is absorbed, so that radiance is 1 wherever one looks, from inside and outside."""
    rng = np.random.default_rng(3)
    rough = Volume.in_box(rng.random((6, 5, 7)).astype(np.float32), np.array([[-1, -1, -1], [1, 1, 1.0]]))
    model = with_volumes(rough, environment=constant())
    for camera in (orthographic(0.4, 0.3, height=2.0), Camera.look_at((0.2, 0.1, 0), (0, 0, 1), fov_y=1.0)):
        found = mean(tracer, model, camera, size=(8, 8), spp=64, volume_density=tau, volume_albedo=(1.0, 1.0, 1.0),
                     volume_g=g, bounces=255)
        assert found == pytest.approx(1, abs=0.02)


@pytest.mark.parametrize("g", [-0.6, 0.0, 0.7])
@pytest.mark.parametrize("kind", ["point", "directional"])
def test_light_scattered_once(tracer, g, kind):
    """A thin slab: single scattering by quadrature along the ray, with the attenuation of both ways."""
    light = Light("directional", intensity=3.0, direction=(0, -0.6, -0.8)) if kind == "directional" else \
        Light("point", intensity=3.0, position=(0.3, 1.0, 1.5))
    density, albedo = 0.2, np.array([0.02, 0.01, 0.005])  # what is scattered again is 1e-3 of it
    model = with_volumes(slab(), lights=(light,))
    camera = orthographic(0.0, 0.0, height=0.02)
    found = mean(tracer, model, camera, spp=512, volume_density=density, volume_albedo=tuple(albedo), volume_g=g)
    s, weight = np.polynomial.legendre.leggauss(64)
    z = -s / 2  # from the front face to the back
    point = np.stack([0 * z, 0 * z, z], axis=-1)
    if kind == "directional":
        to_light, irradiance = np.tile([0, 0.6, 0.8], (64, 1)), np.full(64, 3.0)
    else:
        offset = np.array(light.position) - point
        distance = np.linalg.norm(offset, axis=1)
        to_light, irradiance = offset / distance[:, None], 3.0 / distance**2
    out = (0.5 - z) / to_light[:, 2]
    mu = -to_light[:, 2]  # light travels along -to_light, and the camera sees what goes on along +z
    phase = (1 - g**2) / (4 * np.pi * (1 + g**2 - 2 * g * mu) ** 1.5)
    scattered = (phase * irradiance * np.exp(-density * (0.5 - z + out)) * density * weight).sum() / 2
    assert found == pytest.approx(scattered * albedo, rel=0.03)


def test_glass_displaces_a_volume(tracer):
    """A ball of clear glass of index 1 in black smoke: rays through its middle miss that part of the smoke."""
    ball = Material(metallic=0.0, perceptual_roughness=0.0, transmission=1.0, thickness=1.0, ior=1.0,
                    base_color=(0.999, 1, 1, 1))  # tinted, so that it is no boundary of media alone
    model = with_volumes(slab(box=[[-2, -2, -2], [2, 2, 2]]), model=scene((sphere(), moved((0, 0, 0), 1.0)),
                         materials=[ball]), environment=constant())
    thin = orthographic(0.0, 0.0, height=0.02)
    found = mean(tracer, model, thin, spp=128, volume_density=0.5, volume_albedo=BLACK, fresnel="exact")
    assert found[1] == pytest.approx(np.exp(-0.5 * 2), abs=0.008)


def test_no_volume_no_code(tracer):
    plain = scene(plate(), environment=constant())
    assert "track" not in tracer.begin(plain, ALONG_Z, settings_of(), (4, 4)).plan.programs
    plan = tracer.begin(with_volumes(slab(), environment=constant()), ALONG_Z, settings_of(), (4, 4)).plan
    assert "track" in plan.programs and "medium" in plan.programs


def settings_of(**values):
    return Settings.of(mode="path", spp=1, **values)


def test_other_settings_on_the_same_scene(tracer):
    """The density may change between pictures without another scene."""
    model = with_volumes(slab(), environment=constant())
    for tau in (0.5, 2.0, 0.5):
        found = picture(tracer, model, ALONG_Z, (16, 16), spp=128, volume_density=tau, volume_albedo=BLACK)
        assert found[..., :3].mean() == pytest.approx(np.exp(-tau), abs=0.008)


def test_the_bvh_gives_the_same_light(context):
    """A plate in smoke, whose shadow rays a BVH in a shader traces."""
    glow = Material(base_color=(0, 0, 0, 1), metallic=0.0, specular=0.0, emissive=(1.0, 0.5, 2.0))
    model = with_volumes(slab(), model=scene(plate(half=2.0), materials=[glow]), environment=constant())
    by_bvh = Tracer(context, intersector="bvh")
    found = mean(by_bvh, model, spp=64, volume_density=1.0, volume_albedo=(0.5, 0.5, 0.5))
    by_bvh.release()
    by_embree = Tracer(context)
    expected = mean(by_embree, model, spp=64, volume_density=1.0, volume_albedo=(0.5, 0.5, 0.5))
    by_embree.release()
    assert found == pytest.approx(expected, abs=1e-4)  # the same random numbers


def test_every_sample_is_good(tracer):
    """None is left out, at extreme densities and depths."""
    rng = np.random.default_rng(3)
    rough = Volume.in_box((rng.random((9, 3, 17)) ** 4).astype(np.float32), np.array(WIDE, float))
    model = with_volumes(rough, model=scene(plate(half=0.3), materials=[WHITE]), environment=constant(),
                         lights=(Light("point", intensity=1.0, position=(0, 0, 0.1)),))
    for density in (1e-6, 1.0, 1e4):
        done = tracer.render(model, ALONG_Z, replace(settings_of(volume_density=density), spp=16), (16, 16))
        assert done.stats["bad_samples"] == 0 and np.isfinite(done.linear).all()
