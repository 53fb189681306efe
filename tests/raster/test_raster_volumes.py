"""Volumes in the raster, where they can be worked out by quadrature."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from shapes import WHITE, constant, facing_floor, moved, orthographic, pixel_points, plate, scene, seen_plane, sphere

from viewer.bake.many_lights import uniform_lights
from viewer.plan.media import MAX_VOLUMES
from viewer.raster.renderer import Renderer
from viewer.scene.camera import Camera
from viewer.scene.environment import Environment
from viewer.scene.equirect import texel_directions
from viewer.scene.light import Light
from viewer.scene.scene import Scene
from viewer.scene.volume import Volume
from viewer.settings import Settings

BLACK = replace(WHITE, base_color=(0, 0, 0, 1))
GLOWING = replace(BLACK, emissive=(4.0, 1.0, 0.5))
SUN = Light("directional", intensity=3.0, direction=(0.2, -1, -0.5))
FINE = {"media_steps": "224", "media_rays": "all"}
SIZE = (16, 16)
SHEARED = np.array([[0.3, 0.08, 0.0, -0.4], [0.05, 0.35, 0.02, -0.5], [-0.1, 0.0, 0.3, -0.2], [0, 0, 0, 1.0]])
"""Voxels to the world: turned and sheared."""


def clumps(dtype=np.float32, matrix: np.ndarray = SHEARED) -> Volume:
    """4 x 3 x 5 voxels of different densities; some are empty."""
    values = np.random.default_rng(3).uniform(0, 1, (5, 3, 4))
    return Volume("clumps", np.where(values < 0.3, 0, values).astype(dtype), matrix)


def density(volume: Volume, points: np.ndarray) -> np.ndarray:
    """Trilinear between the centres of voxels, constant to the faces of the box, 0 outside."""
    index = points @ np.linalg.inv(volume.index_to_world)[:3, :3].T + np.linalg.inv(volume.index_to_world)[:3, 3]
    counts = np.array(volume.density.shape[::-1])
    inside = ((index >= -0.5) & (index <= counts - 0.5)).all(-1)
    index = np.clip(index, 0, counts - 1)
    low = np.minimum(index.astype(int), counts - 2)
    part = index - low
    total = np.zeros(points.shape[:-1])
    for corner in np.ndindex(2, 2, 2):
        weight = np.prod(np.where(corner, part, 1 - part), axis=-1)
        x, y, z = np.moveaxis(low + corner, -1, 0)
        total += weight * volume.density[z, y, x]
    return total * inside


def depth_along(volume: Volume, start: np.ndarray, direction: np.ndarray, reach: float, count: int = 600) -> np.ndarray:
    t = (np.arange(count) + 0.5) / count * reach
    return density(volume, start[..., None, :] + t[:, None] * direction[..., None, :]).mean(-1) * reach


def with_volumes(model: Scene, *volumes: Volume) -> Scene:
    return replace(model, volumes=volumes)


@pytest.mark.parametrize("dtype", [np.float32, np.float16])
@pytest.mark.parametrize("place", [-1.5, 0.2], ids=["behind", "inside"])
def test_light_is_lost_in_a_sheared_grid(radiance, dtype, place):
    """Before a plate that stands behind the grid, or in it."""
    volume, camera = clumps(dtype), orthographic(azimuth=0.3, elevation=0.2, height=1.6)
    wall = plate(half=3.0)
    model = with_volumes(scene((wall, moved((0, 0, place))), materials=[GLOWING]), volume)
    found = radiance(model, camera, SIZE, volume_density=2.0, volume_albedo=(0, 0, 0), **FINE)
    start = pixel_points(camera, SIZE)
    reach = (place - start[..., 2]) / camera.forward[2]
    fractions = (np.arange(800) + 0.5) / 800
    points = start[..., None, :] + (fractions[:, None] * reach[..., None, None]) * camera.forward
    expected = 4 * np.exp(-2 * density(volume, points).mean(-1) * reach)
    assert expected.min() < 2.8
    assert found[..., 0] == pytest.approx(expected, rel=0.02)


def test_a_camera_inside(radiance):
    """Light from a wall loses as much as there is of the grid before the eye."""
    volume = clumps()
    eye = np.array([0.1, 0.0, 0.5])
    camera = Camera.look_at(eye, (0.1, 0.0, -3.0))
    model = with_volumes(scene((plate(half=9.0), moved((0, 0, -3))), materials=[GLOWING]), volume)
    [found] = radiance(model, camera, (1, 1), volume_density=2.0, volume_albedo=(0, 0, 0), **FINE)[0]
    assert found[0] == pytest.approx(4 * np.exp(-2 * depth_along(volume, eye, camera.forward, 3.5)), rel=0.02)


@pytest.mark.parametrize("thickness", [1e-6, 1.0, 20.0, 1e6, 1e18])
@pytest.mark.parametrize("g", [0.0, 0.8])
def test_a_white_furnace_stays_white(radiance, thickness, g):
    model = replace(with_volumes(Scene("cloud"), clumps()), environment=constant())
    found = radiance(model, model.framing_camera(1.0), SIZE, volume_density=thickness, volume_g=g,
                     volume_albedo=(1, 1, 1))
    assert np.abs(found[..., :3] - 1).max() < 0.02


def test_light_scattered_once(radiance):
    """Of a sun, by quadrature towards the eye and towards the sun."""
    volume = clumps()
    sun = Light("directional", intensity=3.0, direction=(0, -0.6, -0.8))
    model = replace(with_volumes(Scene("smoke"), volume), lights=(sun,))
    camera = orthographic(azimuth=0.3, elevation=0.2, height=1.6)
    found = radiance(model, camera, SIZE, media_scattering="single", volume_density=2.0, volume_g=0.4,
                     volume_albedo=(0.8, 0.4, 0.0), background="none", **FINE)
    start = pixel_points(camera, SIZE)
    count, reach = 150, 10.0
    t = (np.arange(count) + 0.5) / count * reach
    points = start[..., None, :] + t[:, None] * camera.forward
    extinction = 2 * density(volume, points)
    before = (np.cumsum(extinction, axis=-1) - 0.5 * extinction) * (reach / count)
    lit = np.zeros(extinction.shape)
    there = extinction > 0
    lit[there] = np.exp(-2 * depth_along(volume, points[there], -np.array(sun.direction), 4.0, 60))
    mu, g = -np.array(sun.direction) @ camera.forward, 0.4
    phase = (1 - g * g) / (4 * np.pi * (1 + g * g - 2 * g * mu) ** 1.5)
    expected = 0.8 * phase * 3 * (np.exp(-before) * extinction * lit).sum(-1) * (reach / count)
    assert found[..., 0].mean() == pytest.approx(expected.mean(), rel=0.03)
    assert np.sqrt(((found[..., 0] - expected) ** 2).mean()) < 0.05 * expected.max()
    assert found[..., 1] == pytest.approx(found[..., 0] / 2, rel=1e-4) and (found[..., 2] == 0).all()


@pytest.mark.parametrize("steps", ["28", "56"])
@pytest.mark.parametrize("sigma", [30.0, 300.0])
def test_a_dense_face_has_no_stripes(radiance, sigma, steps):
    """Light that a half-space scatters once has the radiance albedo E / 4 pi mu0 / (mu0 + mu), at every extinction
    (Chandrasekhar 1960, section 47). The face is between two layers of voxels, and steps end anywhere about it."""
    values = np.zeros((24, 24, 24), np.float32)
    values[:16] = 1
    box = Volume.in_box(values, [[-1, -1, -1], [1, 1, 1]])
    sun = Light("directional", intensity=3.0, direction=(0, -0.6, -0.8))
    model = replace(with_volumes(Scene("block"), box), lights=(sun,))
    camera = orthographic(azimuth=0.5, elevation=0.3, height=0.8)
    found = radiance(model, camera, (32, 32), media_scattering="single", media_steps=steps, volume_density=sigma,
                     volume_albedo=(0.8, 0.8, 0.8), background="none")[..., 0]
    mu = -camera.forward[2]
    expected = 0.8 * 3 / (4 * np.pi) * 0.8 / (0.8 + mu)
    assert found.mean() == pytest.approx(expected, rel=0.05)
    assert found.std() < 0.05 * expected


@pytest.mark.parametrize("sigma", [0.0, 1e-6, 2.0])
def test_emission(radiance, sigma):
    """Also of a volume that hides nothing."""
    volume = clumps()
    camera = orthographic(azimuth=0.3, elevation=0.2, height=1.6)
    found = radiance(with_volumes(Scene("fire"), volume), camera, SIZE, volume_density=sigma, volume_albedo=(0, 0, 0),
                     volume_emission=(3, 1, 0), background="none", **FINE)
    depth = depth_along(volume, pixel_points(camera, SIZE), camera.forward, 10.0)
    expected = 3 * depth if sigma < 1 else 3 / sigma * (1 - np.exp(-sigma * depth))
    assert found[..., 0] == pytest.approx(expected, abs=0.02 * expected.max())
    assert found[..., 1] == pytest.approx(found[..., 0] / 3, rel=1e-3)


@pytest.fixture(scope="module")
def burning() -> Scene:
    """A glowing cube over a white floor that reaches beyond its grid."""
    cube = Volume.in_box(np.ones((4, 4, 4), np.float32), [[-0.5, 1.5, -0.5], [0.5, 2.5, 0.5]])
    return with_volumes(scene((plate(half=4.0), facing_floor())), cube)


GLOW = {"volume_density": 0.0, "volume_emission": (2, 1, 0), "background": "none"}
FROM_ABOVE = orthographic(elevation=1.5, height=6.0)


def test_what_volumes_emit_lights_surfaces(radiance, burning):
    """The irradiance below a point of the cube is its intensity times cos / d^2."""
    found = radiance(burning, FROM_ABOVE, SIZE, **GLOW)
    grid = (np.arange(16) + 0.5) / 16
    source = np.stack(np.meshgrid(grid - 0.5, grid + 1.5, grid - 0.5, indexing="ij"), axis=-1).reshape(-1, 3)
    on_floor = seen_plane(FROM_ABOVE, SIZE, (0, 1, 0))
    squares = ((source - on_floor[..., None, :]) ** 2).sum(axis=-1)
    expected = 2 * (source[:, 1] / squares**1.5).mean(axis=-1) / np.pi
    beside = np.abs(on_floor).max(axis=-1) > 1.2  # the cube is not in the way
    assert found[beside, 0] == pytest.approx(expected[beside], rel=0.02)
    assert found[..., 1] == pytest.approx(found[..., 0] / 2, rel=1e-3)


def test_others_stand_before_what_volumes_emit(radiance, burning):
    lid = scene((plate(half=4.0), facing_floor()), (plate(half=1.0), facing_floor(y=1.0)))
    camera = Camera.look_at((0, 0.5, 1.2), (0, 0, 0))
    lit, shaded = (radiance(replace(model, volumes=burning.volumes), camera, SIZE, **GLOW)[8, 8, 0]
                   for model in (burning, lid))
    assert lit > 0.05 and shaded < 1e-3 * lit


def test_shadows_of_what_volumes_emit_beside_many_lamps(renderer, burning):
    """Nine bright lamps, under the floor, leave tiles for one light: it stands for all that the cube emits."""
    lid = scene((plate(half=4.0), facing_floor()), (plate(half=1.0), facing_floor(y=1.0)))
    lamps = (Light("point", intensity=1e3, position=(0.0, -9.0, 0.0)),) * 9
    camera, found = Camera.look_at((0, 0.5, 1.2), (0, 0, 0)), []
    for model in (burning, lid):
        model = replace(model, volumes=burning.volumes, lights=lamps)
        found.append(renderer.render(model, camera, Settings.of(**GLOW), SIZE).linear[8, 8, 0])
        assert renderer.plan.shadow_layer_count == 60 and -1 not in renderer.plan.shadow_layers
    assert found[0] > 0.05 and found[1] < 1e-3 * found[0]


def test_what_volumes_emit_lights_fog_and_themselves(radiance, burning):
    """What absorbs nothing keeps none of its light, and is brighter in the middle, where that leaves late."""
    alone = replace(burning, instances=())
    [beside] = radiance(alone, Camera.look_at((2, 2, 5), (2, 2, 0)), (1, 1), fog=0.02, **GLOW)[0]
    assert 0 < beside[1] == pytest.approx(beside[0] / 2, rel=1e-3)
    [clear, white] = (radiance(alone, Camera.look_at((0, 2, 5), (0, 2, 0)), (1, 1), **GLOW | {
        "volume_density": density, "volume_albedo": (1, 1, 1)})[0, 0, 0] for density in (0.0, 5.0))
    assert clear == pytest.approx(2, rel=0.02) and white > clear


def test_volumes_shadow_surfaces(radiance):
    """A floor below a homogeneous box, far outside of its grid of light, and right beneath."""
    sun = Light("directional", intensity=np.pi, direction=(0, -1, 0))
    box = Volume.in_box(np.ones((4, 4, 4), np.float32), [[-0.5, 2, -0.5], [0.5, 3, 0.5]])
    camera = Camera.look_at((0, 1.5, 0.01), (0, 0, 0))
    model = replace(with_volumes(scene((plate(half=4.0), facing_floor())), box), lights=(sun,))
    found = radiance(model, camera, SIZE, volume_density=1.5, volume_albedo=(0, 0, 0))
    assert found[8, 8, 0] == pytest.approx(np.exp(-1.5), rel=0.01)
    assert found[0, 0, 0] == pytest.approx(1, rel=1e-3)


def test_several_volumes_and_a_fog(radiance):
    """Two boxes one behind the other in a fog, whose place they take."""
    boxes = [Volume.in_box(np.full((2, 3, 4), value, np.float32), [[-1, -1, z], [1, 1, z + 1]])
             for value, z in ((1.0, 0.5), (0.5, -1.5))]
    model = with_volumes(scene((plate(half=2.0), moved((0, 0, -2))), materials=[GLOWING]), *boxes)
    camera = Camera.look_at((0, 0, 4), (0, 0, 0))
    [found] = radiance(model, camera, (1, 1), volume_density=0.7, volume_albedo=(0, 0, 0), fog=0.2,
                       fog_albedo=(0, 0, 0), **FINE)[0]
    assert found[0] == pytest.approx(4 * np.exp(-0.7 * 1.5 - 0.2 * 4), rel=5e-3)


def test_the_scale_of_the_scene_does_not_matter(radiance):
    def picture(scale: float) -> np.ndarray:
        lamp = Light("point", intensity=2 * scale**2, position=(0.8 * scale, 0.5 * scale, 0.9 * scale))
        model = with_volumes(scene((sphere(segments=12), moved((0, 0, 0), scale)), lights=(lamp,),
                                   environment=constant(0.2)),
                             clumps(matrix=np.diag([scale, scale, scale, 1]) @ SHEARED))
        return radiance(model, model.framing_camera(1.0), SIZE, volume_density=2.0 / scale)

    expected = picture(1.0)
    for scale in (1e-6, 1e6):
        assert picture(scale) == pytest.approx(expected, rel=2e-3, abs=1e-4), scale


@pytest.mark.parametrize("settings", [
    {"volume_density": 1e18}, {"volume_density": 1e-18}, {"volume_density": 0.0},
    {"volume_emission": (1e9, 0, 0), "volume_density": 1e-12}, {"volume_g": -0.99, "fog": 1e6}, {"mode": "phong"},
], ids=str)
def test_extremes_stay_finite(radiance, settings):
    lamps = (Light("point", intensity=2.0, position=(0, 0, 0)), Light("spot", intensity=2.0, position=(0, 2, 0)),
             *[Light("directional", intensity=3.0, direction=(0, -1, 0))] * 3)
    model = replace(with_volumes(scene(sphere(segments=12)), clumps()), lights=lamps, environment=constant(0.2))
    for camera in (Camera.look_at((0.1, 0, 0.2), (0, 0, 0)), model.framing_camera(1.0)):
        assert (radiance(model, camera, SIZE, **settings) >= 0).all()


def lit_from_one_side(dark: float = 0.05) -> Environment:
    """Brightest at +Z, and nearly dark on the other side of the sphere."""
    d = texel_directions(32, 64)
    light = dark + np.maximum(d[..., 2:], 0) ** 2
    return Environment("one side", np.repeat(light, 3, axis=2).astype(np.float32))


@pytest.mark.parametrize("g", [0.0, 0.5])
@pytest.mark.parametrize("thickness", [0.3, 8.0])
def test_light_of_an_environment_scattered_once(radiance, g, thickness):
    """By quadrature towards the eye and towards all of the environment."""
    volume, size = clumps(), (4, 4)
    model = replace(with_volumes(Scene("smoke"), volume), environment=lit_from_one_side())
    camera = orthographic(azimuth=0.3, elevation=0.2, height=1.0)
    found = radiance(model, camera, size, media_scattering="single", volume_density=thickness, volume_g=g,
                     volume_albedo=(1, 1, 1), background="none", **FINE)[..., 0]
    t = 3 + 4 * (np.arange(80) + 0.5) / 80
    points = pixel_points(camera, size)[..., None, :] + t[:, None] * camera.forward
    extinction = thickness * density(volume, points)
    before = (np.cumsum(extinction, axis=-1) - 0.5 * extinction) * 0.05
    there = extinction > 0
    light = np.zeros(extinction.shape)
    for direction in (directions := uniform_lights(80, (1, 1, 1)).directions):
        phase = (1 - g * g) / (4 * np.pi * (1 + g * g - 2 * g * (direction @ camera.forward)) ** 1.5)
        arriving = np.exp(-thickness * depth_along(volume, points[there], direction, 3.0, 24))
        light[there] += phase * (0.05 + max(direction[2], 0) ** 2) * arriving * (4 * np.pi / len(directions))
    expected = (np.exp(-before) * extinction * light).sum(-1) * 0.05
    assert found.mean() == pytest.approx(expected.mean(), rel=0.05)
    assert np.sqrt(((found - expected) ** 2).mean()) < 0.15 * expected.mean()


def test_a_dense_ball_lit_from_one_side(radiance):
    """What it lets through and what it returns, against walks; it absorbs nothing."""
    side, tau = 24, 6.0
    points = np.moveaxis((np.indices((side,) * 3)[::-1] + 0.5) / side * 2 - 1, 0, -1)
    ball = Volume.in_box(((points**2).sum(-1) < 1).astype(np.float32), [[-1, -1, -1], [1, 1, 1]])
    model = replace(with_volumes(Scene("ball"), ball), environment=lit_from_one_side())
    for azimuth, start in ((0.0, 1.0), (np.pi, -1.0)):
        camera = orthographic(azimuth=azimuth, height=0.2)
        found = radiance(model, camera, (4, 4), volume_density=tau, volume_albedo=(1, 1, 1), **FINE)[..., 0].mean()
        assert found == pytest.approx(walked(tau, start), rel=0.25)


def walked(tau: float, start: float, count: int = 20000) -> float:
    """The radiance of a ball of isotropic scattering at (0, 0, start), seen from outside along z."""
    rng = np.random.default_rng(2)
    point, direction = np.tile([0, 0, start], (count, 1)), np.tile([0, 0, -np.sign(start)], (count, 1))
    total = 0.0
    while len(point):
        point = point + direction * rng.exponential(1 / tau, (len(point), 1))
        out = (point**2).sum(1) > 1
        total += (0.05 + np.maximum(direction[out, 2], 0) ** 2).sum()
        point = point[~out]
        direction = rng.normal(size=point.shape)
        direction /= np.linalg.norm(direction, axis=1, keepdims=True)
    return total / count


def test_the_first_picture_of_an_environment_that_is_not_in_the_cache(context):
    """It has the same light in the medium as one whose environment is baked for reflections."""
    model = replace(with_volumes(Scene("smoke"), clumps()), environment=lit_from_one_side())
    camera, settings = model.framing_camera(1.0), Settings.of(volume_density=2.0)
    pictures = []
    for use_cache in (False, True, True):
        renderer = Renderer(context, use_cache=use_cache)
        pictures.append(renderer.render(model, camera, settings, SIZE).linear)
        renderer.release()
    assert np.array_equal(pictures[0], pictures[1]) and np.array_equal(pictures[1], pictures[2])


@pytest.mark.parametrize(("g", "tau"), [(0.7, 6.0), (0.9, 12.0), (0.99, 60.0), (-0.5, 3.0)])
def test_a_slab_that_scatters_forwards(radiance, g, tau):
    """What a wide plate returns and lets through of light from one half of space, against walks."""
    box = Volume.in_box(np.ones((2, 2, 2), np.float32), [[-4, -4, -0.5], [4, 4, 0.5]])
    d = texel_directions(32, 64)
    front = Environment("front", np.repeat(np.float32(d[..., 2:] > 0), 3, axis=2))
    model = replace(with_volumes(Scene("slab"), box), environment=front)
    for azimuth, sign in ((0.0, -1.0), (np.pi, 1.0)):
        found = radiance(model, orthographic(azimuth=azimuth, height=0.2), (4, 4), volume_density=tau, volume_g=g,
                         volume_albedo=(0.99, 0.99, 0.99), **FINE)[..., 0].mean()
        assert found == pytest.approx(through_slab(tau, g, sign), abs=0.11)


def through_slab(tau: float, g: float, mu: float, count: int = 4000) -> float:
    """The radiance of a slab of albedo 0.99 between light of radiance 1 (z > 1/2) and darkness, seen along z."""
    rng = np.random.default_rng(4)
    z, weight = np.full(count, -0.5 * mu), np.ones(count)
    mu, total = np.full(count, mu), 0.0
    while len(z):
        z = z + mu * rng.exponential(1 / tau, len(z))
        total += weight[z > 0.5].sum()
        kept = (np.abs(z) <= 0.5) & (weight > 1e-3)
        z, mu, weight = z[kept], mu[kept], 0.99 * weight[kept]
        u, turn = rng.uniform(size=len(z)), 2 * np.pi * rng.uniform(size=len(z))
        cosine = (1 + g * g - ((1 - g * g) / (1 - g + 2 * g * u)) ** 2) / (2 * g)
        mu = mu * cosine + np.sqrt(np.maximum((1 - mu**2) * (1 - cosine**2), 0)) * np.cos(turn)
    return total / count


def test_more_volumes_than_a_program_can_have(radiance, renderer):
    boxes = [Volume.in_box(np.ones((1, 1, 1), np.float32), [[k, 0, 0], [k + 0.9, 1, 1]]) for k in range(10)]
    model = replace(with_volumes(Scene("boxes"), *boxes), environment=constant())
    radiance(model, model.framing_camera(1.0), SIZE)
    assert MAX_VOLUMES == 8
    assert "the last 2 of 10 volumes: a program can have no more" in renderer.plan.left_out


def test_a_moving_picture_has_fewer_rays_and_steps_where_software_draws(renderer):
    model, size = replace(Scene("volume", (), (), ()), volumes=(clumps(),), lights=(SUN,)), (32, 32)
    camera = model.framing_camera(1.0)

    def drawn(still: bool, **settings: str) -> np.ndarray:
        renderer.draw(model, camera, Settings.of(volume_density=20, antialias="none", **settings), size, False, still)
        return renderer.read_radiance()

    fine = drawn(True, media_steps="56", media_rays="quarter")
    rough = drawn(True, media_steps="28", media_rays="sixteenth")
    assert np.abs(fine - rough).max() > 0.01 and (fine > 0).any()
    errors = [np.abs(fine - drawn(True, media_steps="28", media_rays=rays)).mean()
              for rays in ("quarter", "ninth", "sixteenth")]
    assert errors == sorted(errors) and len(set(errors)) == 3
    assert np.array_equal(drawn(True), fine)
    assert np.array_equal(drawn(False), rough if renderer.context.is_software else fine)
    assert np.array_equal(drawn(False, media_steps="56", media_rays="quarter"), fine)
