"""Photons on top of pictures of the raster: the light that it lacks, and nothing else."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from shapes import WHITE, facing_floor, moved, plate, scene, sphere

from viewer.jobs.info import describe_scene
from viewer.plan.warnings import sample_warnings
from viewer.raster.caustics import photon_settings
from viewer.scene.camera import Camera
from viewer.scene.environment import Environment
from viewer.scene.light import Light
from viewer.scene.material import Material
from viewer.settings import Settings

GLASS = Material(metallic=0.0, perceptual_roughness=0.0, transmission=1.0, thickness=1.0)
MIRROR = Material(metallic=1.0, perceptual_roughness=0.0, base_color=(0.9, 0.9, 0.9, 1.0))
GREY = replace(WHITE, base_color=(0.5, 0.5, 0.5, 1.0))
LAMP = Light("point", intensity=10.0, position=(0.2, 2.4, 0.1))
BELOW = Camera.look_at((0, 0.5, 1.2), (0, 0, 0.1), fov_y=np.radians(50))
"""Looks at the floor from below what is at y = 1, with none of it in the picture."""
PHOTONS = Settings(caustics="photons", photons=8, antialias="none")
SIZE = (24, 16)


def floor_below(*meshes, material: Material = GLASS, lights=(LAMP,), **changes):
    return scene((plate(0, half=3.0), facing_floor()), *meshes, materials=[GREY, material], lights=lights, **changes)


def ball(material: Material = GLASS, **changes):
    return floor_below((sphere(1, 32), moved((0, 1.2, 0), 0.4)), material=material, **changes)


def light_of(renderer, model, settings: Settings = PHOTONS, camera: Camera = BELOW) -> np.ndarray:
    return renderer.render(model, camera, settings, SIZE).linear[..., :3].astype(np.float64)


TO_THE_RIGHT = np.array([[0, 0, 1, -1.5], [0, 1, 0, 0.5], [-1, 0, 0, 0], [0, 0, 0, 1.0]])
"""Stands a plate up at the left, facing +X."""


@pytest.mark.parametrize("model", (ball(), floor_below((plate(1), TO_THE_RIGHT), material=MIRROR)),
                         ids=("glass", "mirror"))
def test_it_adds_what_photons_bring_in_mode_path(renderer, tracer, model):
    added = light_of(renderer, model) - light_of(renderer, model, replace(PHOTONS, caustics="off"))
    path = Settings(mode="path", spp=8, seed=3)
    traced = [tracer.render(model, BELOW, replace(path, caustics=caustics), SIZE).linear[..., :3].astype(np.float64)
              for caustics in ("photons", "off")]
    expected = traced[0] - traced[1]
    assert expected.mean() > 1e-3
    assert added.mean() == pytest.approx(expected.mean(), rel=0.1)  # of 3072 photons each, with other numbers


def test_the_caustic_of_a_ball_lies_in_its_shadow(renderer):
    """The raster's shadow below the ball is black, and more light than without the ball falls on its middle."""
    bare, dark = light_of(renderer, floor_below()), light_of(renderer, ball(), replace(PHOTONS, caustics="off"))
    lit = light_of(renderer, ball(), replace(PHOTONS, photons=64))
    shadow = (dark < 1e-3 * bare).all(axis=-1)
    assert 10 < shadow.sum() < 0.5 * shadow.size
    assert lit[shadow].max() > 1.5 * bare[shadow].max()
    assert np.abs(lit - dark)[~shadow].mean() < 0.05 * bare.mean()


def test_nothing_is_missing_or_counted_twice_below_glass_that_does_not_refract(renderer):
    """The light of the lamp is that of the floor alone, whether photons bring it or shadow maps let it through."""
    pane = floor_below((plate(1, half=3.0), moved((0, 1, 0)) @ facing_floor()), material=replace(
        GLASS, ior=1.0, thickness=0.0, double_sided=True))
    expected = light_of(renderer, floor_below())
    assert light_of(renderer, pane, replace(PHOTONS, photons=256)).mean() == pytest.approx(expected.mean(), rel=0.01)
    clear = light_of(renderer, pane, replace(PHOTONS, caustics="off"))
    np.testing.assert_allclose(clear, expected, rtol=0.02, atol=1e-3 * expected.max())


PANE = replace(GLASS, base_color=(0.9, 0.6, 0.3, 1.0), ior=1.0, thickness=0.0, double_sided=True)
SUN = Light("directional", intensity=3.0, direction=(0.28, -0.96, 0.0))


def below_pane(material: Material = PANE, **changes):
    return floor_below((plate(1, half=3.0), facing_floor(y=1.0)), material=material, **changes)


@pytest.fixture(scope="module")
def sunny() -> Environment:
    """Whose sun the raster takes out of it as a light."""
    radiance = np.full((256, 512, 3), 0.05, np.float32)
    radiance[32:34, 240:243] = 4000.0
    return Environment("sunny", radiance)


def test_a_directional_light_through_a_pane_against_its_closed_form(renderer):
    """Photons bring it in the pane's colour: albedo / pi times the irradiance of a slanting sun."""
    found = light_of(renderer, below_pane(lights=(SUN,)), replace(PHOTONS, photons=256))[SIZE[1] // 2:]
    expected = 0.5 / np.pi * 3.0 * 0.96 * np.array(PANE.base_color[:3])
    assert found.mean(axis=(0, 1)) == pytest.approx(expected, rel=0.01)


def test_photons_take_nothing_from_suns_of_the_environment(renderer, sunny):
    """No photon brings their light, so that shadow maps let it through panes as without photons: to the bit if there is
    no lamp, and beside a lamp as the sum of both."""
    alone, with_lamp = (below_pane(lights=lights, environment=sunny) for lights in ((), (SUN,)))
    sky = light_of(renderer, alone)
    assert np.array_equal(sky, light_of(renderer, alone, replace(PHOTONS, caustics="off")))
    assert sky[SIZE[1] // 2:].mean() > 0.1  # most of it is the sun's
    both = light_of(renderer, with_lamp)
    lamp = light_of(renderer, below_pane(lights=(SUN,)))
    assert both == pytest.approx(sky + lamp, rel=0.01)


def test_why_there_are_no_photons_is_told(renderer):
    rough = replace(GLASS, perceptual_roughness=0.4)
    cases = {"no surface is smooth": (ball(rough), PHOTONS), "there is no point, spot": (ball(lights=()), PHOTONS),
             "shadows off": (ball(), replace(PHOTONS, shadows="off"))}
    for reason, (model, settings) in cases.items():
        image = renderer.render(model, BELOW, settings, SIZE)
        plain = renderer.render(model, BELOW, replace(settings, caustics="off"), SIZE)
        assert np.array_equal(image.linear, plain.linear) and "photons" not in image.stats
        (line,) = (line for line in sample_warnings(image.stats) if line.startswith("caustics has no effect"))
        assert reason in line
        assert any(reason in line for line in describe_scene(model, settings)["plan"]["left_out"])
        assert not any("photons" in line for line in (*image.stats["plan"]["used"], *plain.stats["plan"]["left_out"]))
    image = renderer.render(ball(), BELOW, PHOTONS, SIZE)
    assert image.stats["photons"] >= 8 * SIZE[0] * SIZE[1] and image.stats["bad_splats"] == 0
    told = "photons from 1 light to 1 smooth surface"
    assert told in image.stats["plan"]["used"] and told in describe_scene(ball(), PHOTONS)["plan"]["used"]


def test_photons_gather_while_a_picture_stays(renderer):
    """With `keeps_photons` none are traced at once; the same view keeps what it has, with another number, exposure or
    antialiasing, too, and another view begins anew."""
    model = ball()

    def draw(camera: Camera = BELOW, **changes) -> None:
        renderer.draw(model, camera, replace(PHOTONS, **changes), SIZE, still=True, half=False, keeps_photons=True)

    draw()
    assert renderer.photons_each == 0
    rounds = 0
    while renderer.photons_each < 8:
        rounds += renderer.add_photons(0.0, min(2 * renderer.photons_each + 1, 8))
    assert rounds >= 3 and not renderer.add_photons(0.0, 8)
    gathered = renderer.read_radiance()[..., :3]
    whole = light_of(renderer, model)
    assert gathered.mean() == pytest.approx(whole.mean(), rel=1e-4)
    draw()
    renderer.add_photons(math.inf, 8)
    draw(exposure=1.0, photons=2, antialias="ssaa-4", background=(1.0, 0.0, 0.0))
    assert renderer.photons_each >= 8
    draw(replace(BELOW, fov_y=0.5))
    assert renderer.photons_each == 0
    renderer.draw(model, BELOW, PHOTONS, SIZE)  # of a moving camera
    assert renderer.photons_each == math.inf and not renderer.add_photons(0.0, 8)
    renderer.draw(model, BELOW, PHOTONS, SIZE, still=True, part=(0, 0, 8, 16))
    assert renderer.photons_each == math.inf


def test_photons_do_not_depend_on_settings_of_another_mode():
    """Those of mode path are no business of mode pbr, and those of the raster are none of photons."""
    plain = photon_settings(PHOTONS)
    changed = replace(PHOTONS, bounces=2, light_radius=0.3, clamp=1.0, seed=4, spp=3, antialias="ssaa-4", exposure=2.0,
                      environment_shadows="16", photons=3)
    assert photon_settings(changed) == plain and plain.mode == "path" and plain.caustics == "photons"
    assert photon_settings(replace(PHOTONS, ndf="beckmann")) != plain
