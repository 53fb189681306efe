"""Thin smooth panes, through which shadow rays go straight on: against closed forms in float64, and without a pane."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from pictures import picture
from shapes import WHITE, constant, facing_floor, lopsided, moved, plate, scene, sphere

from viewer.gpu.context import Context
from viewer.scene.camera import Camera
from viewer.scene.environment import Environment
from viewer.scene.light import Light
from viewer.scene.material import Material
from viewer.scene.scene import Scene
from viewer.settings import Settings
from viewer.trace.scene.traced_scene import plan_without_device
from viewer.trace.tracer import Tracer

PANE = Material(metallic=0.0, perceptual_roughness=0.0, transmission=1.0)
GREY = replace(WHITE, base_color=(0.5, 0.5, 0.5, 1.0))
LAMP = replace(WHITE, base_color=(0, 0, 0, 1), emissive=(9.0, 6.0, 3.0), double_sided=True)
POINT = Light("point", intensity=10.0, position=(0.4, 2.4, 0.1))
SUN = Light("directional", intensity=3.0, direction=(-0.28, -0.96, 0.0))
LAMPS = {"point": POINT, "sun": SUN}
CLEAR = replace(PANE, ior=1.0)
BULB = replace(POINT, position=(0.4, 1.4, 0.1))
LIT: dict[str, Any] = {"lights": (POINT,), "lamp": LAMP, "environment": lopsided()}
FOG: dict[str, Any] = {"fog": 0.4, "fog_albedo": (0.9, 0.9, 0.9), "bounces": 3}
BELOW = Camera.look_at((0, 0.4, 0.5), (0, 0, 0.1), fov_y=np.radians(36))
"""Looks at the floor from below all panes."""
SIZE = (12, 8)


@pytest.fixture(scope="module", params=["embree", "bvh"])
def either(context: Context, request: pytest.FixtureRequest) -> Iterator[Tracer]:
    """A tracer with each of the intersectors."""
    tracer = Tracer(context, intersector=request.param)
    yield tracer
    tracer.release()


def room(*panes: Material, half: float = 4.0, lowest: float = 0.6, lights: tuple[Light, ...] = (),
         lamp: Material | None = None, environment: Environment | None = None) -> Scene:
    """A grey floor below panes, from the `lowest` upwards, every 0.2; a lamp of area above them."""
    meshes = [(plate(0, half=4.0), facing_floor())]
    meshes += [(plate(1, half=0.5), facing_floor(y=2.0))] * (lamp is not None)
    meshes += [(plate(2 + k, half=half), facing_floor(y=lowest + 0.2 * k)) for k in range(len(panes))]
    return scene(*meshes, materials=[GREY, lamp or LAMP, *panes], lights=lights, environment=environment)


def transmitted(cosine: np.ndarray, ior: float = 1.5) -> np.ndarray:
    """1 - 2 R / (1 + R): what leaves a wall on the other side, all reflections inside included."""
    inside = np.sqrt(1 - (1 - cosine**2) / ior**2)
    s = ((cosine - ior * inside) / (cosine + ior * inside)) ** 2
    p = ((ior * cosine - inside) / (ior * cosine + inside)) ** 2
    r = (s + p) / 2
    return 1 - 2 * r / (1 + r)


def floor_points(size: tuple[int, int], each: int = 3) -> np.ndarray:
    """Where the rays of BELOW through each^2 points of every pixel meet y = 0, (H, W, each^2, 3)."""
    width, height = size
    tan = np.tan(BELOW.fov_y / 2)
    x = ((np.arange(width * each) + 0.5) / (width * each) * 2 - 1) * tan * width / height
    y = (1 - (np.arange(height * each) + 0.5) / (height * each) * 2) * tan
    x, y = np.meshgrid(x, y)
    d = BELOW.forward + x[..., None] * BELOW.pose[:3, 0] + y[..., None] * BELOW.pose[:3, 1]
    points = BELOW.eye - BELOW.eye[1] / d[..., 1:2] * d
    return points.reshape(height, each, width, each, 3).swapaxes(1, 2).reshape(height, width, each * each, 3)


def test_a_lamp_shines_through_panes_in_a_row(either):
    """Each takes what it reflects, and tints the rest; one lets only a share through, one covers half."""
    tinted = replace(PANE, base_color=(0.9, 0.5, 0.1, 1.0))
    partly = replace(PANE, transmission=0.8, metallic=0.25, base_color=(1.0, 1.0, 0.5, 1.0), ior=1.3)
    pixels = picture(either, room(tinted, partly, tinted, lights=(POINT,)), BELOW, SIZE, spp=64, bounces=1)[..., :3]
    to_lamp = np.array(POINT.position) - floor_points(SIZE)
    distance = np.linalg.norm(to_lamp, axis=-1)
    cosine = to_lamp[..., 1] / distance
    left = transmitted(cosine) ** 2 * transmitted(cosine, 1.3) * 0.8 * 0.75
    expected = (0.5 / np.pi * 10.0 * cosine / distance**2 * left).mean(axis=2)[..., None] * [0.81, 0.25, 0.005]
    np.testing.assert_allclose(pixels, expected, rtol=0.01)


def test_what_alpha_leaves_open_takes_nothing(either):
    covering = replace(PANE, base_color=(0.2, 0.2, 0.2, 0.25), alpha_mode="blend", ior=1.0)
    found = picture(either, room(covering, lights=(POINT,)), BELOW, SIZE, spp=128, bounces=1)[..., :3]
    bare = picture(either, room(lights=(POINT,)), BELOW, SIZE, spp=16, bounces=1)[..., :3]
    assert found.mean() == pytest.approx((0.75 + 0.25 * 0.2) * bare.mean(), rel=0.01)


@pytest.mark.parametrize("bounces", [1, 4])
def test_panes_of_index_1_change_nothing(tracer, bounces):
    """Light of all kinds, which light samples and BSDF samples find, is found once, also at the last bounce."""
    found, expected = (picture(tracer, room(*panes, **LIT), BELOW, SIZE, spp=512, bounces=bounces)[..., :3]
                       for panes in ((CLEAR, CLEAR), ()))
    assert found.mean(axis=(0, 1)) == pytest.approx(expected.mean(axis=(0, 1)), rel=0.01)


@pytest.mark.parametrize("sampling", ["mis", "bsdf", "lights"])
def test_the_sky_through_a_pane_against_its_closed_form(tracer, sampling):
    """Whichever samples find it: 2 times the integral of T(mu) mu dmu, times the albedo."""
    model = room(replace(PANE, base_color=(0.8, 0.6, 1.0, 1.0)), half=60.0, environment=constant())
    pixels = picture(tracer, model, BELOW, SIZE, spp=256, bounces=1, sampling=sampling)[..., :3]
    mu = (np.arange(20_000) + 0.5) / 20_000
    expected = 0.5 * 2 * (transmitted(mu) * mu).mean() * np.array([0.8, 0.6, 1.0])
    assert pixels.mean(axis=(0, 1)) == pytest.approx(expected, rel=4e-3)


def test_a_lamp_of_area_over_a_mixed_pane(tracer):
    """Where the wall is partly opaque, a path that goes on has a shadow ray of its own, too. Weights that do not add up
    to 1 would make the mean differ from that of light samples alone; with fog, paths are stored in another way."""
    model = room(replace(PANE, transmission=0.7, double_sided=True), lamp=LAMP)
    alone = picture(tracer, model, BELOW, (6, 4), spp=512, sampling="lights")[..., :3].mean(axis=(0, 1))
    for fog in (0.0, 1e-6):
        both = picture(tracer, model, BELOW, (6, 4), spp=256, fog=fog)[..., :3].mean(axis=(0, 1))
        assert both == pytest.approx(alone, rel=0.02)


def test_light_through_a_pane_into_fog(tracer):
    """Light that fog scatters below a pane of index 1, from lamps above: as if the pane were below the floor."""
    lit = {"lights": (BULB,), "lamp": LAMP}
    found, expected = (picture(tracer, room(CLEAR, lowest=lowest, **lit), BELOW, (6, 4), spp=64, **FOG)[..., :3]
                       for lowest in (0.6, -0.6))
    assert found.mean(axis=(0, 1)) == pytest.approx(expected.mean(axis=(0, 1)), rel=0.06)


def test_the_bvh_takes_what_embree_takes(context):
    """The same paths, so that few samples do: light of all kinds through panes, and light from fog."""
    tinted = replace(PANE, base_color=(0.9, 0.5, 0.1, 1.0), transmission=0.8)
    found, expected = [], []
    for intersector, pictures in (("bvh", found), ("embree", expected)):
        tracer = Tracer(context, intersector=intersector)
        pictures += [picture(tracer, room(tinted, CLEAR, **LIT), BELOW, SIZE, spp=16, bounces=4)[..., :3],
                     picture(tracer, room(tinted, lights=(BULB,), lamp=LAMP), BELOW, SIZE, spp=8, **FOG)[..., :3]]
        tracer.release()
    for ours, theirs in zip(found, expected, strict=True):
        assert theirs.min() > 0
        assert np.abs(ours - theirs).mean() < 0.002 * theirs.mean()


@pytest.mark.parametrize("light", LAMPS)
def test_photons_leave_to_shadow_rays_what_they_bring(tracer, light):
    """A photon that only panes have let through is not added: what is left of this scene's photons is nothing."""
    model = room(PANE, PANE, lights=(LAMPS[light],))
    with_photons, without = (picture(tracer, model, BELOW, SIZE, spp=4, caustics=caustics, bounces=3)[..., :3]
                             for caustics in ("photons", "off"))
    assert np.array_equal(with_photons, without)
    assert without.min() > 0


@pytest.mark.parametrize(("light", "noise"), [("point", 0.1), ("sun", 0.2)])
def test_photons_are_seen_through_a_pane(tracer, light, noise):
    """The caustic of a ball below a pane of index 1, and behind another: as with the panes out of the way. Fewer of a
    sun's photons meet the ball, since they are aimed at a disk about the whole pane."""
    ball = replace(PANE, thickness=1.0)

    def bright(above: float, beside: float) -> np.ndarray:
        plain = room(CLEAR, lights=(LAMPS[light],), lowest=above)
        under = (sphere(len(plain.materials), 48), moved((0.1, 0.3, 0.1), 0.1))
        instances = [(plain.meshes[i.mesh], i.transform) for i in plain.instances]
        upright = (plate(2, half=0.3), moved((0, 0.3, beside)))
        model = scene(*instances, under, upright, materials=[*plain.materials, ball], lights=plain.lights)
        return picture(tracer, model, BELOW, (6, 4), spp=512, caustics="photons", bounces=6)[..., :3]

    found, expected = bright(0.6, 0.4), bright(-0.6, 2.0)
    assert found.mean() == pytest.approx(expected.mean(), rel=0.03)
    assert np.abs(found - expected).mean() < noise * expected.mean()


def test_only_scenes_with_panes_have_code_for_them():
    settings = Settings.of(mode="path")
    for changes, has in (({}, 1), ({"perceptual_roughness": 0.3}, 0), ({"thickness": 1.0}, 0), ({"clearcoat": 1.0}, 0)):
        plan = plan_without_device(room(replace(PANE, **changes), lights=(POINT,)), settings)
        switches = [dict(program.switches) for program in plan.programs.values()]
        assert {program["HAS_PANES"] for program in switches if "HAS_PANES" in program} == {has}
        assert ("shadow rays through thin smooth panes" in plan.used) == has
        is_missed = not has and "perceptual_roughness" not in changes
        assert any("no path from the camera" in line for line in plan.left_out) == is_missed
