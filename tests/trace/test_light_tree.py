"""The tree of lights: its bounds hold, its choices have the probabilities that they tell, and these are never 0 where
light arrives."""

from __future__ import annotations

import numpy as np
import pytest
from harness import evaluate
from light_tree_twin import along_ray, at_point, decode, probabilities
from pictures import halves
from test_light_sampling import FLOOR, QUAD, Lit, place, rectangle_irradiance, scene_of
from test_scattering import fog

from viewer.measure.check.chi_squared import critical_value, statistic
from viewer.scene.camera import Camera
from viewer.scene.environment import Environment
from viewer.scene.light import Light
from viewer.scene.material import Material
from viewer.trace.layout import LIGHT_LAMP, LIGHT_NARROW, LIGHT_TWO_SIDED
from viewer.trace.scene import lights as scene_lights
from viewer.trace.scene.light_bounds import LightBounds, union
from viewer.trace.scene.light_tree import build_light_tree

UP = np.array([0.0, 1.0, 0.0])


def lamps(count: int, seed: int, scale: float = 1.0, powers: float = 2.0) -> list[Light]:
    """Point lights and spots above the floor, of powers within so many decades, some of a short range."""
    rng = np.random.default_rng(seed)
    found = []
    for k in range(count):
        direction = rng.normal(size=3) - (0, 2, 0)
        found.append(Light(
            ("point", "spot")[k % 2], intensity=float(10 ** rng.uniform(-powers, 0)) * scale**2,
            position=tuple((rng.uniform((-2, -0.5, -2), (2, 2, 2)) * scale).tolist()),
            direction=tuple((direction / np.linalg.norm(direction)).tolist()),
            inner_cone=0.2, outer_cone=0.7, range=3.0 * scale if k % 3 == 0 else None))
    return found


def panels(count: int, seed: int) -> list[tuple[Material, np.ndarray]]:
    rng = np.random.default_rng(seed)
    return [(Material(emissive=(float(10 ** rng.uniform(-1, 1)),) * 3, double_sided=bool(k % 3 == 0)),
             place(*rng.uniform((-2, 0, -2), (2, 2, 2)), rng.uniform(0.01, 0.4, 3), rng.uniform(0, 2 * np.pi)))
            for k in range(count)]


MIXED = scene_of(FLOOR, *panels(20, 1), lights=tuple(lamps(20, 2)))
SCENES = {
    "mixed": MIXED,
    "powers over 1e10": scene_of(FLOOR, lights=tuple(lamps(40, 3, powers=10))),
    "tiny": scene_of((FLOOR[0], np.diag([1e-6, 1e-6, 1e-6, 1])), lights=tuple(lamps(20, 4, 1e-6))),
    "huge": scene_of((FLOOR[0], np.diag([1e6, 1e6, 1e6, 1])), lights=tuple(lamps(20, 4, 1e6))),
    "one place": scene_of(FLOOR, lights=tuple(Light("point", intensity=1.0 + k, position=(0, 1, 0))
                                              for k in range(20))),
}


def receivers(count: int, seed: int) -> np.ndarray:
    """Points near the origin, in tracer space, and normals, (count, 6); every third without one."""
    rng = np.random.default_rng(seed)
    n = rng.normal(size=(count, 3))
    n /= np.linalg.norm(n, axis=1, keepdims=True)
    return np.column_stack([rng.uniform(-0.4, 0.4, (count, 3)), n * (np.arange(count) % 3 > 0)[:, None]])


def tree_of(lit: Lit) -> np.ndarray:
    """The texels of the tree."""
    first = lit.data.buffer.offsets["light_tree"]
    order = sorted(lit.data.buffer.offsets, key=lit.data.buffer.offsets.get)
    return lit.data.buffer._sections[order.index("light_tree")] if first >= 0 else np.zeros(0)


@pytest.mark.parametrize("name", SCENES)
def test_choices(context, tmp_path, name):
    """The shader's probabilities are those of float64, lights are chosen as often as these say, and they sum to 1 with
    that of no light. A light from which something arrives has one."""
    lit = Lit(context, tmp_path, SCENES[name])
    assert lit.lights.switches["HAS_LIGHT_TREE"] == 1
    nodes, count, each = decode(tree_of(lit)), 6, 20000
    where = receivers(count, 5).astype(np.float32)
    rows = np.zeros((count * each, 12))
    rows[:, :3] = np.random.default_rng(7).integers(0, 1 << 24, (len(rows), 3)) / 2**24
    rows[:, 4:7], rows[:, 8:11] = np.repeat(where[:, :3], each, axis=0), np.repeat(where[:, 3:], each, axis=0)
    found = lit.run("float c; vec2 rest; int k = choose_finite_light(Receiver(f1.xyz, f2.xyz, 0.0), f0.xyz, c, rest);"
                    "o0 = vec4(float(k), c, rest); o1 = vec4(0.0);", rows)[:, 0].reshape(count, each, 4)
    assert ((found[..., 2:] >= 0) & (found[..., 2:] < 1)).all()
    for receiver, samples in zip(where.astype(np.float64), found):
        expected, nothing = probabilities(nodes, at_point(nodes, receiver[:3], receiver[3:]))
        assert sum(expected.values()) + nothing == pytest.approx(1, abs=1e-9)
        number, told = samples[:, 0].astype(int), samples[:, 1]
        chances = np.array([expected.get(k, 0.0) for k in number])
        assert np.allclose(told, chances, rtol=2e-3, atol=1e-9)
        observed = np.array([(number == k).sum() for k in (*expected, -1)], float)
        value, degrees = statistic(observed, np.array([*expected.values(), nothing]) * each)
        assert value < critical_value(degrees, 60)
        for k, arriving in contributions(lit, receiver).items():
            assert expected[k] > 0 or arriving == 0, k


def contributions(lit: Lit, receiver: np.ndarray) -> dict[int, float]:
    """Of each lamp, and of the triangles of each panel, what arrives at a receiver in tracer space; float64."""
    p, n = receiver[:3], receiver[3:]
    found = {}
    for k, light in enumerate(lit.lights.lit):
        d = lit.to_tracer(np.asarray(light.position)) - p
        distance = np.linalg.norm(d)
        cosine = d @ n / distance if n.any() else 1.0
        cone = 1.0
        if light.kind == "spot":
            edges = np.cos([light.outer_cone, light.inner_cone])
            cone = np.clip((-(d @ light.direction) / distance - edges[0]) / (edges[1] - edges[0]), 0, 1)
        window = 1.0 if light.range is None else max(1 - (distance * lit.scene.radius / light.range) ** 4, 0)
        found[k] = max(cosine, 0) * cone * window / distance**2
    number = len(found)
    for material, instance in zip(lit.scene.materials[1:], lit.scene.instances[1:]):
        corners = lit.to_tracer(QUAD @ instance.transform[:3, :3].T + instance.transform[:3, 3])
        for triangle in corners[[0, 1, 2]], corners[[0, 2, 3]]:
            normal = np.cross(triangle[1] - triangle[0], triangle[2] - triangle[0])
            facing = (p - triangle[0]) @ normal
            is_seen = not n.any() or ((triangle - p) @ n).max() > 0
            found[number] = float(is_seen and (facing > 0 or material.double_sided))
            number += 1
    return found


def test_irradiance(context, tmp_path):
    """Panels, lamps, a sun and a sky together give the light of each alone; the tree's samples have less variance."""
    sky = Environment("sky", np.full((8, 16, 3), 0.3, np.float32))
    sun = Light("directional", intensity=0.7, direction=(0, -1, 0))
    below = [(m, t) for m, t in panels(20, 1) if t[1, 3] - 0.5 > 0]
    points = [light for light in lamps(20, 2) if light.kind == "point"]
    lit = Lit(context, tmp_path, scene_of(FLOOR, *below, lights=(*points, sun), environment=sky))
    p = np.array([0.1, -0.9, 0.2])
    expected = 0.7 + 0.3 * np.pi
    for light in points:
        d = np.asarray(light.position) - p
        distance = np.linalg.norm(d)
        window = 1.0 if light.range is None else max(1 - (distance / light.range) ** 4, 0)
        expected += light.intensity * max(d[1], 0) / distance**3 * window
    for material, transform in below:
        corners = QUAD @ transform[:3, :3].T + transform[:3, 3]
        normal = np.cross(corners[1] - corners[0], corners[2] - corners[0])
        if material.double_sided or (p - corners[0]) @ normal > 0:
            expected += rectangle_irradiance(corners, p, UP, material.emissive[0])
    found, error = lit.irradiance(p, UP)
    assert error < 0.01 * expected and abs(found - expected) < 4.5 * error


def test_density_of_hit_emitters(context, tmp_path):
    """emitter_pdf is the density with which sample_light chooses a direction, for the same receiver."""
    lit = Lit(context, tmp_path, scene_of(FLOOR, *panels(30, 8)))
    rng = np.random.default_rng(9)
    where = np.repeat(receivers(50, 10), 40, axis=0)
    rows = np.column_stack([rng.uniform(0, 1, (2000, 4)), where[:, :3], where[:, :1], where[:, 3:], where[:, :1]])
    found = lit.run("""
        vec2 position;
        float chance, density;
        vec3 l;
        float d;
        int k = choose_finite_light(Receiver(f1.xyz, f2.xyz, 0.0), f0.xyz, chance, position);
        o0 = o1 = vec4(0.0);
        if (k >= 0) {
            sample_emitter(k, f1.xyz, position, l, d, density);
            uvec4 record = scene_uint4(u_emitters + k);
            Hit hit = Hit(int(record.x), int(record.y), vec2(0.2, 0.3));
            Interaction i = interact(hit, -l);
            o0 = vec4(chance * density, emitter_pdf(k, i.area, f1.xyz, f2.xyz, d, dot(i.n_geometric, -l)), 0.0, 0.0);
        }""", rows)[:, 0]
    is_sample = found[:, 0] > 0
    assert is_sample.mean() > 0.5
    assert np.allclose(found[is_sample, 0], found[is_sample, 1], rtol=1e-4)


def test_facing(context, tmp_path):
    """Normals are packed with an error below the slack of the bounds; 0 stays 0; the status is not touched."""
    rng = np.random.default_rng(11)
    n = np.concatenate([rng.normal(size=(5000, 3)), np.eye(3), -np.eye(3)])
    n /= np.linalg.norm(n, axis=1, keepdims=True)
    found = evaluate(context, tmp_path, "trace/facing.glsl", "float w = 1.0 + pack_facing(f0.xyz);"
                     "o0 = vec4(unpack_facing(fract(w)), floor(w)); o1 = vec4(unpack_facing(0.0), w);",
                     n.astype(np.float32), 2)
    assert (found[:, 0, 3] == 1).all() and (found[:, 1, :3] == 0).all() and (found[:, 1, 3] < 2).all()
    assert np.linalg.norm(found[:, 0, :3] - n, axis=1).max() < 0.0025


def test_rays_through_media(context, tmp_path):
    """For a ray, lamps are chosen as often as the twin says, and emissive triangles never."""
    milk = fog(0.3, 0.9), place(0, -1, 0, (3, 1, 3))
    lit = Lit(context, tmp_path, scene_of(milk, *panels(5, 1), lights=(*lamps(20, 2), Light("directional"))))
    assert lit.lights.switches["HAS_AIRLIGHT"] and lit.lights.switches["HAS_LIGHT_TREE"]
    nodes, o, d = decode(tree_of(lit)), np.array([0.1, 0.2, -0.3]), np.array([0.6, 0.0, 0.8])
    expected, _ = probabilities(nodes, along_ray(nodes, o, d, 0.5))
    u = np.random.default_rng(12).integers(0, 1 << 24, (60000, 3)) / 2**24
    found = lit.run("float c; vec2 rest; Receiver r = Receiver(vec3(0.1, 0.2, -0.3), vec3(0.6, 0.0, 0.8), 0.5);"
                    "int k = choose_punctual(r, f0.xyz, c, rest); o0 = vec4(float(k), c, rest); o1 = vec4(0.0);", u)
    number, told = found[:, 0, 0].astype(int), found[:, 0, 1]
    assert number.min() >= 0 and number.max() == 20  # 0 is directional
    far = told[number == 0][0]
    expected = {0: far} | {k: p * (1 - far) for k, p in expected.items()}
    assert np.allclose(told, [expected[k] for k in number], rtol=2e-3)
    value, degrees = statistic(np.array([(number == k).sum() for k in expected], float),
                               np.array(list(expected.values())) * len(u))
    assert value < critical_value(degrees, 1)


CASES = {"clear": ({"light_radius": 0.05}, 0.8), "fog": ({"fog": 0.2}, 0.95)}


@pytest.mark.parametrize("settings, ratio", CASES.values(), ids=CASES)
def test_pictures_without_a_bias(tracer, monkeypatch, settings, ratio):
    """Chosen by the tree and by their power, lights make the same picture; the tree's has less noise. In fog, much of
    the noise comes from where paths collide."""
    both = {}
    for most in (16, 1 << 30):
        monkeypatch.setattr(scene_lights, "MOST_BY_POWER", most)
        model = scene_of((Material("floor", metallic=0.0), place(0, -1, 0, (3, 1, 3))), *panels(20, 1),
                         lights=(*lamps(20, 2), Light("directional", intensity=0.3)))
        both[most] = halves(tracer, model, Camera.look_at((0, 3, 6), (0, 0, 0)), (24, 24), spp=64, **settings)
    tree, power = both.values()
    noise = [(one.first - one.second).reshape(-1, 3) for one in (tree, power)]
    difference = (tree.mean - power.mean).reshape(-1, 3).mean(axis=0)
    error = np.sqrt(sum((one**2).mean(axis=0) for one in noise) / 4 / len(noise[0]))
    assert (np.abs(difference) < 4 * error).all() and (error < 0.02 * power.mean.mean()).all()
    assert np.median(np.abs(noise[0])) < ratio * np.median(np.abs(noise[1]))


def test_rule_of_the_count(context, tmp_path):
    """Few lights, or many of which few have a power, are chosen by their power, without code for a tree."""
    most = scene_lights.MOST_BY_POWER
    off = Light("point", intensity=0.0)
    for count, has_tree in ((most, 0), (most + 1, 1)):
        lit = Lit(context, tmp_path, scene_of(FLOOR, lights=(*lamps(count, 2), off, off, Light("directional"))))
        assert lit.lights.switches["HAS_LIGHT_TREE"] == has_tree
        assert ("light_tree" in lit.data.buffer.offsets) == bool(has_tree)


def random_bounds(count: int, seed: int) -> LightBounds:
    rng = np.random.default_rng(seed)
    low, axis = rng.normal(size=(count, 3)), rng.normal(size=(count, 3))
    high = low + rng.uniform(0, 0.2, (count, 3))
    spread = rng.choice([0.0, 0.3, 1.5, np.pi], count)
    return LightBounds(low, high, np.linalg.norm(high - low, axis=1) / 2, rng.exponential(size=count),
                       axis / np.linalg.norm(axis, axis=1, keepdims=True), spread,
                       rng.choice([1.0, np.inf], count), rng.integers(0, 8, count))


def test_bounds_hold():
    """The union of two groups holds both: their spheres, cones, reach and flags."""
    a, b = random_bounds(2000, 1), random_bounds(2000, 2)
    both = union(a, b)
    for one in (a, b):
        away = np.linalg.norm(one.center - both.center, axis=1) + one.radius
        assert (away <= both.radius * (1 + 1e-12)).all()
        cosine = (one.axis * both.axis).sum(axis=1)
        between = np.arccos(np.clip(np.where(both.flags & LIGHT_TWO_SIDED > 0, np.abs(cosine), cosine), -1, 1))
        assert ((both.spread == np.pi) | (between + one.spread <= both.spread + 1e-7)).all()
        assert (one.reach <= both.reach).all()
    assert np.allclose(both.intensity, a.intensity + b.intensity)
    either, each = a.flags | b.flags, a.flags & b.flags
    assert (both.flags == either & (LIGHT_LAMP | LIGHT_TWO_SIDED) | each & LIGHT_NARROW).all()


@pytest.mark.parametrize("count", [2, 3, 17, 5000])
@pytest.mark.parametrize("places", ["ball", "plane", "line", "point", "powers of 2"])
def test_trees_of_any_places(count, places):
    """Each light is a leaf, its trail leads there, and no way is longer than a trail has bits."""
    bounds = random_bounds(count, 3)
    low = np.zeros_like(bounds.low) if places == "point" else bounds.low.copy()
    low[:, {"plane": 1, "line": 2}.get(places, 3):] = 0.0
    if places == "powers of 2":  # the cheapest cuts part one light from the rest, again and again
        low = np.ldexp(np.ones((count, 3)), -(np.arange(count) % 900)[:, None])
    flat = LightBounds(low, low, np.zeros(count), bounds.intensity, bounds.axis, bounds.spread, bounds.reach,
                       bounds.flags)
    tree = build_light_tree(flat)
    assert len(tree.links) == 2 * count - 2 and np.isfinite(tree.bounds.radius).all()
    leaves = tree.links[tree.links >= 1 << 31] & np.uint32((1 << 31) - 1)
    assert sorted(leaves.tolist()) == list(range(count))
    pairs, ends = np.zeros(count, int), np.full(count, -1)
    for level in range(32):
        links = tree.links[2 * pairs + (tree.trails >> np.uint32(level) & 1)]
        is_leaf = (links >= 1 << 31) & (ends < 0)
        ends[is_leaf] = links[is_leaf] & np.uint32((1 << 31) - 1)
        pairs = np.where(ends < 0, links, 0).astype(int)
    assert (ends == np.arange(count)).all()
