"""shaders/trace/interaction.glsl against float64: positions, normals and frames at all scales."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from harness import evaluate
from interactions import Hits, ask, bend, expect, random_hits
from shapes import moved, plate, scene, sphere

from viewer.scene.material import Material
from viewer.scene.mesh import Mesh
from viewer.scene.scene import Instance
from viewer.scene.tangents import any_tangents
from viewer.trace.scene.geometry import trace_geometry

ULP = 2.0**-23
"""A unit in the last place of 1, the largest coordinate of tracer space."""
COUNT = 4000
RANDOM = np.random.default_rng(7)


def turned(seed: int, scale=(1.0, 1.0, 1.0), offset=(0.0, 0.0, 0.0)) -> np.ndarray:
    """A rotation after a scale, which may be negative."""
    q, _ = np.linalg.qr(np.random.default_rng(seed).normal(size=(3, 3)))
    matrix = np.eye(4)
    matrix[:3, :3] = q * np.sign(np.linalg.det(q)) @ np.diag(scale)
    matrix[:3, 3] = offset
    return matrix


def soup(seed: int, offset: float = 0.0) -> Mesh:
    """Triangles with smooth normals near their geometric normals, two UV sets and colours."""
    random = np.random.default_rng(seed)
    positions = (random.uniform(-1, 1, (60, 3, 3)) + offset).astype(np.float32)
    face = np.cross(positions[:, 1] - positions[:, 0], positions[:, 2] - positions[:, 0])
    face /= np.linalg.norm(face, axis=1, keepdims=True)
    normals = face[:, None] + 0.4 * random.uniform(-1, 1, (60, 3, 3))
    normals = (normals / np.linalg.norm(normals, axis=2, keepdims=True)).reshape(-1, 3).astype(np.float32)
    uvs = tuple(random.uniform(-2, 2, (180, 2)).astype(np.float32) for _ in range(2))
    tangents = np.concatenate([any_tangents(normals), np.ones((180, 1), np.float32)], axis=1)
    return Mesh("soup", positions.reshape(-1, 3), 0, normals=normals, tangents=tangents, uvs=uvs,
                colors=random.uniform(0, 1, (180, 4)).astype(np.float32))


PLACES = {
    "as it is": (soup(1), np.eye(4)),
    "turned and stretched": (soup(1), turned(1, (1.0, 3.0, 0.2), (3, -1, 2))),
    "mirrored": (soup(2), turned(2, (-1.0, 0.5, 2.0), (-2, 0, 1))),
    "small": (soup(3), turned(3, (1e-3, 1e-3, 1e-3), (1, 1, -1))),
    "far off its own origin": (soup(4, 1000.0), turned(4, (1.0, 1.0, 1.0), (-1000, -1000, -1000))),
}
ALL = scene(*PLACES.values(), materials=(Material(base_color=(1, 1, 1, 1)),))


def test_everything_agrees_with_float64(context, tmp_path):
    geometry = trace_geometry(ALL)
    hits = random_hits(geometry, COUNT)
    found, expected = ask(context, tmp_path, ALL, hits), expect(ALL, geometry, hits)
    assert np.abs(found["position"] - expected["position"]).max() < 2 * ULP
    wo = hits.wo.astype(np.float64)
    facing = np.einsum("ij,ij->i", expected["front"], wo)
    sure = np.abs(facing) > 1e-3
    assert (found["is_front"] == (facing > 0))[sure].all() and found["is_front"].any() and not found["is_front"].all()
    side = np.where(facing > 0, 1.0, -1.0)[:, None]
    assert np.abs(found["n_geometric"] - side * expected["front"])[sure].max() < 2e-4
    assert np.percentile(np.abs(found["n_geometric"] - side * expected["front"])[sure], 99) < 2e-6
    np.testing.assert_allclose(found["area"], expected["area"], rtol=2e-5, atol=1e-9)
    np.testing.assert_allclose(found["color"], expected["color"], atol=1e-6)
    # No map reads the second UV set, so it is left out.
    np.testing.assert_allclose(found["uv0"], expected["uv0"], atol=1e-6)
    bent = bend(expected["shading"], side * expected["front"], wo)
    grazing = np.abs(facing) < 0.02  # where bending magnifies the error of the geometric normal
    assert np.abs(found["n"] - bent)[~grazing].max() < 1e-3
    assert np.percentile(np.abs(found["n"] - bent)[~grazing], 99) < 1e-5


def test_frames_are_orthonormal_and_reflections_leave_the_surface(context, tmp_path):
    hits = random_hits(trace_geometry(ALL), COUNT, 1)
    found = ask(context, tmp_path, ALL, hits)
    frame = np.stack([found["t"], found["b"], found["n"]], axis=1)
    assert np.abs(frame @ frame.transpose(0, 2, 1) - np.eye(3)).max() < 1e-5
    assert (np.linalg.det(frame) > 0).all()
    wo = hits.wo.astype(np.float64)
    assert np.einsum("ij,ij->i", found["n_geometric"], wo).min() >= 0
    cos = np.einsum("ij,ij->i", found["n"], wo)
    assert cos.min() > 0
    mirrored = 2 * cos[:, None] * found["n"] - wo
    assert np.einsum("ij,ij->i", mirrored, found["n_geometric"]).min() > 0


@pytest.mark.parametrize("scale", [1e-6, 1e-3, 1e3, 1e6])
def test_scale_makes_no_difference(context, tmp_path, scale):
    larger = replace(ALL, instances=tuple(
        Instance(i.mesh, np.diag([scale, scale, scale, 1.0]) @ i.transform) for i in ALL.instances))
    hits = random_hits(trace_geometry(ALL), 500, 2)
    a, b = (ask(context, tmp_path, each, hits) for each in (ALL, larger))
    for name in ("position", "n_geometric", "n", "t", "area"):
        assert np.abs(a[name] - b[name]).max() < (1 if name == "position" else 200) * ULP, name


@pytest.mark.parametrize("distance", [1e3, 1e6, 1e9])
def test_place_makes_no_difference(context, tmp_path, distance):
    away = replace(ALL, instances=tuple(Instance(i.mesh, moved((distance, -distance, 2 * distance)) @ i.transform)
                                        for i in ALL.instances))
    hits = random_hits(trace_geometry(ALL), 500, 3)
    a, b = (ask(context, tmp_path, each, hits) for each in (ALL, away))
    # The precision of float64 that far out
    assert np.abs(a["position"] - b["position"]).max() < ULP + 8 * distance * 2.0**-52


def test_a_mesh_whose_own_numbers_are_far_away_keeps_its_digits(context, tmp_path):
    mesh = sphere(segments=16)
    far = replace(mesh, positions=(mesh.positions * 0.5 + np.float32(4096)).astype(np.float32))
    one = scene((far, np.eye(4)))
    geometry = trace_geometry(one)
    hits = random_hits(geometry, 1000)
    found, expected = ask(context, tmp_path, one, hits), expect(one, geometry, hits)
    assert np.abs(found["position"] - expected["position"]).max() < 2 * ULP


def test_flat_meshes_and_missing_normals_have_the_triangles_own(context, tmp_path):
    bare = replace(plate(), normals=None, tangents=None)
    zero = replace(plate(), normals=np.zeros((4, 3), np.float32), tangents=None)
    opposed = replace(plate(), normals=np.float32([[1, 0, 0], [-1, 0, 0], [1, 0, 0], [-1, 0, 0]]), tangents=None)
    tilted = turned(5)
    flat = scene((bare, tilted), (zero, tilted), (opposed, tilted))
    hits = random_hits(trace_geometry(flat), 600)
    last = hits.instance == 2
    hits.barycentric[last] = (0.5, 0.0)  # where the normals of the first edge cancel
    hits.triangle[last] = 0
    found = ask(context, tmp_path, flat, hits)
    side = np.sign(hits.wo @ tilted[:3, 2])[:, None]
    assert np.abs(found["n"] - side * tilted[:3, 2]).max() < 1e-6


def test_triangles_without_area_and_squashed_instances_give_numbers(context, tmp_path):
    line = Mesh("line", np.float32([[0, 0, 0], [1, 1, 0], [2, 2, 0], [0.5, 0.5, 0], [0.5, 0.5, 0], [0.5, 0.5, 0]]), 0,
                normals=np.float32([[0, 0, 1]] * 6))
    squashed = scene((line, np.eye(4)), (plate(), np.diag([1, 1, 0, 1.0])), (plate(), np.diag([1, 0, 0, 1.0])),
                     (sphere(segments=8), np.diag([1e-30, 1e-30, 1e-30, 1.0])), (plate(), np.diag([0, 0, 0, 1.0])))
    hits = random_hits(trace_geometry(squashed), 2000)
    found = ask(context, tmp_path, squashed, hits)
    for name in ("position", "n_geometric", "n", "t", "b", "area"):
        assert np.isfinite(found[name]).all(), name
    for name in ("n_geometric", "n", "t", "b"):
        np.testing.assert_allclose(np.linalg.norm(found[name], axis=1), 1, atol=1e-5)
    flat = hits.instance == 1  # squashing a plate along its normal does not change it
    assert np.abs(np.abs(found["n"][flat]) - [0, 0, 1]).max() < 1e-6


def test_emitters_are_numbered_through(context, tmp_path):
    lamp, dull = Material(emissive=(1, 2, 3)), Material()
    lit = scene((plate(1), np.eye(4)), (plate(0), moved((3, 0, 0))), (plate(0), moved((6, 0, 0))),
                materials=(lamp, dull))
    hits = random_hits(trace_geometry(lit), 200)
    found = ask(context, tmp_path, lit, hits)
    expected = np.where(hits.instance == 0, -1, 2 * (hits.instance - 1) + hits.triangle)
    np.testing.assert_array_equal(found["emitter"], expected)


def cones(count: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Arbitrary shading normals, geometric normals, and directions above the surface, many of them grazing."""
    random = np.random.default_rng(11)
    n, g, o = (v / np.linalg.norm(v, axis=1, keepdims=True) for v in random.normal(size=(3, count, 3)))
    grazing = random.uniform(size=count) < 0.5
    height = np.where(grazing, 10.0 ** random.uniform(-5.5, 0, count), random.uniform(size=count))
    flat = o - np.einsum("ij,ij->i", o, g)[:, None] * g
    flat /= np.linalg.norm(flat, axis=1, keepdims=True)
    o = height[:, None] * g + np.sqrt(1 - height**2)[:, None] * flat
    near = random.uniform(size=count) < 0.5
    n[near] = g[near] + 10.0 ** random.uniform(-6, 0, (near.sum(), 1)) * n[near]
    return n / np.linalg.norm(n, axis=1, keepdims=True), g, o


def test_bent_normals_in_float64():
    n, g, o = cones(20000)
    bent = bend(n, g, o)
    cos_g = np.einsum("ij,ij->i", g, o)
    lift = np.minimum(0.9 * cos_g, 0.01)
    cos = np.einsum("ij,ij->i", bent, o)
    mirrored = 2 * cos[:, None] * bent - o
    assert (cos >= (cos_g + lift) / 2 - 1e-9).all()
    assert (np.einsum("ij,ij->i", mirrored, g) >= lift * (1 - 1e-6) - 1e-9).all()
    np.testing.assert_allclose(bend(-n, g, o), bent, atol=1e-9)  # the sign of the stored normal does not matter
    np.testing.assert_allclose(bend(g, g, o), g, atol=1e-6)  # the geometric normal is not changed
    step = 1e-7 * np.roll(n, 1, axis=0)
    moved_n = (n + step) / np.linalg.norm(n + step, axis=1, keepdims=True)
    change = np.linalg.norm(bend(moved_n, g, o) - bent, axis=1)
    assert np.percentile(change, 99) < 1e-4  # continuous


def test_bent_normals_in_the_shader(context, tmp_path):
    n, g, o = (v.astype(np.float32) for v in cones(16000))
    found = evaluate(context, tmp_path, "trace/shading_normal.glsl",
                     "o0 = vec4(bend_normal(f0.xyz, vec3(f0.w, f1.xy), vec3(f1.zw, f2.x)), 0.0);",
                     np.concatenate([n, g, o], axis=1))[:, 0, :3]
    cos = np.einsum("ij,ij->i", found, o.astype(np.float64))
    mirrored = 2 * cos[:, None] * found - o
    height = np.einsum("ij,ij->i", mirrored, g.astype(np.float64))
    cos_g = np.einsum("ij,ij->i", g.astype(np.float64), o.astype(np.float64))
    assert cos.min() > 0
    # Directions within 1e-6 of the horizon keep the geometric normal; float32 resolves their height to about 1e-7.
    assert (height > 0)[cos_g > 1e-6].all() and height.min() > -2e-7
    clear = cos_g > 0.03
    assert np.abs(found - bend(*(v.astype(np.float64) for v in (n, g, o))))[clear].max() < 1e-4


def test_new_origins_are_off_the_surface_and_close_to_it(context, tmp_path):
    count = 3000
    n = RANDOM.normal(size=(count, 3))
    n = (n / np.linalg.norm(n, axis=1, keepdims=True)).astype(np.float32)
    p = (RANDOM.uniform(-1, 1, (count, 3)) * 10.0 ** RANDOM.uniform(-12, 0, (count, 1))).astype(np.float32)
    p[:100] = 0
    body = "o0 = vec4(offset_origin(f0.xyz, vec3(f0.w, f1.xy)), 0.0);"
    rows = np.concatenate([p, n], axis=1)
    found = evaluate(context, tmp_path, "trace/offset_origin.glsl", body, rows)[:, 0, :3]
    step = np.einsum("ij,ij->i", found - p.astype(np.float64), n)
    # The error of positions is 2 ulps of 1; the least offset along an axis is 256 ulps of 1/32.
    assert step.min() > 2 * ULP and step.max() < 2 * 256 * ULP


def test_directions_along_the_triangle_give_frames(context, tmp_path):
    grazing = scene((sphere(segments=12), np.eye(4)))
    hits = random_hits(trace_geometry(grazing), 2000)
    mesh = grazing.meshes[0]
    corner = mesh.indices.reshape(-1, 3)[hits.triangle]
    edge = mesh.positions[corner[:, 1]] - mesh.positions[corner[:, 0]]
    wo = edge + 1e-6 * hits.wo  # along the triangle, up to the last digits
    length = np.linalg.norm(wo, axis=1, keepdims=True)
    wo = np.where(length > 1e-3, wo / np.maximum(length, 1e-9), hits.wo)
    found = ask(context, tmp_path, grazing, Hits(hits.instance, hits.triangle, hits.barycentric, wo.astype(np.float32)))
    for name in ("n", "t", "b"):
        np.testing.assert_allclose(np.linalg.norm(found[name], axis=1), 1, atol=1e-4)
