"""Interreflection at vertices, compared with analytic form factors; it is 0 where no light arrives."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from little_scenes import NOTHING_MUCH
from shapes import WHITE, facing_floor, moved, scene, sphere

from viewer.gpu.context import Context
from viewer.scene.furnace import in_furnace
from viewer.scene.material import Material
from viewer.scene.mesh import Mesh
from viewer.scene.scene import Scene
from viewer.settings import Settings
from viewer.trace.surface_points import fit, sample_surfaces, surface_triangles
from viewer.trace.vertex_light import VertexLight, bake_incoming, bake_outgoing

SETTINGS = Settings()


def grid(side: int) -> Mesh:
    """A unit square of side x side quads around the origin that faces +Z."""
    at = np.linspace(-0.5, 0.5, side + 1)
    x, y = np.meshgrid(at, at)
    positions = np.float32(np.stack([x, y, 0 * x], axis=-1).reshape(-1, 3))
    corner = (np.arange(side)[:, None] * (side + 1) + np.arange(side)).ravel()
    quads = np.stack([corner, corner + 1, corner + side + 2, corner, corner + side + 2, corner + side + 1], axis=1)
    return Mesh("grid", positions, 0, indices=quads.astype(np.uint32).ravel(),
                normals=np.float32([[0, 0, 1]] * len(positions)))


def rectangle_above(a: np.ndarray, b: np.ndarray, height: float) -> np.ndarray:
    """Form factor of a parallel rectangle with a corner above a point (Howell, "Radiation Configuration Factors", B-4);
    signed, so that it can be summed for other places."""
    a, b = a / height, b / height
    p, q = np.sqrt(1 + a * a), np.sqrt(1 + b * b)
    return (a / p * np.arctan(b / p) + b / q * np.arctan(a / q)) / (2 * np.pi)


def plates(gap: float, far_emits: float) -> Scene:
    """A finely tessellated unit square that faces an emissive one."""
    lower = Mesh(**{**vars_of(grid(8)), "material": 0})
    upper = Mesh(**{**vars_of(grid(1)), "material": 1})
    shining = Material(metallic=0.0, base_color=(0.0, 0.0, 0.0, 1.0), specular=0.0, emissive=(far_emits,) * 3)
    turned = np.diag([1.0, -1.0, -1.0, 1.0])
    turned[2, 3] = gap
    return scene(lower, (upper, turned), materials=(WHITE, shining))


def vars_of(mesh: Mesh) -> dict[str, object]:
    return {name: getattr(mesh, name) for name in ("name", "positions", "material", "indices", "normals")}


@pytest.mark.parametrize("gap", [0.25, 1.0])
def test_a_shining_plate_lights_the_one_below_by_its_form_factor(context: Context, gap: float) -> None:
    model = plates(gap, 3.0)
    found = bake_incoming(context, model, SETTINGS, samples=1 << 17).per_instance[0].astype(np.float64)
    x, y = model.meshes[0].positions[:, :2].astype(np.float64).T
    expected = sum(rectangle_above(0.5 + sx * x, 0.5 + sy * y, gap) for sx in (-1, 1) for sy in (-1, 1))
    for values in (found[:, 3], found[:, 0] / 3.0):
        assert np.abs(values - expected).max() < 0.06
        assert np.sqrt(((values - expected) ** 2).mean()) < 0.025, "means about the vertices alone are off by 0.045"
    np.testing.assert_array_equal(found[:, :1].repeat(2, axis=1), found[:, 1:3])


def small_lamp() -> Scene:
    """A plate of a 400th of the one below."""
    model = plates(0.5, 1.0)
    below, above = model.instances
    shrunk = replace(above, transform=above.transform @ np.diag([0.05, 0.05, 1.0, 1.0]))
    return replace(model, instances=(below, shrunk))


def test_a_small_lamp_needs_few_paths(context: Context) -> None:
    """At most one in a hundred paths hits it: these alone find none of it."""
    model = small_lamp()
    found = bake_incoming(context, model, SETTINGS, samples=1 << 14).per_instance[0].astype(np.float64)
    distance2 = 0.25 + (model.meshes[0].positions[:, :2].astype(np.float64) ** 2).sum(axis=1)
    expected = 0.0025 * 0.25 / (np.pi * distance2**2)
    assert np.sqrt((((found[:, 0] - expected) / expected) ** 2).mean()) < 0.06


def test_a_lamp_shines_through_its_coat(context: Context) -> None:
    """A smooth coat keeps what it would reflect (Schlick): the same paths find that much less."""
    bare = small_lamp()
    white, shining = bare.materials
    coated = replace(bare, materials=(white, replace(shining, clearcoat=1.0)))
    light = [bake_incoming(context, model, SETTINGS, samples=1 << 14).per_instance[0][:, 0] for model in (bare, coated)]
    cosine = 0.5 / np.sqrt(0.25 + (bare.meshes[0].positions[:, :2] ** 2).sum(axis=1))
    kept = 0.04 + 0.96 * (1 - cosine) ** 5
    assert np.abs(light[1] / light[0] - (1 - kept)).max() < 0.01


@pytest.mark.parametrize("scale", [1e-6, 1.0, 1e6])
def test_a_scene_of_any_size_and_place_gives_the_same(context: Context, scale: float) -> None:
    model = plates(0.5, 1.0)
    place = moved((scale * 1e3, 0, 0), scale)
    same = scene(*((m, place @ i.transform) for m, i in zip(model.meshes, model.instances)), materials=model.materials)
    ours, theirs = (bake_incoming(context, s, SETTINGS, 1 << 12).per_instance[0] for s in (model, same))
    assert np.abs(ours - theirs).max() < 0.03


def test_in_a_corner_walls_cover_half_and_leak_nothing(context: Context) -> None:
    """Two walls meet at a right angle, and vertices lie on the edge. Light from outside must not leak through it."""
    floor, wall = (grid(4), facing_floor()), (grid(4), moved((0, 0.5, -0.5)))
    model = scene(floor, wall)
    below, beside = bake_incoming(context, model, SETTINGS, samples=1 << 17).per_instance
    z = (grid(4).positions @ facing_floor()[:3, :3].T)[:, 2]
    x = grid(4).positions[:, 0]
    middle = np.abs(x) < 0.3
    in_corner, open_end = below[(z < -0.49) & middle, 3], below[(z > 0.49) & middle, 3]
    # An infinite strip of height h at distance d has the form factor (1 - d / sqrt(d^2 + h^2)) / 2.
    assert np.all(in_corner > 0.38) and np.all(in_corner < 0.51)
    assert np.all(open_end < 0.15)
    assert not below[:, :3].any() and not beside[:, :3].any(), "there is no light"


def test_in_a_furnace_what_is_covered_is_as_bright_as_the_rest(context: Context) -> None:
    model = in_furnace(scene((grid(4), facing_floor()), (grid(4), moved((0, 0.5, -0.5)))))
    for values in bake_incoming(context, model, SETTINGS, samples=1 << 17).per_instance:
        values = values.astype(np.float64)
        assert np.abs(values[:, :3] - values[:, 3:]).max() < 0.04
        assert abs(values[:, :3].mean() / values[:, 3].mean() - 1) < 0.01
    for values in bake_outgoing(context, model, SETTINGS, samples=1 << 14).per_instance:
        assert np.abs(values - 1.0).max() < 0.08


def test_a_ball_covers_nothing_of_itself(context: Context) -> None:
    (values,) = bake_incoming(context, in_furnace(scene(sphere(segments=24))), SETTINGS, samples=1 << 14).per_instance
    assert not values.any()


def test_vertices_at_one_place_have_one_value(context: Context) -> None:
    ball = sphere(segments=16)
    model = scene(ball, (grid(2), facing_floor(4.0, -1.2)))
    values = bake_incoming(context, model, SETTINGS, samples=1 << 14).per_instance[0].reshape(9, 17, 4)
    np.testing.assert_array_equal(values[:, 0], values[:, -1])
    assert values[6, :, 3].min() > 0.3


def test_the_same_every_time_and_each_instance_its_own(context: Context) -> None:
    ball, floor = sphere(segments=16), grid(2)
    model = scene((ball, moved((0, 0, 0))), (ball, moved((0, 3, 0))), (floor, facing_floor(8.0, -1.2)))
    first, second = (bake_incoming(context, model, SETTINGS, samples=1 << 12) for _ in range(2))
    for a, b in zip(first.per_instance, second.per_instance, strict=True):
        np.testing.assert_array_equal(a, b)
    assert first.per_instance[0][:, 3].mean() > 1.5 * first.per_instance[1][:, 3].mean()


@pytest.mark.parametrize("name", NOTHING_MUCH)
@pytest.mark.parametrize("bake", [bake_incoming, bake_outgoing])
def test_what_has_no_surface_has_no_light(context: Context, name: str, bake) -> None:
    model = NOTHING_MUCH[name]
    light: VertexLight = bake(context, model, SETTINGS, samples=1 << 8)
    assert [len(values) for values in light.per_instance] == [len(model.meshes[i.mesh].positions)
                                                              for i in model.instances]
    assert all(np.isfinite(values).all() for values in light.per_instance)


def test_points_are_no_more_than_there_is_room_for() -> None:
    surfaces = surface_triangles(scene(sphere(segments=48)), [0])
    assert len(sample_surfaces(surfaces, 100).triangle) == np.count_nonzero(surfaces.areas) > 2000
    few = sample_surfaces(surfaces, 100, most=300)
    assert 200 < len(few.triangle) < 500
    assert len(np.unique(few.triangle)) == len(few.triangle)


def test_one_point_that_met_a_rare_light_spoils_nothing() -> None:
    surfaces = surface_triangles(scene(grid(8)), [0])
    points = sample_surfaces(surfaces, 1000)
    found = np.tile([0.2, 0.1, 0.3, 0.5], (len(points.triangle), 1))
    np.testing.assert_allclose(fit(surfaces, points, found), np.tile(found[0], (81, 1)), rtol=1e-6)
    found[300, :3] = 4000.0
    assert fit(surfaces, points, found)[:, :3].max() < 0.8
