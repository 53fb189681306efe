"""Pictures of fibres whose radiance is known: furnaces, and one fibre alone."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import numpy as np
import pytest
from needs import needs
from pictures import picture
from shapes import constant, facing_floor, moved, orthographic, plate, scene, sphere
from strands import straight, strands

from viewer.gpu.context import Context
from viewer.scene.camera import Camera
from viewer.scene.light import Light
from viewer.scene.material import Material
from viewer.scene.scene import Scene
from viewer.settings import Settings
from viewer.trace.scene.traced_scene import plan_without_device
from viewer.trace.tracer import Tracer

WHITE_HAIR = {"hair_absorption": (0.0, 0.0, 0.0), "bounces": 255}
GLASS = Material(transmission=1.0, metallic=0.0, perceptual_roughness=0.0, ior=1.3)
DENSE = {"hair_absorption": (1e4, 1e4, 1e4)}
SMALL = (24, 24)


@pytest.fixture(scope="module", params=[pytest.param("embree", marks=needs("embree")), "bvh"])
def either(request: pytest.FixtureRequest, context: Context) -> Iterator[Tracer]:
    """A tracer with each of the intersectors."""
    tracer = Tracer(context, intersector=request.param)
    yield tracer
    tracer.release()


def tuft(environment: bool = True, count: int = 16, radius: float = 0.12) -> Scene:
    return Scene("tuft", curves=strands(count, 5, radius), environment=constant() if environment else None)


def seen_from(shown: Scene) -> Camera:
    return Camera.orbit(shown.center, 2.8 * shown.radius, 0.3, 0.2)


def fresnel(cosine: np.ndarray, eta: float) -> np.ndarray:
    t = np.sqrt(1 - (1 - cosine**2) / eta**2)
    s, p = (cosine - eta * t) / (cosine + eta * t), (eta * cosine - t) / (eta * cosine + t)
    return (s**2 + p**2) / 2


def test_white_fibres_lose_no_light(either: Tracer) -> None:
    """Nothing is absorbed, and light comes from everywhere: however often paths are scattered, radiance is 1."""
    shown = tuft()
    found = picture(either, shown, seen_from(shown), SMALL, spp=32, **WHITE_HAIR)
    assert found[..., :3].mean() == pytest.approx(1, abs=0.004)


@pytest.mark.parametrize("settings", [{"fog": 0.5, "fog_g": 0.5}, {"fog": 1.0, "fog_height": 0.5}])
def test_white_fibres_in_white_fog_lose_no_light(either: Tracer, settings: dict[str, object]) -> None:
    shown = tuft()
    found = picture(either, shown, seen_from(shown), (16, 16), spp=16, **WHITE_HAIR, **settings)
    assert found[..., :3].mean() == pytest.approx(1, abs=0.012)


def test_white_fibres_in_glass_lose_no_light(either: Tracer) -> None:
    shown = scene((sphere(), moved((0, 0, 0), 3.0)), materials=[GLASS], environment=constant())
    shown = replace(shown, curves=tuft().curves)
    found = picture(either, shown, Camera.orbit((0, 0, 0), 9.0, 0.3, 0.2), (16, 16), spp=16, **WHITE_HAIR)
    assert found[..., :3].mean() == pytest.approx(1, abs=0.012)


@pytest.mark.parametrize("radius", [0.2, 1e-3, 1e-5])
def test_a_dense_fibre_shows_what_its_surface_reflects(tracer: Tracer, radius: float) -> None:
    """All light that enters is absorbed. Of light from everywhere the offset h reflects F(sqrt(1 - h^2)), where the
    view is across. Light is sampled, or hit, or both."""
    shown = Scene("fibre", curves=(straight(radius),), environment=constant())
    camera = orthographic(0.0, height=1.8 * radius)
    h = 0.9 * ((np.arange(2000) + 0.5) / 1000 - 1)
    expected = fresnel(np.sqrt(1 - h**2), 1.55).mean()
    for sampling, slack in (("mis", 0.003), ("bsdf", 0.003), ("lights", 0.01)):
        found = picture(tracer, shown, camera, (16, 16), spp=64, sampling=sampling, **DENSE)[..., :3].mean()
        assert found == pytest.approx(expected, abs=slack)


def test_a_fibre_shades_what_is_behind_it(either: Tracer) -> None:
    """Light falls at 45 degrees, so that a fibre half a unit above the floor throws its shadow half a unit away."""
    sun = Light("directional", intensity=np.pi, direction=(0, -1, -1))
    floor = scene((plate(), facing_floor(1.0, -0.5)), lights=(sun,))
    shown = replace(floor, curves=(straight(0.1, half=3.0),))
    camera = Camera.look_at((0, 4, 0.001), (0, -0.5, 0), fov_y=np.radians(20))
    bare, hairy = (picture(either, model, camera, (16, 32), spp=16, **DENSE)[..., 0].mean(axis=1)
                   for model in (floor, shown))
    z = 4.5 * np.tan(np.radians(10)) * (2 * (np.arange(32) + 0.5) / 32 - 1)  # of the rows, on the floor
    shadow, open_floor = abs(z + 0.5) < 0.1, (abs(z + 0.5) > 0.2) & (abs(z) > 0.2)
    assert (hairy[shadow] < 0.1 * bare[shadow]).all()
    np.testing.assert_allclose(hairy[open_floor], bare[open_floor], rtol=0.15)


def test_layers_show_the_nearest_fibre(tracer: Tracer) -> None:
    shown = Scene("fibre", curves=(straight(0.2),), environment=constant())
    camera = orthographic(0.0, height=1.0)
    image = tracer.render(shown, camera, Settings.of(mode="path", spp=8, denoise="off", **DENSE), (33, 33),
                          layers=("albedo", "normal", "distance"))
    middle = 16
    distance = np.linalg.norm(camera.eye)
    assert image.layers["distance"][middle, middle] == pytest.approx(distance - 0.2, abs=2e-3)
    np.testing.assert_allclose(image.layers["normal"][middle, middle], (0, 0, 1), atol=0.02)
    assert image.layers["normal"][middle - 5, middle, 1] > 0.3
    np.testing.assert_allclose(image.layers["albedo"][middle, middle], ((1.55 - 1) / (1.55 + 1)) ** 2, rtol=0.05)
    assert np.isinf(image.layers["distance"][0, 0])


def test_what_shows_through_open_alpha_is_hair(either: Tracer) -> None:
    """A plate of alpha 0 before and behind the fibres changes nothing."""
    clear = Material(alpha_mode="blend", base_color=(1.0, 1.0, 1.0, 0.0), double_sided=True)
    shown = tuft()
    plates = scene((plate(), moved((0, 0, 1.2), 0.4)), (plate(), moved((0, 0, -1.2), 0.4)), materials=[clear, clear],
                   environment=constant())
    both = replace(plates, curves=shown.curves)
    found = [picture(either, scene_, seen_from(both), (16, 16), spp=32, hair_melanin=(0.3, 0.1))[..., :3].mean()
             for scene_ in (replace(both, instances=(), meshes=(), materials=()), both)]
    assert found[1] == pytest.approx(found[0], rel=0.02)


def test_colours_of_files_count_unless_a_setting_gives_one(tracer: Tracer) -> None:
    camera = orthographic(0.0, height=1.0)
    red = Scene("red", curves=(straight(0.15, y=0.25, colors=(0.05, 0.05, 0.9)), straight(0.15, y=-0.25)),
                environment=constant())
    found = picture(tracer, red, camera, SMALL, spp=16, hair_roughness=(0.3, 0.3))[..., :3]
    upper, lower = found[6].mean(axis=0), found[-7].mean(axis=0)
    assert upper[2] > 1.5 * upper[0] and lower[2] < 0.5 * lower[0]
    given = picture(tracer, red, camera, SMALL, spp=16, hair_absorption=(0.2, 0.2, 0.2))[..., :3]
    np.testing.assert_allclose(given[..., 0], given[..., 1], rtol=1e-5)


def test_the_radius_of_the_setting_is_that_of_the_picture(tracer: Tracer) -> None:
    thin = Scene("thin", curves=(straight(0.01),), environment=constant())
    camera = orthographic(0.0, height=1.0)
    covered = [(1 - picture(tracer, thin, camera, SMALL, spp=16, background="none", curve_radius=radius)[..., 3]).mean()
               for radius in (0.0, 0.1, 0.0)]
    assert 1 - covered[0] == pytest.approx(0.02, abs=0.004) and covered[2] == covered[0]
    assert 1 - covered[1] == pytest.approx(0.2, abs=0.004)


def test_only_a_scene_with_curves_has_their_programs() -> None:
    settings = Settings.of(mode="path", denoise="fast")
    bare = plan_without_device(scene(plate(), environment=constant()), settings)
    hairy = plan_without_device(tuft(), settings)
    assert "fibre" in hairy.surfaces and "fibre layers" in hairy.programs
    assert "65 round segments of 16 strands" in hairy.used
    assert "fibre" not in bare.programs and "fibre layers" not in bare.programs
    assert {program["HAS_CURVES"] for name, program in bare.programs.items() if name.startswith("classify")} == {0}
    assert "curves: the scene has none" in bare.left_out
