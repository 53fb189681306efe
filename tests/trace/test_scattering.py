"""Media that scatter light: pictures with a known answer."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from pictures import picture
from shapes import WHITE, constant, facing_floor, moved, orthographic, plate, scene, sphere
from slab import slab_radiance

from viewer.scene.camera import Camera
from viewer.scene.environment import Environment
from viewer.scene.light import Light
from viewer.scene.material import Material
from viewer.scene.mesh import Mesh
from viewer.scene.scene import Scene
from viewer.settings import Settings
from viewer.trace import defines
from viewer.trace.scene.traced_scene import plan_without_device

FRONT = orthographic(0.4, 0.3, height=2.2)
GLASS = Material(metallic=0.0, perceptual_roughness=0.0, transmission=1.0, thickness=1.0, ior=1.0)


def fog(sigma_t: float | tuple[float, float, float], color: float | tuple[float, float, float], g: float = 0.0,
        **more: object) -> Material:
    """Fills a mesh with a medium of this extinction per unit; `color` is the albedo of all scattering."""
    transmittance = tuple(np.exp(-np.broadcast_to(np.asarray(sigma_t, float), 3) / 50).tolist())
    color = tuple(np.broadcast_to(np.asarray(color, float), 3).tolist())
    return replace(GLASS, attenuation_color=transmittance, attenuation_distance=1 / 50, scatter_color=color,
                   scatter_anisotropy=g, **more)


def box(half: tuple[float, float, float], material: int = 0) -> Mesh:
    corners = np.array([(x, y, z) for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)]) * half
    faces = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
    triangles = [(a, b, c) for p, q, r, s in faces for a, b, c in ((p, q, r), (p, r, s))]
    return Mesh("box", corners.astype(np.float32), material, indices=np.uint32(triangles).ravel())


def albedo_of(material: Material) -> float:
    return material.medium.albedo[0]


@pytest.mark.parametrize("ior", [1.0, 1.4])
def test_white_media_vanish_in_the_furnace(tracer, ior):
    """Every path that is scattered without loss brings radiance 1 where each light is found by hitting it."""
    model = scene(sphere(), materials=[fog((4.0, 2.0, 8.0), 1.0, 0.5, ior=ior)], environment=constant())
    assert model.materials[0].medium.albedo == pytest.approx((1.0, 1.0, 1.0), abs=1e-9)
    pixels = picture(tracer, model, FRONT, (16, 16), spp=8, sampling="bsdf", fresnel="exact")
    # Roulette at the glass and the choice of a channel keep the sum of the channels, not each of them.
    assert np.abs(pixels[..., :3].sum(axis=-1) / 3 - 1).max() < 2e-3
    pixels = picture(tracer, model, FRONT, (16, 16), spp=64, fresnel="exact")
    assert pixels[..., :3].mean() == pytest.approx(1, abs=0.01)


@pytest.mark.parametrize("tau, color, g", [(0.5, 0.9, 0.0), (2.0, 0.7, 0.6), (8.0, 1.0, -0.4)])
def test_a_slab_in_light_from_above(tracer, tau, color, g):
    """What a slab reflects and lets through, against discrete ordinates in float64."""
    material = fog(tau, color, g)
    sky = np.zeros((256, 4, 3), np.float32)
    sky[:128] = 1.0
    model = scene(box((10.0, 0.5, 10.0)), materials=[material], environment=Environment("sky", sky))
    up, down = slab_radiance(tau, albedo_of(material), g, above=1.0, below=0.0)
    for eye, expected in (((0, 8, 0), up), ((0, -8, 0), down)):
        camera = replace(Camera.look_at(eye, (0, 0, 0), up=(0, 0, -1)), height=1.0)
        pixels = picture(tracer, model, camera, (16, 16), spp=64)
        assert pixels[..., :3].mean() == pytest.approx(expected, rel=0.02)


def test_a_path_that_no_surface_lies_ahead_of_is_out_of_the_medium(tracer):
    """A sheet is the solid of no inside. Behind it there is no end of a white medium: paths would collide for ever."""
    model = scene(plate(), materials=[fog(4.0, 1.0)], environment=constant())
    assert picture(tracer, model, FRONT, (8, 8), spp=4)[..., :3] == pytest.approx(1, abs=1e-6)


def test_discrete_ordinates_keep_all_light():
    for tau in (0.01, 1.0, 30.0):
        assert slab_radiance(tau, 1.0, 0.7, 1.0, 1.0) == pytest.approx((1, 1), abs=1e-6)
    assert slab_radiance(2.0, 0.0, 0.0, 1.0, 0.0) == pytest.approx((0, np.exp(-2)), abs=1e-9)


@pytest.mark.parametrize("light, lit", [
    (Light("point", intensity=2.0, position=(0.0, 0.4, 0.0)), lambda z: 2.0 / (0.16 + z * z)),
    (Light("directional", intensity=3.0, direction=(0, -1, 0)), lambda z: 3.0 * np.exp(-0.2)),
])
@pytest.mark.parametrize("place", ["inside", "outside"])
def test_single_scattering_from_lights_without_size(tracer, light, lit, place):
    """The integral over the ray of sigma_s p L exp(-tau), by quadrature, for a thin medium of small albedo."""
    material = fog(0.2, 0.001)  # an albedo of 0.005 for a single scattering
    if light.kind == "directional":
        light = replace(light, direction=(0.0, -1.0, 0.0))
    model = scene(box((1.0, 1.0, 1.0)), materials=[material], lights=(light,))
    eye = (0.0, 0.0, 3.0) if place == "outside" else (0.0, 0.0, 0.999)
    camera = replace(Camera.look_at(eye, (0, 0, 0), fov_y=1e-3))
    z, w = np.polynomial.legendre.leggauss(64)
    to_light = np.sqrt(0.16 + z * z) if light.kind == "point" else 0.0
    single = (lit(z) * np.exp(-0.2 * (1 - z)) * np.exp(-0.2 * to_light) * w).sum() * 0.2 / (4 * np.pi)
    pixels = picture(tracer, model, camera, (16, 16), spp=32)
    # What is scattered twice is about tau times the albedo, 1e-3, of it.
    assert pixels[..., :3].mean() == pytest.approx(single * albedo_of(material), rel=0.012)


@pytest.mark.parametrize("hole", [Material(metallic=0.0, perceptual_roughness=0.0, transmission=1.0, thickness=1.0,
                                           ior=1.0), fog(3.0, 1e-4)])
def test_the_inner_medium_displaces_the_outer(tracer, hole):
    """A ball inside of a box, both of index 1: only one of the two media fills each place."""
    outer = fog((0.5, 0.2, 0.0), 1e-4)
    model = scene(box((1.0, 1.0, 1.0)), (sphere(1), moved((0, 0, 0), 0.5)), materials=[outer, hole],
                  environment=constant())
    expected = np.exp(-np.array(outer.medium.sigma_t) * 1.0 - np.array(hole.medium.sigma_t) * 1.0)
    for eye in ((0, 0, 4), (0, 0, 0)):  # from outside and from the middle, which is half the way
        camera = Camera.look_at(eye, (0.0, 0.0, -1.0), fov_y=1e-3)
        pixels = picture(tracer, model, camera, (16, 16), spp=64)
        way = expected if eye[2] else np.sqrt(expected)
        assert pixels[..., :3].mean(axis=(0, 1)) == pytest.approx(way, abs=0.012)


def test_a_light_inside_of_milk_in_glass_is_found(tracer):
    """Shadow rays are sent behind a boundary that refracts only where a light is there, too."""
    milk = fog(3.0, 0.5, ior=1.3)
    lit = scene(sphere(), materials=[milk], lights=(Light("point", intensity=1.0, position=(0.0, 0.0, 0.0)),))
    far = replace(lit, lights=(Light("point", intensity=1.0, position=(0.0, 3.0, 0.0)),))
    camera = orthographic(0.0, 0.0, height=0.5)
    assert picture(tracer, lit, camera, (8, 8), spp=32, fresnel="exact")[..., :3].mean() > 1e-3
    assert picture(tracer, far, camera, (8, 8), spp=4, fresnel="exact")[..., :3].max() < 1e-6


def test_channels_do_not_disturb_each_other(tracer):
    """A medium whose extinction differs by channel, against three grey ones."""
    sigma_t, color = (1.0, 4.0, 12.0), (0.9, 0.6, 0.3)
    model = scene(sphere(), materials=[fog(sigma_t, color)], environment=constant())
    colored = picture(tracer, model, FRONT, (16, 16), spp=128)[..., :3].mean(axis=(0, 1))
    for k in range(3):
        grey = replace(model, materials=(fog(sigma_t[k], color[k]),))
        assert colored[k] == pytest.approx(picture(tracer, grey, FRONT, (16, 16), spp=64)[..., :3].mean(), rel=0.02)


@pytest.mark.parametrize("transmission, strength, g", [(1.0, 1.0, 0.5), (0.7, 0.6, -0.3)])
def test_a_thin_wall_scatters_what_it_transmits(tracer, transmission, strength, g):
    """KHR_materials_scatter: transmitted light is scattered as color / pi, (1 + g) / 2 of it through the wall."""
    color, base = np.array((0.9, 0.5, 0.1)), np.array((0.2, 0.4, 0.6))
    wall = Material(base_color=(*base, 1.0), metallic=0.0, perceptual_roughness=0.0, specular=0.0, ior=1.0,
                    double_sided=True, transmission=transmission, scatter_strength=strength,
                    multiscatter_color=tuple(color), multiscatter_anisotropy=g)
    scattered, lit = transmission * strength * color, 3.0 / np.pi * np.cos(0.4)
    behind = (1 + g) / 2 * scattered * lit
    front = ((1 - g) / 2 * scattered + (1 - transmission) * base) * lit
    for side, expected in ((1, front), (-1, behind)):
        light = Light("directional", intensity=3.0, direction=(0.0, np.sin(0.4), -side * np.cos(0.4)))
        model = scene(plate(), materials=[wall], lights=(light,))
        pixels = picture(tracer, model, Camera.look_at((0, 0, 3), (0, 0, 0), fov_y=0.1), (16, 16), spp=16,
                         fresnel="exact", background="none")
        assert pixels[..., :3].mean(axis=(0, 1)) == pytest.approx(expected, rel=0.005)


def test_extreme_media_give_finite_pictures(tracer):
    for sigma_t, g, color in ((1e-6, 0.99, 1.0), (1.0, -0.99, 1.0), (1e4, 0.0, 1e-3), (30.0, 0.99, 1.0)):
        model = scene(sphere(segments=24), materials=[fog(sigma_t, color, g)], environment=constant(),
                      lights=(Light("point", intensity=1.0, position=(0.0, 0.0, 0.0)),))
        for camera in (Camera.look_at((0, 0, 1.0), (0, 0, 0)), Camera.look_at((0, 0, 0), (1, 0, 0))):
            pixels = picture(tracer, model, camera, (4, 4), spp=2)
            assert (pixels >= 0).all()


@pytest.fixture(scope="module")
def everything_in_fog() -> Scene:
    pane = Material(base_color=(0.5, 0.5, 0.5, 0.5), alpha_mode="blend", double_sided=True)
    return scene(box((1.0, 1.0, 1.0)), (sphere(1), moved((0.3, 0, 0.2), 0.3)), (plate(2), moved((0, 0, 0.5))),
                 (sphere(3), moved((-0.4, 0.2, 0), 0.3)), (box((2.0, 0.1, 2.0), 4), moved((0, -1.2, 0))),
                 materials=[fog((0.5, 1.0, 2.0), 0.7, 0.5), replace(GLASS, ior=1.5), pane, fog(2.0, 0.3), WHITE],
                 environment=constant(0.3), lights=(Light("point", intensity=2.0, position=(1.5, 1.5, 1.0)),))


def test_both_intersectors_trace_the_same(context, everything_in_fog):
    from viewer.trace.tracer import Tracer

    pictures = []
    for intersector in ("embree", "bvh"):
        tracer = Tracer(context, intersector=intersector)
        camera = Camera.look_at((1, 1, 4), (0, 0, 0))
        pictures.append(picture(tracer, everything_in_fog, camera, (24, 24), spp=16)[..., :3])
        tracer.release()
    assert np.median(np.abs(pictures[0] - pictures[1])) < 1e-4  # rounding sends few paths another way
    assert pictures[0].mean() == pytest.approx(pictures[1].mean(), rel=0.01)


@pytest.mark.parametrize("intersector", ["embree", "bvh"])
def test_shadow_rays_cross_mirrored_solids(context, intersector):
    """The sun on a floor behind a medium, whose mesh is placed by a matrix of either hand."""
    from viewer.trace.tracer import Tracer

    medium = fog(1.0, 1e-4)
    tracer = Tracer(context, intersector=intersector)
    for scale in ((1.0, 1.0, 1.0), (-1.0, 1.0, 1.0)):
        model = scene((box((1.0, 1.0, 1.0)), moved((0, 0, 0), scale)), (plate(1, 3.0), facing_floor(y=-1.5)),
                      materials=[medium, WHITE], lights=(Light("directional", intensity=3.0, direction=(0, -1, 0)),))
        beneath = Camera.look_at((0, -1.2, 2.5), (0, -1.5, 0), fov_y=0.05)
        pixels = picture(tracer, model, beneath, (8, 8), spp=4)
        assert pixels[..., :3].mean() == pytest.approx(3 / np.pi * np.exp(-2 * medium.medium.sigma_t[0]), rel=0.03)
    tracer.release()


def test_a_scene_without_scattering_has_no_code_for_it(everything_in_fog):
    clear = replace(everything_in_fog, materials=tuple(
        replace(m, scatter_color=(0.0, 0.0, 0.0)) for m in everything_in_fog.materials))
    settings = Settings.of(mode="path")
    plans = [plan_without_device(model, settings) for model in (everything_in_fog, clear)]
    names = [set(plan.programs) for plan in plans]
    assert names[0] - names[1] == {"medium", "airlight", "boundary"}
    assert not any(program["HAS_SCATTERING"] for name, program in plans[1].programs.items() if name in (
        "generate", "classify", "finish", "glass", "surface"))
    assert "scattering in volumes" in plans[0].used and "scattering in volumes: the scene has none" in plans[1].left_out


def test_paths_that_would_not_end_are_counted(tracer, monkeypatch):
    """With a bound of few collisions: such samples are left out, and in a furnace those that remain are right."""
    model = scene(sphere(segments=16), materials=[fog(10.0, 1.0)], environment=constant())
    bad = []
    for bound in (10, 8000):
        monkeypatch.setitem(defines._CONSTANTS, "MOST_STEPS", bound)
        path_render = tracer.begin(model, orthographic(0, 0, height=1.0), Settings.of(
            mode="path", spp=32, fresnel="exact", sampling="bsdf"), (4, 4))
        while not path_render.is_done:
            path_render.step(1.0)
        bad.append(path_render.bad_samples)
        assert path_render.image().linear[..., :3] == pytest.approx(1, abs=1e-3)
        path_render.release()
    assert 20 < bad[0] < 500 and bad[1] == 0
