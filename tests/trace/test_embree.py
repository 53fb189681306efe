"""Rays traced with Embree give hits of instances."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest
from needs import needs
from stand_ins import Geometry, Instance, fill, make_wavefront, mesh, sphere, trace

from viewer.gpu.context import Context
from viewer.trace.kinds import GLASS
from viewer.trace.layout import ENDED, FREE, IDLE, IN_FLIGHT, INSTANCE_MASK, KIND_SHIFT, MISS
from viewer.trace.rays.intersect import make_intersector

pytestmark = needs("embree")

SQUARE = mesh([(-1, -1, 0), (1, -1, 0), (1, 1, 0), (-1, 1, 0)], [(0, 1, 2), (0, 2, 3)])
DOWN = np.array([(0.0, 0.0, -1.0)])


def at(z: float) -> np.ndarray:
    transform = np.eye(3, 4)
    transform[2, 3] = z
    return transform


def test_a_hit_names_instance_kind_triangle_and_barycentrics(context: Context) -> None:
    instances = [Instance(0, at(-0.5)), Instance(1, at(0.25), kind=GLASS), Instance(0, at(0.0))]
    geometry = Geometry([SQUARE, SQUARE], instances)
    embree = make_intersector(context, geometry, kind="embree")
    (hit,) = trace(context, embree, np.array([(-0.5, 0.5, 1.0)]), DOWN)
    assert (hit[0], hit[1]) == (GLASS.number << KIND_SHIFT | 1, 1)
    u, v = hit[2:].view(np.float32)
    # p = (1 - u - v) p0 + u p1 + v p2 of triangle (0, 2, 3)
    assert (u, v) == pytest.approx((0.25, 0.5), abs=1e-6)
    (hit,) = trace(context, embree, np.array([(-0.5, 0.5, 0.1)]), DOWN)
    assert (hit[0], hit[1]) == (2, 1)
    (hit,) = trace(context, embree, np.array([(-0.5, 0.5, 0.1)]), np.array([(1.0, 0.0, 0.0)]))
    assert hit[0] == MISS


def test_shadow_rays_stop_before_the_light(context: Context) -> None:
    embree = make_intersector(context, Geometry([SQUARE]), kind="embree")
    origin = np.repeat([(0.3, 0.1, 1.0)], 4, axis=0)
    vector = np.array([(0, 0, -1.0), (0, 0, -1.001), (0, 0, 1.0), (0, 0, 0)])
    hits = trace(context, embree, origin, np.repeat([(1.0, 0, 0)], 4, axis=0), origin, vector)
    np.testing.assert_array_equal(hits[:, 0] & FREE != 0, [True, False, True, False])
    np.testing.assert_array_equal(hits[:, 0] & ~np.uint32(FREE), MISS)


def test_only_slots_that_have_rays_are_traced(context: Context) -> None:
    embree = make_intersector(context, Geometry([SQUARE]), kind="embree")
    wavefront = make_wavefront(context.gl, (16, 16))
    states = np.array([IDLE, IN_FLIGHT, ENDED, 0.1])
    origin = np.c_[np.repeat([(0.3, 0.1, 1.0)], 4, axis=0), states]
    direction = np.repeat(DOWN, 4, axis=0)
    vector = -direction * [[1], [0], [1], [1]]
    fill(wavefront, origin=origin, direction=direction, shadow_origin=origin, shadow_vector=vector)
    answer = embree.trace(embree.fetch(wavefront))
    assert (answer.alive, answer.rays) == (3, 4)
    embree.store(wavefront, answer)
    hits = np.frombuffer(wavefront.hit.read(), np.uint32).reshape(-1, 4)[:5, 0]
    np.testing.assert_array_equal(hits, np.array([MISS, 0, MISS | FREE, FREE, MISS], np.uint32))


def test_threads_find_the_same_hits(context: Context, monkeypatch: pytest.MonkeyPatch) -> None:
    """Rays of two wavefronts are traced at once, in tasks of a few paths each, some of which have no rays."""
    from viewer.trace.rays import embree as module

    embree = make_intersector(context, Geometry([sphere(8, 12)], [Instance(0, at(z)) for z in (-1, 1)]), kind="embree")
    rng = np.random.default_rng(7)
    wavefronts = [make_wavefront(context.gl, (16, 16)) for _ in range(2)]
    for wavefront in wavefronts:
        origin, direction, vector = rng.normal(size=(3, 256, 3))
        fill(wavefront, origin=np.c_[origin, rng.integers(-1, 2, 256)], direction=direction, shadow_origin=origin,
             shadow_vector=vector * rng.integers(0, 2, (256, 1)))
    alone = [embree.trace(embree.fetch(wavefront)) for wavefront in wavefronts]
    monkeypatch.setattr(module, "TASK", 7)
    for _ in range(3):
        finish = [embree.begin(embree.fetch(wavefront)) for wavefront in wavefronts]
        for answer, expected in zip([finish[0](), finish[1]()], alone, strict=True):
            assert (answer.alive, answer.rays) == (expected.alive, expected.rays)
            np.testing.assert_array_equal(answer.hits, expected.hits)
            np.testing.assert_array_equal(answer.classes, expected.classes)
    assert 20 < np.count_nonzero(alone[0].hits[:, 0] & ~np.uint32(FREE) != MISS) < 240
    assert not np.array_equal(alone[0].hits, alone[1].hits)


def test_threads_find_the_same_triangles(context: Context, monkeypatch: pytest.MonkeyPatch) -> None:
    """As for rays that a shader judges afterwards, here with a reach of their own."""
    from viewer.trace.rays import embree_triangles as module

    triangles = make_intersector(context, Geometry([sphere(8, 12)]), kind="embree").triangles
    rng = np.random.default_rng(8)
    origin, direction = rng.normal(size=(2, 100, 3)).astype(np.float32)
    reach = rng.uniform(0, 2, 100).astype(np.float32)
    alone = triangles.intersect(origin, direction, reach.copy())
    monkeypatch.setattr(module, "TASK", 7)
    for name, values in triangles.intersect(origin, direction, reach.copy()).items():
        np.testing.assert_array_equal(values, alone[name])
    assert 10 < np.count_nonzero(alone["primID"] >= 0) < 90


def test_many_instances_keep_their_numbers(context: Context) -> None:
    rng = np.random.default_rng(5)
    places = rng.uniform(-0.9, 0.9, (3000, 3))
    small = [np.c_[0.001 * np.eye(3), place] for place in places]
    geometry = Geometry([sphere(4, 6), SQUARE], [Instance(i % 2, transform) for i, transform in enumerate(small)])
    embree = make_intersector(context, geometry, kind="embree")
    target = rng.permutation(3000)[:500]
    # Rays start just above the surfaces, a little beside the spheres' poles and the squares' diagonals.
    hits = trace(context, embree, places[target] + (2e-4, 3e-4, 0.002), np.repeat(DOWN, 500, axis=0))
    np.testing.assert_array_equal(hits[:, 0], target)


class Panes:
    """Stands for the shader's decision: all rays pass instance 0, none pass the others."""

    def __init__(self) -> None:
        self.asked = 0

    def pass_through(self, hits: np.ndarray, vectors: np.ndarray) -> np.ndarray:
        self.asked += len(hits)
        return hits[:, 0] & INSTANCE_MASK == 0


def test_shadow_rays_go_through_what_lets_them(context: Context, monkeypatch: pytest.MonkeyPatch) -> None:
    panes = Panes()
    monkeypatch.setattr("viewer.trace.rays.embree.SeeThrough", lambda context, surfaces: panes)
    instances = [Instance(0, at(0.5), see_through=True), Instance(0, at(0.0), see_through=True), Instance(0, at(-0.5))]
    embree = make_intersector(context, Geometry([SQUARE], instances), SimpleNamespace(), kind="embree")
    origin = np.array([(0.3, 0.1, 1.0), (0.3, 0.1, 1.0), (0.3, 0.1, 1.0), (0.3, 0.1, -0.3)])
    vector = DOWN * [[0.4], [0.9], [1.2], [0.4]]
    hits = trace(context, embree, origin, np.repeat(DOWN, 4, axis=0), origin, vector)
    # The vectors cross no pane, the first pane, both panes, and the opaque square. The nearest hit is always the first
    # pane.
    np.testing.assert_array_equal(hits[:, 0], np.array([FREE, FREE, 0, 2], np.uint32))
    assert panes.asked == 3


def test_shadow_rays_stop_after_so_many_layers(context: Context, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("viewer.trace.rays.embree.SeeThrough", lambda context, surfaces: Panes())
    monkeypatch.setattr("viewer.trace.rays.embree.MAX_LAYERS", 3)
    squares = [mesh([(-1, -1, z), (1, -1, z), (0, 1, z)], [(0, 1, 2)]) for z in (0.0, 0.1, 0.2, 0.3)]
    for count, free in ((2, FREE), (3, 0)):
        stack = mesh(np.concatenate([square.positions for square in squares[:count]]), np.arange(3 * count))
        geometry = Geometry([stack], [Instance(0, np.eye(3, 4), see_through=True)])
        embree = make_intersector(context, geometry, SimpleNamespace(), kind="embree")
        hits = trace(context, embree, np.array([(0, 0, 1.0)]), DOWN, np.array([(0, 0, 1.0)]), 2 * DOWN)
        assert hits[0, 0] & FREE == free


def test_a_tree_is_built_anew_only_for_triangles_that_moved(context: Context, monkeypatch: pytest.MonkeyPatch) -> None:
    """A pose in which only materials change shares its meshes and transforms with the one before."""
    from embreex.mesh_construction import TriangleMesh

    built = []
    monkeypatch.setattr("viewer.trace.rays.embree_triangles.TriangleMesh", lambda scene, *arrays: built.append(
        TriangleMesh(scene, *arrays)))
    embree = make_intersector(context, Geometry([SQUARE], [Instance(0, at(0.0)), Instance(0, at(0.5))]), kind="embree")
    steps = [([SQUARE], [Instance(0, at(0.0)), Instance(0, at(0.5))], 1, 1),
             ([SQUARE], [Instance(0, at(0.0)), Instance(0, at(0.25))], 2, 1),
             ([SQUARE], [Instance(0, at(0.0)), Instance(0, at(0.25), kind=GLASS)], 3, GLASS.number << KIND_SHIFT | 1),
             ([SQUARE], [Instance(0, at(0.0))], 4, 0),
             ([mesh(SQUARE.positions, SQUARE.triangles)], [Instance(0, at(0.0))], 5, 0),
             ([SQUARE, SQUARE], [Instance(1, at(0.0))], 6, 0)]
    for meshes, instances, count, nearest in steps:
        embree.move(Geometry(meshes, instances))
        (hit,) = trace(context, embree, np.array([(0.3, 0.1, 1.0)]), DOWN)
        assert (len(built), hit[0]) == (count, nearest)
