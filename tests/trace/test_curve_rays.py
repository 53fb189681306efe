"""Rays through strands, by both intersectors: they hit the first segment that they enter, and none from within."""

from __future__ import annotations

import itertools
from concurrent.futures import ThreadPoolExecutor
from threading import Event, Timer
from types import SimpleNamespace

import numpy as np
import pytest
from curve_twins import closeness, depth, entry
from needs import needs
from stand_ins import Geometry, mesh, trace
from strands import strands
from waiting import PATIENCE_S

from viewer.errors import UsageError
from viewer.gpu.context import Context
from viewer.scene.curves import Curves
from viewer.scene.scene import Scene
from viewer.trace.kinds import FIBRE
from viewer.trace.layout import FREE, KIND_SHIFT, MISS
from viewer.trace.rays.curve_boxes import curve_boxes
from viewer.trace.rays.intersect import make_intersector
from viewer.trace.scene.curves import TraceCurves, trace_curves

KINDS = [pytest.param("embree", marks=needs("embree")), "bvh"]
FIBRES = FIBRE.number << KIND_SHIFT


@pytest.fixture(scope="module")
def curves() -> TraceCurves:
    return trace_curves(Scene("strands", curves=strands()))


def test_points_that_repeat_the_one_before_are_left_out():
    """They would be spheres of no direction, in the very place of the strand's end."""
    points = np.float32([[0, 0, 0], [3, 0, 0], [4, 1, 0], [1, 1, 1], [2, 2, 2]])
    radii = np.float32([1, 1, 2, 0.5, 0.5])

    def traced(rows, offsets):
        curves = Curves("strands", points[rows], radii[rows], offsets, [False, False])
        return trace_curves(Scene("strands", curves=(curves,)))

    plain, repeated = traced([0, 1, 2, 3, 4], [0, 3, 5]), traced([0, 0, 1, 2, 2, 2, 3, 4, 4], [0, 6, 9])
    np.testing.assert_array_equal(repeated.points, plain.points)
    np.testing.assert_array_equal(repeated.first, plain.first)
    assert len(traced([0, 1, 3, 3, 3], [0, 2, 5]).first) == 2, "a strand of one place is a sphere"


def bodies(curves: TraceCurves) -> np.ndarray:
    first = curves.first.astype(np.int64)
    return np.stack([curves.points[first], curves.points[first + 1]], axis=1)


def rays(count: int, seed: int = 0) -> tuple[np.ndarray, np.ndarray]:
    rng = np.random.default_rng(seed)
    o = rng.normal(size=(count, 3))
    o *= 1.5 / np.linalg.norm(o, axis=1, keepdims=True)
    d = 0.5 * rng.normal(size=(count, 3)) - o
    return o.astype(np.float32), (d / np.linalg.norm(d, axis=1, keepdims=True)).astype(np.float32)


def entries(curves: TraceCurves, o: np.ndarray, d: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """t (rays, segments) of all entries, and how near the rays pass to a surface that they may graze, (rays,)."""
    all_bodies = bodies(curves)
    t, gap = np.empty((2, len(o), len(all_bodies)))
    for k, body in enumerate(all_bodies):
        same = np.broadcast_to(body, (len(o), 2, 4))
        t[:, k] = entry(o, d, same)[0]
        gap[:, k] = closeness(o, d, same)
    return t, abs(gap).min(axis=1)


@pytest.mark.parametrize("kind", KINDS)
def test_rays_hit_the_strand_that_they_enter_first(context: Context, curves: TraceCurves, kind: str) -> None:
    o, d = rays(400)
    t, gap = entries(curves, o, d)
    first = np.where(t > 0, t, np.inf).min(axis=1)
    intersector = make_intersector(context, Geometry([], curves=curves), kind=kind)
    hits = trace(context, intersector, o, d, o, 3 * d)
    intersector.release()
    clear = gap > 1e-5
    is_hit = hits[:, 0] & ~np.uint32(FREE) != MISS
    np.testing.assert_array_equal(is_hit[clear], np.isfinite(first[clear]))
    np.testing.assert_array_equal((hits[:, 0] & FREE == 0)[clear], is_hit[clear])  # shadow rays
    assert 0.2 < is_hit.mean() < 0.9
    row_to_segment = {row: k for k, row in enumerate(curves.first.tolist())}
    both = np.flatnonzero(is_hit & clear)
    segment = np.array([row_to_segment[row] for row in hits[both, 1].tolist()])
    np.testing.assert_array_equal(hits[both, 0] & ~np.uint32(FREE), curves.codes[segment])
    np.testing.assert_allclose(t[both, segment], first[both], atol=2e-5)
    assert set(curves.codes[segment]) == {FIBRES, FIBRES | 1}


@needs("embree")
def test_threads_share_rays_and_leave_none_out(curves: TraceCurves, monkeypatch: pytest.MonkeyPatch) -> None:
    from viewer.trace.rays import embree_curves

    embree = embree_curves.EmbreeCurves(curves)
    o, d = rays(1000)
    alone = embree.intersect(o, d, np.inf)
    monkeypatch.setattr(embree_curves, "_TASK", 7)
    for found, expected in zip(embree.intersect(o, d, np.inf), alone, strict=True):
        np.testing.assert_array_equal(found, expected)
    assert 0.2 < (alone[0] >= 0).mean() < 0.9


@needs("embree")
@pytest.mark.parametrize("given, threads", [("3", 3), ("0", 1), ("", 7), ("many", 7)])
def test_processes_share_the_cores(monkeypatch: pytest.MonkeyPatch, given: str, threads: int) -> None:
    from viewer.trace.rays import threads as module

    asked: list[int] = []
    monkeypatch.setenv("LP_NUM_THREADS", given)
    monkeypatch.setattr(module, "core_count", lambda: 7)
    monkeypatch.setattr(module, "ThreadPoolExecutor", lambda count, _name: asked.append(count))
    module.ray_threads.__wrapped__()
    assert asked == [threads]


@needs("embree")
def test_no_thread_traces_on_after_an_interruption(curves: TraceCurves, monkeypatch: pytest.MonkeyPatch) -> None:
    """The scene may be released then. The first call of Embree stops as Ctrl-C does, while another thread is in the
    second."""
    from viewer.trace.rays import embree_curves
    from viewer.trace.rays import threads as module

    embree, is_inside, may_leave, left = embree_curves.EmbreeCurves(curves), Event(), Event(), []
    calls = itertools.count()

    def intersect(_valid: int, _scene: int, packet: int, _context: None) -> None:
        if not next(calls):
            assert is_inside.wait(PATIENCE_S)
            Timer(0.05, may_leave.set).start()
            raise KeyboardInterrupt
        is_inside.set()
        assert may_leave.wait(PATIENCE_S)
        left.append(packet)

    monkeypatch.setattr(embree_curves, "_TASK", 1)
    with ThreadPoolExecutor(2) as threads:
        monkeypatch.setattr(module, "ray_threads", lambda: threads)
        monkeypatch.setattr(embree, "_library", SimpleNamespace(rtcIntersect16=intersect))
        with pytest.raises(KeyboardInterrupt):
            embree.intersect(*rays(6), np.inf)
        assert may_leave.is_set() and left
        after = len(left)
    assert len(left) == after


@pytest.mark.parametrize("kind", KINDS)
def test_a_ray_leaves_the_strand_that_it_starts_in(context: Context, curves: TraceCurves, kind: str) -> None:
    """From the axis of a segment, in any direction: what it is in, it does not hit, nor the inner ends of the segments
    that follow, which overlap at the joints."""
    rng = np.random.default_rng(1)
    all_bodies = bodies(curves)
    count = 400
    start = rng.integers(len(all_bodies), size=count)
    along = rng.uniform(0, 1, (count, 1))
    o = (all_bodies[start, 0] + along * (all_bodies[start, 1] - all_bodies[start, 0]))[:, :3].astype(np.float32)
    d = rng.normal(size=(count, 3))
    along_axis = (all_bodies[start, 1] - all_bodies[start, 0])[:, :3]
    d += 4 * rng.choice([-1, 0, 1], (count, 1)) * along_axis / np.linalg.norm(along_axis, axis=1, keepdims=True)
    d = (d / np.linalg.norm(d, axis=1, keepdims=True)).astype(np.float32)
    t, gap = entries(curves, o, d)
    # An entry that lies within a body is none of the union of all.
    for k in range(len(all_bodies)):
        (rows,) = np.nonzero((t[:, k] > 0) & np.isfinite(t[:, k]))
        point = o[rows] + t[rows, k, None] * d[rows]
        row = curves.first[k]
        near = np.flatnonzero((curves.first == row - 1) | (curves.first == row + 1)).tolist()
        near += [j for j in range(len(all_bodies)) if abs(j - k) > 1 and (
            np.array_equal(all_bodies[j, 0], all_bodies[k, 1]) or np.array_equal(all_bodies[j, 1], all_bodies[k, 0]))]
        for j in near:
            inside = depth(point, np.broadcast_to(all_bodies[j], (len(rows), 2, 4))) > 1e-5
            t[rows[inside], k] = np.inf
    first = np.where(t > 0, t, np.inf).min(axis=1)
    intersector = make_intersector(context, Geometry([], curves=curves), kind=kind)
    hits = trace(context, intersector, o, d)
    intersector.release()
    is_hit, clear = hits[:, 0] != MISS, gap > 1e-4
    np.testing.assert_array_equal(is_hit[clear], np.isfinite(first[clear]))
    assert 0.03 < is_hit.mean() < 0.97


@pytest.mark.parametrize("kind", KINDS)
def test_strands_seen_along_their_axis_are_hit_at_their_ends(context: Context, kind: str) -> None:
    """Embree misses even segments that rays are parallel to."""
    points = np.array([[-1, 0, 0], [0, 0, 0], [1, 0, 0]], np.float32)
    straight = trace_curves(Scene("straight", curves=(
        Curves("one", points, np.full(3, 0.2, np.float32), [0, 3], [False]),)))
    radius = float(straight.points[1, 3])
    y, z = (values.ravel() for values in np.meshgrid(*[np.linspace(-1.3, 1.3, 20) * radius] * 2))
    intersector = make_intersector(context, Geometry([], curves=straight), kind=kind)
    for sign in (-1, 1):
        for slant in (0.0, 1e-4):
            o = np.stack([np.full(400, -2.0 * sign), y, z], axis=1).astype(np.float32)
            hits = trace(context, intersector, o, np.tile(np.float32([sign, slant, 0]), (400, 1)))
            near_edge = np.abs(np.hypot(y, z) / radius - 1) < 0.01
            np.testing.assert_array_equal((hits[:, 0] != MISS)[~near_edge], (np.hypot(y, z) < radius)[~near_edge])
            seen = hits[hits[:, 0] != MISS, 1]
            assert set(seen.tolist()) == {int(straight.first[0 if sign > 0 else 1])}
    inside = np.float32([[0.1, 0, 0], [-0.1, 0.5 * radius, 0]])
    hits = trace(context, intersector, inside, np.float32([[1, 0, 0], [-1, 0, 0]]))
    intersector.release()
    assert (hits[:, 0] == MISS).all()


@pytest.mark.parametrize("kind", KINDS)
def test_the_nearer_of_a_triangle_and_a_strand_is_hit(context: Context, kind: str) -> None:
    line = Curves("line", np.float32([[-0.5, 0, 0], [0.5, 0, 0]]), np.float32([0.1, 0.1]), np.array([0, 2]),
                  np.array([False]))
    frame = mesh([(-1, -1, 0), (1, -1, 0), (1, 1, 0), (-1, 1, 0)], [(0, 1, 2), (0, 2, 3)])
    scene = Scene("line", curves=(line,))
    across = trace_curves(scene)
    below, above = (mesh(frame.positions + np.float32([0, 0, z]), frame.triangles) for z in (-0.5, 0.5))
    o, d = np.float32([[0, 0, 0.9], [0, 0.5, 0.9]]), np.float32([[0, 0, -1]] * 2)
    cases = ([below], [FIBRES, 0], True), ([above], [0, 0], False), ([], [FIBRES, MISS], True)
    for shapes, expected, is_free in cases:
        intersector = make_intersector(context, Geometry(shapes, curves=across), kind=kind)
        hits = trace(context, intersector, o, d, o, 1.2 * d)
        intersector.release()
        np.testing.assert_array_equal(hits[:, 0] & ~np.uint32(FREE), expected)
        np.testing.assert_array_equal(hits[:, 0] & FREE != 0, [False, is_free])


@pytest.mark.parametrize("radius", [1e-3, 1e-5])
def test_boxes_of_long_thin_segments_are_pieces_that_hold_them(radius: float) -> None:
    shape = trace_curves(Scene("thin", curves=strands(6, 3, radius)))
    lower, upper, segment = curve_boxes(shape)
    assert len(segment) > len(shape.first) and set(segment) == set(range(len(shape.first)))
    all_bodies = bodies(shape).astype(np.float64)
    for k, body in enumerate(all_bodies):
        for s in np.linspace(0, 1, 33):
            center = body[0] + s * (body[1] - body[0])
            mine = segment == k
            holds = (lower[mine] <= center[:3] - center[3]) & (upper[mine] >= center[:3] + center[3])
            inside = ((lower[mine] <= center[:3]) & (upper[mine] >= center[:3])).all(axis=1)
            assert inside.any() and holds[inside].any(axis=0).all()
    whole = np.prod(all_bodies[..., :3].max(axis=1) - all_bodies[..., :3].min(axis=1), axis=1).sum()
    assert np.prod(upper.astype(np.float64) - lower, axis=1).sum() < 0.2 * whole


@pytest.mark.parametrize("kind", KINDS)
def test_a_segment_without_length_is_a_sphere_and_one_without_radius_nothing(context: Context, kind: str) -> None:
    points = np.float32([[0, 0, 0], [0, 0, 0], [0, 0, 0], [-1, 0.5, 0], [1, 0.5, 0]])
    shape = Curves("dot", points, np.float32([0.3, 0.3, 0.3, 0, 0]), np.array([0, 3, 5]), np.zeros(2, bool))
    shown = Scene("dot", curves=(shape,))
    across = trace_curves(shown)
    places = (np.float32([[0.1, 0.2, 0.9], [0.35, 0, 0.9], [0.1, 0.501, 0.9]]) - shown.center) / shown.radius
    intersector = make_intersector(context, Geometry([], curves=across), kind=kind)
    hits = trace(context, intersector, places.astype(np.float32), np.float32([[0, 0, -1]] * 3))
    intersector.release()
    np.testing.assert_array_equal(hits[:, 0], [FIBRES, MISS, MISS])


@needs("embree")
def test_without_embrees_curves_the_bvh_traces_everything(
    context: Context, curves: TraceCurves, monkeypatch: pytest.MonkeyPatch
) -> None:
    def missing() -> None:
        raise ImportError("no curves here")

    monkeypatch.setattr("viewer.trace.rays.embree_curves.embree_with_curves", missing)
    intersector = make_intersector(context, Geometry([], curves=curves))
    assert intersector.name == "bvh"
    intersector.release()
    with pytest.raises(UsageError, match="no curves here"):
        make_intersector(context, Geometry([], curves=curves), kind="embree")


def test_there_is_a_bound_on_boxes(monkeypatch: pytest.MonkeyPatch) -> None:
    shape = trace_curves(Scene("thin", curves=strands(6, 3, 1e-4)))
    free = len(curve_boxes(shape)[2])
    monkeypatch.setattr("viewer.trace.rays.curve_boxes._MOST_BOXES", 30)
    segment = curve_boxes(shape)[2]
    assert len(segment) <= 30 < free and set(segment) == set(range(len(shape.first)))
