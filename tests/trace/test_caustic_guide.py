"""The guide to caustics: its directions against their density, its density against float64, and its pictures."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from guided import ABOVE, CENTER, LAMP, METAL, RADIUS, Guided, cells_of, with_ball
from needs import needs
from test_light_sampling import FLOOR, place

from viewer.measure.check.chi_squared import critical_value, statistic
from viewer.scene.camera import Camera
from viewer.scene.environment import Environment
from viewer.scene.light import Light
from viewer.scene.material import Material
from viewer.scene.scene import Scene
from viewer.settings import Settings
from viewer.trace.layout import GUIDE_CELLS
from viewer.trace.scene import caustic_guide
from viewer.trace.scene.caustic_guide import CausticGuide, place_of, square_of
from viewer.trace.scene.caustic_rays import caustic_rays
from viewer.trace.scene.geometry import trace_geometry
from viewer.trace.scene.lights import SceneLights
from viewer.trace.scene.scene_buffer import SceneBufferBuilder
from viewer.trace.scene.scene_data import SceneData
from viewer.trace.scene.traced_scene import plan_without_device
from viewer.trace.tracer import Tracer

pytestmark = needs("embree")


@pytest.fixture(scope="module")
def guided(context, tmp_path_factory) -> Guided:
    return Guided(context, tmp_path_factory.mktemp("guide"), with_ball(METAL, FLOOR, (LAMP, ABOVE)))


@pytest.fixture(scope="module")
def lit_point(guided) -> np.ndarray:
    """A point in tracer space at which the ball throws light, on the side of the lamp."""
    return guided.to_tracer(np.array([-0.3, -1.0, 0.1]))


def _at(p: np.ndarray) -> str:
    return f"Guide g = guide_at(vec3({p[0]:.9f}, {p[1]:.9f}, {p[2]:.9f}), mat3(1.0), 1.0);"


def test_directions_have_their_density(guided, lit_point) -> None:
    count = 1 << 18
    u = np.random.default_rng(1).integers(0, 1 << 24, (count, 3)) / 2**24
    found = guided.run(_at(lit_point) + "vec3 d = guide_direction(g, f0.xyz); o0 = vec4(d, guide_pdf(g, d));"
                       "o1.x = g.share;", u, 2)
    direction, pdf = found[:, 0, :3], found[:, 0, 3]
    assert 0 < found[0, 1, 0] <= caustic_guide.MOST_SHARE
    np.testing.assert_allclose(np.linalg.norm(direction, axis=1), 1, atol=1e-6)
    assert (pdf > 0).all()
    expected = guided.density(lit_point, direction)
    assert np.mean(np.abs(pdf / expected - 1) < 1e-4) > 0.999  # others lie on edges of cells
    away = guided.to_tracer(CENTER) - lit_point
    distance = np.linalg.norm(away)
    square = square_of(np.full(count, guided.tables[0].caster.radius / distance), np.tile(-away / distance, (count, 1)),
                       direction)
    column, row = np.minimum(square * GUIDE_CELLS, GUIDE_CELLS - 1).astype(int).T
    counts = np.bincount(row * GUIDE_CELLS + column, minlength=GUIDE_CELLS**2)
    weights = guided.tables[0].weights[place_of(-away[None] / distance)[0]]
    cells = cells_of(weights)
    chi2, freedom = statistic(counts.astype(float), cells * count)
    assert chi2 < critical_value(freedom, 1)


def test_density_is_that_of_float64(guided, lit_point) -> None:
    direction = np.random.default_rng(2).normal(size=(20000, 3))
    direction = direction / np.linalg.norm(direction, axis=1)[:, None] * 0.5 + (guided.to_tracer(CENTER) - lit_point)
    direction = (direction / np.linalg.norm(direction, axis=1)[:, None]).astype(np.float32)
    found = guided.run(_at(lit_point) + "o0.x = guide_pdf(g, f0.xyz);", direction)[:, 0, 0]
    expected = guided.density(lit_point, direction.astype(np.float64))
    assert (expected > 0).any() and (expected == 0).any()
    assert np.mean(np.abs(found - expected) <= 1e-4 * expected) > 0.999


def test_extremes_are_finite(guided) -> None:
    """Inside the caster, at its middle, just outside, far away, and on its axis."""
    rng, center, radius = np.random.default_rng(3), guided.to_tracer(CENTER), guided.tables[0].caster.radius
    away = rng.normal(size=(4000, 3))
    away /= np.linalg.norm(away, axis=1)[:, None]
    distance = radius * np.repeat([0.0, 0.5, 1 + 1e-6, 1.001, 1e4, 1e9, 1e15, 1e18], 500)
    points = center + away * distance[:, None]
    rows = np.concatenate([points, rng.integers(0, 1 << 24, (4000, 3)) / 2**24], axis=1)
    found = guided.run("Guide g = guide_at(f0.xyz, mat3(1.0), 1.0);"
                       "vec3 d = guide_direction(g, vec3(f0.w, f1.xy)); o0 = vec4(d, guide_pdf(g, d));"
                       "o1 = vec4(g.share, guide_pdf(g, -d), guide_pdf(g, vec3(0.0, 1.0, 0.0)), 0.0);", rows, 2)
    assert np.isfinite(found).all()
    share = found[:, 1, 0]
    assert (share[:1000] == 0).all() and (share[1500:2000] > 0).any() and (share[-1500:] == 0).all()
    assert (found[share > 0, 0, 3] > 0).all()


def guide_of(scene: Scene, previous: CausticGuide | None = None, geometry=None) -> CausticGuide:
    geometry = trace_geometry(scene) if geometry is None else geometry
    buffer = SceneBufferBuilder()
    return CausticGuide(scene, geometry, buffer, SceneLights(None, scene, geometry, buffer, Settings()),
                        previous=previous)


@pytest.mark.parametrize("scale", [1e-6, 1.0, 1e6])
def test_tables_are_finite_at_any_scale(scale) -> None:
    """A ball that touches the floor, and a lamp of a great radiance"""
    scene = with_ball(METAL, FLOOR, (replace(LAMP, emissive=(1e5, 1e5, 1e5)), ABOVE))
    *others, ball = scene.instances
    touching = ball.transform.copy()
    touching[1, 3] = -1 + RADIUS
    scene = replace(scene, instances=tuple(
        replace(instance, transform=np.diag([scale, scale, scale, 1.0]) @ instance.transform)
        for instance in (*others, replace(ball, transform=touching))))
    guide = guide_of(scene)
    assert guide.count == 1
    for table in guide.tables:
        assert np.isfinite(table.weights).all() and (table.weights >= 0).all()
        assert np.isfinite(table.shares).all() and 0 < table.shares.max() <= caustic_guide.MOST_SHARE


def test_photons_are_traced_again_only_for_other_light(monkeypatch) -> None:
    scene = with_ball(METAL, FLOOR, (LAMP, ABOVE))
    geometry = trace_geometry(scene)
    first = guide_of(scene, geometry=geometry)
    traced = []
    monkeypatch.setattr(caustic_guide, "caustic_rays", lambda *of: traced.append(of) or caustic_rays(*of))
    lamp = Light("point", position=(0.0, 0.5, 0.0), intensity=10.0)
    with_lamp = guide_of(replace(scene, lights=(lamp,)), first, geometry)
    assert with_lamp.count == 1 and not traced
    sky = Environment("sky", np.ones((2, 4, 3), np.float32))
    guide_of(replace(scene, environment=sky), with_lamp, geometry)
    assert len(traced) == 1
    again = trace_geometry(scene, (scene, geometry))  # made again, as for a pose in which a colour changes
    assert guide_of(scene, first, again).tables is first.tables and len(traced) == 1


def test_photons_are_traced_again_for_what_they_meet(monkeypatch) -> None:
    """Not for a colour or a turn of an even sky, but for a body that has moved, the metal's roughness, a sky's turn."""
    even = Environment("sky", np.ones((4, 8, 3), np.float32))
    bright = np.ones((4, 8, 3), np.float32)
    bright[0, 4] = 50
    spot = Environment("lamp", bright)
    scene = with_ball(METAL, FLOOR, (LAMP, ABOVE))
    geometry, traced = trace_geometry(scene), []
    monkeypatch.setattr(caustic_guide, "caustic_rays", lambda *of: traced.append(of) or caustic_rays(*of))

    def traces(changed: Scene, base: Scene) -> int:
        guide = guide_of(base, geometry=trace_geometry(base, (scene, geometry)))
        before = len(traced)
        guide_of(changed, guide, trace_geometry(changed, (scene, geometry)))
        return len(traced) - before

    floor, lamp, metal = scene.materials
    assert traces(replace(scene, materials=(replace(floor, base_color=(0.1, 0.9, 0.1, 1)), lamp, metal)), scene) == 0
    assert traces(replace(scene, materials=(floor, lamp, replace(metal, perceptual_roughness=0.2))), scene) == 1
    moved = replace(scene.instances[0], transform=scene.instances[0].transform @ np.diag([0.9, 1, 0.9, 1]))
    assert traces(replace(scene, instances=(moved, *scene.instances[1:])), scene) == 1
    for sky, times in ((even, 0), (spot, 1)):
        under = replace(scene, environment=sky)
        assert traces(replace(under, environment=replace(sky, rotation=1.0)), under) == times


def test_a_plan_traces_no_photons(monkeypatch) -> None:
    monkeypatch.setattr(caustic_guide, "caustic_rays", None)
    line = "a guide to caustics of lamps"
    floor, lamp, ground = FLOOR, (LAMP, ABOVE), FLOOR[1]
    poster, mirror = Material("poster", unlit=True), (replace(METAL, emissive=LAMP.emissive), ABOVE)
    for material, placed, settings, may in (
            (METAL, (floor, lamp), {}, True), (METAL, (floor,), {}, False),
            (Material("plastic", metallic=0.0), (floor, lamp), {}, False),
            (METAL, (floor, mirror), {}, True), (METAL, ((poster, ground), mirror), {}, False),
            (METAL, (floor, lamp), {"bounces": 1}, False), (METAL, (floor, lamp), {"lobes": "specular"}, False)):
        plan = plan_without_device(with_ball(material, *placed), Settings.of(mode="path", **settings))
        assert (line in plan.used) == may and any(left.startswith(line) for left in plan.left_out) != may


def test_photons_alone_have_none(context, monkeypatch) -> None:
    """A picture of the raster has photons, and no paths that would follow the guide."""
    monkeypatch.setattr(caustic_guide, "caustic_rays", None)
    glass = Material("glass", metallic=0.0, transmission=1.0, thickness=1.0, perceptual_roughness=0.0)
    lamp = Light("point", position=(0.0, 0.5, 0.0), intensity=10.0)
    scene = replace(with_ball(glass, FLOOR, (LAMP, ABOVE)), lights=(lamp,))
    tracer = Tracer(context)
    camera = Camera.look_at((0.3, 0.6, 2.2), (0.5, -0.9, 0.0), fov_y=np.radians(50))
    photons = tracer.begin_photons(scene, camera, Settings(mode="path", caustics="photons"), (16, 16))
    assert photons is not None
    photons.release()
    tracer.release()


@pytest.mark.parametrize("material", [Material("rough metal", metallic=1.0, perceptual_roughness=0.8),
                                      Material("plastic", metallic=0.0, perceptual_roughness=0.1)])
def test_there_is_none_without_casters(context, material) -> None:
    scene = with_ball(material, FLOOR, (LAMP, ABOVE))
    geometry = trace_geometry(scene)
    data = SceneData(context, scene, geometry)
    lights = SceneLights(context, scene, geometry, data.buffer, Settings())
    count = data.buffer.count
    guide = CausticGuide(scene, geometry, data.buffer, lights)
    assert guide.switches == {"HAS_CAUSTIC_GUIDE": 0}
    assert data.buffer.count == count
    data.release()
    lights.release()


@pytest.mark.parametrize("material", [METAL, Material("glass", metallic=0.0, transmission=1.0, thickness=1.0,
                                                      perceptual_roughness=0.0)])
def test_the_picture_is_the_same_with_less_noise(context, material, monkeypatch) -> None:
    """Of floor and walls beside the ball, by many small pictures"""
    wall = Material("wall"), place(1.2, 0.0, 0.0, (2.0, 1.0, 2.0), np.pi / 2)
    scene = with_ball(material, FLOOR, wall, (LAMP, ABOVE))
    camera = Camera.look_at((0.3, 0.6, 2.2), (0.5, -0.9, 0.0), fov_y=np.radians(50))
    pictures = {}
    for name in ("guided", "plain"):
        if name == "plain":
            monkeypatch.setattr(caustic_guide, "may_guide", lambda *_: False)
        tracer = Tracer(context)
        pictures[name] = np.array([
            tracer.render(scene, camera, Settings.of(mode="path", spp=32, seed=seed, background="#000000"), (16, 16))
            .linear[..., :3] for seed in range(12)], np.float64)
    variance = {name: values.var(axis=0, ddof=1) for name, values in pictures.items()}
    error = np.sqrt((variance["guided"] + variance["plain"]).sum() / 12)
    assert abs((pictures["guided"].mean(axis=0) - pictures["plain"].mean(axis=0)).sum()) < 4 * error
    assert variance["guided"].mean() < 0.7 * variance["plain"].mean()
