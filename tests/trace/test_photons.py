"""Light that photons bring: against closed forms in float64, and against the same scene without glass."""

from __future__ import annotations

import math
from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
from pictures import picture
from shapes import WHITE, constant, facing_floor, moved, plate, scene, sphere

from viewer.measure.compare.relmse import reduced
from viewer.plan.warnings import sample_warnings
from viewer.scene.camera import Camera
from viewer.scene.light import Light
from viewer.scene.material import Material
from viewer.scene.scene import Instance, Scene
from viewer.settings import Settings
from viewer.trace.layout import TILE
from viewer.trace.paths import wavefront_maker
from viewer.trace.paths.photon_render import MOST_EACH, SEQUENCE, Numbers
from viewer.trace.scene.traced_scene import plan_without_device
from viewer.trace.tracer import Tracer

GLASS = Material(metallic=0.0, perceptual_roughness=0.0, transmission=1.0, thickness=1.0)
GREY = replace(WHITE, base_color=(0.5, 0.5, 0.5, 1.0))
POINT = Light("point", intensity=10.0, position=(0.2, 2.4, 0.1))
BELOW = Camera.look_at((0, 0.9, 0.9), (0, 0, 0.1), fov_y=np.radians(36))
"""Looks at the floor from below the slab."""
BESIDE = replace(Camera.look_at((0, 1.0, 2.85), (0, 0, 0.1)), height=0.5)
"""Orthographic; its rays, which begin behind it, pass below the slab."""
FLIPPED = np.diag([1.0, -1.0, -1.0, 1.0])


def slab(light: Light, ior: float, pieces: int = 1, unit: float = 1.0, intensity: float = 1.0) -> Scene:
    """A slab of glass between y = 1 and y = 1.4, in pieces side by side, over a grey floor."""
    glass = replace(GLASS, ior=ior)
    width = 3.0 / pieces
    meshes = [(plate(0, half=3.0), facing_floor())]
    for k in range(pieces):
        shape = moved((width * (k + 0.5) - 1.5, 0, 0), (1 / pieces, 1, 1))
        meshes += [(plate(1, half=1.5), shape @ facing_floor(y=1.4)),
                   (plate(1, half=1.5), shape @ moved((0, 1, 0)) @ FLIPPED @ facing_floor())]
    made = scene(*meshes, materials=[GREY, glass],
                 lights=(replace(light, intensity=light.intensity * intensity,
                                 position=tuple(unit * x for x in light.position)),))
    bigger = np.diag([unit, unit, unit, 1.0])
    return replace(made, instances=tuple(Instance(i.mesh, bigger @ i.transform) for i in made.instances))


def floor_points(camera: Camera, size: int, each: int = 3) -> np.ndarray:
    """Where the rays through `each`^2 points of every pixel meet y = 0, (size, size, each^2, 3)."""
    steps = (np.arange(size * each) + 0.5) / (size * each) * 2 - 1
    tan = np.tan(camera.fov_y / 2)
    x, y = np.meshgrid(steps * tan, -steps * tan)
    d = camera.forward + x[..., None] * camera.pose[:3, 0] + y[..., None] * camera.pose[:3, 1]
    points = camera.eye - camera.eye[1] / d[..., 1:2] * d
    return points.reshape(size, each, size, each, 3).swapaxes(1, 2).reshape(size, size, each * each, 3)


def irradiance_below_slab(points: np.ndarray, ior: float) -> np.ndarray:
    """Of the floor by light that both faces transmit. The ring of angles [t, t + dt] about the light has the flux
    2 pi I T sin t dt, and falls on the ring [x, x + dx] of the floor: E = I T sin t / (x dx/dt)."""
    t = np.linspace(1e-5, 1.5, 200_000)
    inside = np.arcsin(np.sin(t) / ior)
    cos_o, cos_i = np.cos(t), np.cos(inside)
    reflected = (((cos_o - ior * cos_i) / (cos_o + ior * cos_i)) ** 2
                 + ((ior * cos_o - cos_i) / (ior * cos_o + cos_i)) ** 2) / 2
    x = 2.0 * np.tan(t) + 0.4 * np.tan(inside)  # 1 m above the slab and 1 m below
    e = POINT.intensity * (1 - reflected) ** 2 * np.sin(t) / (x * np.gradient(x, t))
    at = np.linalg.norm(points[..., [0, 2]] - np.array(POINT.position)[[0, 2]], axis=-1)
    return np.interp(at, x, e)


def test_caustic_of_a_slab_against_its_closed_form(tracer):
    """`bounces` 4 leaves no more than one way: through both faces to the floor."""
    model = slab(POINT, 1.5)
    pixels = picture(tracer, model, BELOW, (12, 12), spp=910, bounces=4, caustics="photons")[..., :3]
    expected = 0.5 / np.pi * irradiance_below_slab(floor_points(BELOW, 12), 1.5).mean(axis=2)
    assert pixels.mean() == pytest.approx(expected.mean(), rel=4e-3)
    assert np.abs(reduced(pixels, 4)[..., 0] / reduced(expected[..., None], 4)[..., 0] - 1).max() < 0.04
    assert picture(tracer, model, BELOW, (8, 8), spp=1, bounces=4)[..., :3].max() == 0
    out_of_range = slab(replace(POINT, range=0.9), 1.5)  # the slab is 1 m away
    assert picture(tracer, out_of_range, BELOW, (8, 8), spp=1, bounces=4, caustics="photons")[..., :3].max() == 0


def unit(*direction: float) -> tuple[float, ...]:
    return tuple((np.array(direction) / np.linalg.norm(direction)).tolist())


LIGHTS = {
    "point": POINT,
    "spot": Light("spot", intensity=10.0, position=(0.2, 2.4, 0.1), direction=unit(0.1, -1, 0.2), inner_cone=0.3,
                  outer_cone=0.8),
    "narrow spot from far away": Light("spot", intensity=1e9, position=(0, 1e4, 0), direction=(0, -1, 0),
                                       inner_cone=1e-3, outer_cone=2e-3),
    "directional": Light("directional", intensity=3.0, direction=unit(0.3, -1, 0.1)),
    "grazing": Light("directional", intensity=30.0, direction=unit(0.3, -0.4, 0.3)),
}


@pytest.mark.parametrize("name", LIGHTS)
def test_glass_of_index_1_changes_nothing(tracer, name):
    """What photons bring through it is the direct light of the same scene without glass. Three pieces are three targets
    with spheres that overlap."""
    light = LIGHTS[name]
    camera = BESIDE if name in ("spot", "grazing") else BELOW
    size = (12, 8)
    found = picture(tracer, slab(light, 1.0, pieces=3), camera, size, spp=512, caustics="photons")[..., :3]
    bare = scene((plate(0, half=3.0), facing_floor()), materials=[GREY], lights=(light,))
    expected = picture(tracer, bare, camera, size, spp=16)[..., :3]
    assert expected.mean() > 1e-4
    assert found.mean() == pytest.approx(expected.mean(), rel=4e-3)
    assert np.abs(found - expected).mean() < 0.1 * expected.mean()


@pytest.mark.parametrize("unit", (1e-6, 1e6))
def test_a_scene_of_any_size(tracer, unit):
    """A micron or a thousand kilometres; a light's intensity grows with the square."""
    camera = Camera.look_at(BELOW.eye * unit, (0, 0, 0.1 * unit), fov_y=np.radians(36))
    one, other = (picture(tracer, model, view, (8, 8), spp=2, caustics="photons") for model, view in (
        (slab(POINT, 1.5), BELOW), (slab(POINT, 1.5, unit=unit, intensity=unit * unit), camera)))
    assert one[..., :3].mean() > 0.01
    assert np.abs(one - other).mean() < 0.01 * one[..., :3].mean()


def test_no_light_is_lost_or_made_between_white_walls(tracer):
    """A lamp in the middle of a glass ball, in a room that is a ball: the glass absorbs nothing, so the wall has the
    irradiance I / R^2 / (1 - albedo) everywhere, by light that has been reflected any number of times."""
    wall = replace(WHITE, base_color=(0.6, 0.6, 0.6, 1.0), double_sided=True)
    lamp = Light("point", intensity=4.0, position=(0, 0, 0))
    room = scene((sphere(0, 64), moved((0, 0, 0), 2.0)), (sphere(1, 64), moved((0, 0, 0), 0.5)),
                 materials=[wall, replace(GLASS, ior=1.5)], lights=(lamp,))
    camera = Camera.look_at((0, 1.2, 0), (0.4, 2.0, 0.3), fov_y=np.radians(100))
    pixels = picture(tracer, room, camera, (8, 8), spp=256, bounces=64, caustics="photons")[..., :3]
    assert pixels.mean() == pytest.approx(0.6 / np.pi * 4.0 / 2.0**2 / (1 - 0.6), rel=0.01)


def test_without_smooth_surfaces_nothing_changes(tracer):
    """The same picture to the bit, no program and no photon, and the plan says why."""
    rough = replace(GLASS, perceptual_roughness=0.4)
    reasons = {"no surface is smooth": ((POINT,), rough, None), "no point, spot or directional light": (
        (), GLASS, constant())}
    for reason, (lights, glass, environment) in reasons.items():
        model = scene((plate(0, half=3.0), facing_floor()), (sphere(1, 24), moved((0, 1.2, 0), 0.4)),
                      materials=[GREY, glass], lights=lights, environment=environment)
        with_photons, without = (picture(tracer, model, BELOW, (8, 8), spp=1, caustics=caustics)
                                 for caustics in ("photons", "off"))
        assert np.array_equal(with_photons, without)
        plan = plan_without_device(model, Settings(mode="path", caustics="photons"))
        assert not plan.photons
        assert any(reason in line for line in plan.left_out)


def test_error_and_variance_count_photons(tracer):
    """Where photons alone bring light, the estimated variance is that of pictures of several seeds."""
    settings = {"mode": "path", "spp": 57, "caustics": "photons", "bounces": 4}
    means, variances = [], []
    for seed in range(12):
        path_render = tracer.begin(slab(POINT, 1.5), BELOW, Settings.of(seed=seed, **settings), (12, 12), ["variance"])
        while not path_render.is_done:
            path_render.step(1.0)
        image = path_render.image()
        assert image.stats["photons"] >= 57 * 12 * 12 and image.stats["bad_splats"] == 0
        assert 0.01 < path_render.error < 1
        path_render.release()
        means.append(image.linear[..., 0])
        variances.append(image.layers["variance"][..., 0])
    spread = np.var(means, axis=0, ddof=1).mean()
    assert 0.3 < spread / np.mean(variances) < 1.2  # low discrepancy makes it smaller than independent photons would


def test_a_caustic_in_fog(tracer):
    """A ball of index 1.0001 stops shadow rays, and photons bring what one of index 1 lets through, on the floor and in
    the fog."""
    def below(ior: float, caustics: str) -> float:
        model = scene((plate(0, half=3.0), facing_floor()), (sphere(1, 24), moved((0, 1.2, 0), 0.7)),
                      materials=[GREY, replace(GLASS, ior=ior)], lights=(POINT,))
        return picture(tracer, model, BELOW, (16, 12), fog=0.3, spp=16, caustics=caustics)[..., :3].mean()

    assert below(1.0001, "photons") == pytest.approx(below(1.0, "off"), rel=0.08)


def test_both_intersectors_trace_the_same_photons(context, tracer):
    other = Tracer(context, intersector="bvh")
    one, two = (picture(t, slab(POINT, 1.5), BELOW, (12, 8), spp=8, caustics="photons") for t in (tracer, other))
    other.release()
    assert one[..., :3].mean() > 0.01
    assert np.abs(one - two).mean() < 1e-3 * one[..., :3].mean()


def test_each_third_pixel_gets_what_it_has_in_the_whole_picture(tracer):
    """Of the same photons: both pictures have as many samples in all."""
    pictures = []
    for every in (1, 3):
        settings = Settings.of(mode="path", spp=50 * every**2, caustics="photons", bounces=4)
        path_render = tracer.begin(slab(POINT, 1.5), BELOW, settings, (18, 18), every=every)
        while not path_render.is_done:
            path_render.step(1.0)
        pictures.append(path_render.image().linear[..., 0])
        path_render.release()
    whole, few = pictures
    assert few.mean() > 0.1
    assert np.allclose(few, whole[1::3, 1::3], rtol=1e-4)


def test_photons_keep_pace_with_samples(tracer, monkeypatch):
    """Rounds come early, and each brings as many as there are samples, or as many as fit; so it is at the end."""
    monkeypatch.setattr(wavefront_maker, "SOFTWARE_SIDE", 2)
    monkeypatch.setattr(wavefront_maker, "DEVICE_SIDE", 2)
    settings = Settings.of(mode="path", spp=16, caustics="photons", bounces=4)
    size = 48, 32  # larger than a wavefront: samples come in small rounds
    path_render = tracer.begin(slab(POINT, 1.5), BELOW, settings, size)
    rounds: list[tuple[float, int]] = []
    while not path_render.is_done:
        before = path_render.film.photons
        path_render.step(0.0)
        if path_render.film.photons > before:
            rounds.append((path_render.samples * 48 * 32, path_render.film.photons))
    path_render.release()
    assert rounds[0][0] < 3 * 48 * 32
    assert len(rounds) > 5
    assert all(samples <= photons < samples + MOST_EACH * TILE * TILE for samples, photons in rounds)
    assert all(samples < 1.8 * photons + 48 * 32 for (_, photons), (samples, _) in pairwise(rounds))


def test_a_time_budget_ends_after_the_first_photons(tracer):
    """These are few, though far more samples of so small a picture are on their way at once."""
    settings = Settings.of(mode="path", time_budget=0.01, caustics="photons")
    image = tracer.render(slab(POINT, 1.5), BELOW, settings, (16, 16))
    assert 16 * 16 <= image.stats["photons"] <= 16 * 16 * 16
    assert not [line for line in sample_warnings(image.stats) if "photons arrived" in line]


def test_no_two_photons_have_the_same_numbers():
    numbers, used = Numbers(), set()
    for k in range(3 * SEQUENCE // 2):
        work = numbers.next((1, 2, 4, 4)[k % 4])
        assert work.first + work.samples <= SEQUENCE
        mine = {(work.tile_x, n) for n in range(work.first, work.first + work.samples)}
        assert not mine & used
        used |= mine
    assert {sequence for sequence, _ in used} == set(range(5))
    assert len(used) > 4 * SEQUENCE


def test_samples_that_are_numbered_on_come_with_other_photons(tracer):
    """Below the slab all light is that of photons."""
    settings, parts = Settings.of(mode="path", spp=2, caustics="photons"), []
    for first in (0, 2):
        path_render = tracer.begin(slab(POINT, 1.5), BELOW, settings, (12, 8), first=first)
        while not path_render.is_done:
            path_render.step(1.0)
        parts.append(path_render.read_radiance()[..., :3])
        path_render.release()
    assert parts[0].mean() > 0.01 and np.abs(parts[0] - parts[1]).mean() > 0.05 * parts[0].mean()


def test_why_there_are_no_photons_is_told(tracer):
    rough = replace(slab(POINT, 1.5), materials=(GREY, GREY))
    for model, told in ((slab(POINT, 1.5), "ended before the first photons"), (rough, "no surface is smooth"),
                        (replace(rough, lights=(), environment=constant()), "there is no point, spot or directional")):
        path_render = tracer.begin(model, BELOW, Settings.of(mode="path", spp=1, caustics="photons"), (8, 8))
        (line,) = sample_warnings(path_render.stats())
        path_render.release()
        assert told in line


def test_light_behind_glass_and_in_mirrors_is_measured(tracer):
    """From above, the floor that the slab lights is seen through the slab alone; from below, without it. A mirror
    that stands beside that floor shows about as much of it as there is, if it is half of the view."""
    def share(model: Scene, camera: Camera) -> float:
        settings = Settings.of(mode="path", spp=96, caustics="photons")
        path_render = tracer.begin(model, camera, settings, (24, 16))
        while not path_render.is_done:
            path_render.step(1.0)
        stats = path_render.stats()
        path_render.release()
        assert bool(sample_warnings(stats)) == (stats["photons_lost"] >= 0.01)
        return stats["photons_lost"]

    model = slab(POINT, 1.5)
    assert share(model, Camera.look_at((0, 4, 0.5), (0, 0, 0), fov_y=np.radians(20))) > 0.99
    assert share(model, BELOW) < 1e-3
    upright = np.array([[0, 0, 1, -0.4], [0, 1, 0, 0.4], [-1, 0, 0, 0.1], [0, 0, 0, 1.0]])
    mirror = replace(WHITE, metallic=1.0, perceptual_roughness=0.0, specular=0.5)
    with_mirror = replace(model, meshes=(*model.meshes, plate(2, half=0.35)), materials=(*model.materials, mirror),
                          instances=(*model.instances, Instance(len(model.meshes), upright)))
    along = Camera.look_at((1.2, 0.5, 0.1), (-0.4, 0.3, 0.1), fov_y=np.radians(40))
    assert 0.05 < share(with_mirror, along) < 0.8
    black = replace(mirror, base_color=(0.0, 0.0, 0.0, 1.0))
    assert share(replace(with_mirror, materials=(*model.materials, black)), along) < 0.03


STANDING = np.array([[0, 0, 1, -0.4], [0, 1, 0, 0.4], [-1, 0, 0, 0.1], [0, 0, 0, 1.0]])
MIRROR = replace(WHITE, metallic=1.0, perceptual_roughness=0.0, specular=0.5)
BLACK = replace(WHITE, base_color=(0.0, 0.0, 0.0, 1.0))


@pytest.mark.parametrize(("shape", "place", "smooth", "camera"), [
    (plate, STANDING, MIRROR, Camera.look_at((0.8, 0.8, 0.5), (-0.4, 0.3, 0.1), fov_y=np.radians(40))),
    (sphere, moved(BELOW.eye + 0.45 * BELOW.forward + np.array([0.12, 0, 0]), 0.2), replace(GLASS, ior=1.0), BELOW),
], ids=("mirror", "glass"))
def test_the_told_share_is_that_of_the_picture(tracer, shape, place, smooth, camera):
    """A slab of index 1 makes all light of a lamp that of photons. Without it paths find it, also in a mirror and
    through a ball of index 1, and what is gone where these are black is what photons do not bring."""
    sun = Light("directional", intensity=3.0, direction=unit(0.1, -1, 0))

    def beside(model: Scene, material: Material) -> Scene:
        made = replace(shape(), material=len(model.materials))
        return replace(model, meshes=(*model.meshes, made), materials=(*model.materials, material),
                       instances=(*model.instances, Instance(len(model.meshes), place)))

    bare = scene((plate(0, half=3.0), facing_floor()), materials=[GREY], lights=(sun,))
    whole = bare if shape is sphere else beside(bare, smooth)  # paths do not find what is behind solid glass
    light, left = (picture(tracer, model, camera, (24, 16), spp=16)[..., :3].mean()
                   for model in (whole, beside(bare, BLACK)))
    photons = tracer.begin_photons(beside(slab(sun, 1.0), smooth), camera, Settings(mode="path", caustics="photons"),
                                   (24, 16))
    photons.step(math.inf, 1 << 18)
    assert photons.lost_share == pytest.approx(1 - left / light, abs=0.1)
    assert photons.lost_share > 0.2
    photons.release()


@pytest.mark.parametrize(("intersector", "fog"), (("embree", 0.0), ("embree", 0.05), ("bvh", 0.0), ("bvh", 0.05)))
def test_the_camera_sees_through_the_back_of_a_wall(context, tracer, intersector, fog):
    """As camera rays do, those of photons pass the back of a single-sided surface, also of a mirrored one, but not the
    front."""
    to_camera = np.eye(4)
    to_camera[:3, :3] = BELOW.pose[:3, :3]
    to_camera[:3, 3] = BELOW.eye + 0.1 * BELOW.forward
    walls = {"none": None, "back": to_camera @ FLIPPED, "mirrored": to_camera @ FLIPPED @ np.diag([-1.0, 1, 1, 1]),
             "front": to_camera}
    other = tracer if intersector == "embree" else Tracer(context, intersector="bvh")
    found = {}
    for name, wall in walls.items():
        open_view = slab(POINT, 1.5)
        model = open_view if wall is None else replace(
            open_view, meshes=(*open_view.meshes, plate(0, half=0.05)),
            instances=(*open_view.instances, Instance(len(open_view.meshes), wall)))
        found[name] = picture(other, model, BELOW, (12, 8), spp=2, caustics="photons", fog=fog)[..., :3].mean()
    if other is not tracer:
        other.release()
    assert found["none"] > 0.1
    assert found["back"] == pytest.approx(found["none"], rel=0.02)
    assert found["mirrored"] == pytest.approx(found["none"], rel=0.02)
    assert found["front"] < 0.92 * found["none"]
