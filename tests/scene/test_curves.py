"""Curves in a scene: what cannot be one, what frames them, and the segments that they become."""

from __future__ import annotations

import math
import pickle

import numpy as np
import pytest
from shapes import scene, sphere

import viewer
from viewer.base.digest import digest
from viewer.errors import UsageError
from viewer.scene.camera import Camera
from viewer.scene.curve_segments import MAX_PIECES, segments
from viewer.scene.curves import Curves
from viewer.scene.fibre import Fibre
from viewer.scene.frame import Frame
from viewer.scene.scene import Scene

POINTS = np.float32([[0, 0, 0], [1, 0, 0], [1, 2, 0], [5, 5, 5], [5, 6, 5], [4, 6, 5], [4, 6, 8]])
RADII = np.float32([0.1, 0.2, 0.05, 0.3, 0.2, 0.1, 0.4])


def curves(**changes) -> Curves:
    return Curves(**{"name": "c", "points": POINTS, "radii": RADII, "offsets": [0, 3, 7], "closed": [False, True]}
                  | changes)


def wave(kind, count=9, closed=False, radius=0.02, **changes) -> Curves:
    angle = np.linspace(0, 2 * math.pi, count, endpoint=not closed)
    points = np.stack([np.cos(angle), np.sin(angle), np.sin(3 * angle)], axis=1)
    return Curves("wave", points, np.full(count, radius), [0, count], [closed], kind, **changes)


@pytest.mark.parametrize("changes, problem", [
    ({"points": POINTS[:, :2]}, "Curves.points is (7, 2) float32, not (N, 3) float32"),
    ({"points": np.where(POINTS == 6, np.nan, POINTS)}, "Curves.points (7, 3) float32: holds NaN"),
    ({"radii": RADII[:3]}, "Curves.radii is (3,) float32, not (7,) float32"),
    ({"radii": np.where(np.arange(7) == 3, -1, RADII)}, "Curves.radii[3] is -1: a radius is not negative"),
    ({"offsets": [0, 3]}, "Curves.offsets must rise from 0 to 7, the number of points"),
    ({"offsets": [0, 5, 3, 7]}, "Curves.offsets must rise from 0 to 7"),
    ({"offsets": []}, "Curves.offsets must rise from 0 to 7"),
    ({"closed": [False]}, "Curves.closed is (1,) bool, not (2,) bool"),
    ({"offsets": [0, 1, 7]}, "Curves: strand 0 has 1 points; at least 2 are needed for one that is linear"),
    ({"offsets": [0, 5, 7]}, "Curves: strand 1 has 2 points; at least 3 are needed for one that is closed"),
    ({"kind": "b-spline"}, "Curves: strand 0 has 3 points; at least 4 are needed for one that is b-spline"),
    ({"kind": "bezier"}, "Curves.kind is 'bezier', not one of linear, catmull-rom, b-spline"),
    ({"colors": POINTS[:2]}, "Curves.colors is (2, 3) float32, not (7, 3) float32"),
    ({"points": POINTS[:0], "radii": [], "offsets": [0], "closed": []}, "Curves 'c': there are no strands"),
    ({"fibre": 3}, "Curves.fibre is of type int, not a Fibre"), ({"name": None}, "Curves.name is of type NoneType"),
])
def test_what_is_no_curve_is_refused(changes, problem):
    with pytest.raises(UsageError) as error:
        curves(**changes)
    assert str(error.value).startswith(problem)


def test_a_scene_of_other_things_than_curves_is_refused():
    with pytest.raises(UsageError, match=r"^Scene.curves\[0\] is of type ndarray, not Curves$"):
        Scene("hair", curves=(POINTS,))


def test_straight_segments_join_the_points_and_close_what_is_closed():
    found = segments(curves(colors=POINTS))
    first, last = [0, 1, 3, 4, 5, 6], [1, 2, 4, 5, 6, 3]
    np.testing.assert_array_equal(found.ends[..., :3], np.stack([POINTS[first], POINTS[last]], axis=1))
    np.testing.assert_array_equal(found.ends[..., 3], np.stack([RADII[first], RADII[last]], axis=1))
    np.testing.assert_array_equal(found.colors, found.ends[..., :3])
    assert found.strand.tolist() == [0, 0, 1, 1, 1, 1] and len(found) == 6
    around = 1 + 1 + 3 + math.sqrt(11)
    np.testing.assert_allclose(found.along, [[0, 1 / 3], [1 / 3, 1], [0, 1 / around], [1 / around, 2 / around],
                                             [2 / around, 5 / around], [5 / around, 1]], rtol=1e-6)


def spline(kind: str, points: np.ndarray, t: np.ndarray) -> np.ndarray:
    """The spline over the second of three spans, of the four points about it, at t in [0, 1], in float64."""
    d = points[None].repeat(len(t), axis=0)
    if kind == "b-spline":  # de Boor's recurrence, with knots at whole numbers
        for level in (1, 2, 3):
            share = np.stack([(t + 3 - level - k) / (4 - level) for k in range(4 - level)], axis=1)[..., None]
            d = (1 - share) * d[:, :-1] + share * d[:, 1:]
        return d[:, 0]
    at = np.arange(-1.0, 3.0)  # Barry and Goldman's recurrence, through the points at these knots
    for level in (1, 2):
        share = np.stack([(t - at[k]) / (at[k + level] - at[k]) for k in range(4 - level)], axis=1)[..., None]
        d = (1 - share) * d[:, :-1] + share * d[:, 1:]
    return (1 - t[:, None]) * d[:, 0] + t[:, None] * d[:, 1]


def distance(points: np.ndarray, ends: np.ndarray) -> np.ndarray:
    """From each of `points` (n, 3) to the nearest of the segments `ends` (m, 2, 4), in float64."""
    a, b = ends[:, 0, :3].astype(float), ends[:, 1, :3].astype(float)
    t = np.einsum("nmi,mi->nm", points[:, None] - a, b - a) / np.square(b - a).sum(axis=1)
    nearest = a + np.clip(t, 0, 1)[..., None] * (b - a)
    return np.linalg.norm(points[:, None] - nearest, axis=2).min(axis=1)


@pytest.mark.parametrize("closed", [False, True])
@pytest.mark.parametrize("kind", ["catmull-rom", "b-spline"])
def test_segments_stay_within_the_error_of_a_spline(kind, closed):
    shape = wave(kind, closed=closed)
    coarse, fine = segments(shape, 0.5), segments(shape, 0.02)
    assert len(fine) == pytest.approx(5 * len(coarse), rel=0.1)  # the error falls with the square of their number
    count, shift = len(shape.points), 0 if kind == "b-spline" else -1
    around = shape.points.astype(np.float64)
    if not closed and kind == "catmull-rom":
        around = np.concatenate([[2 * around[0] - around[1]], around, [2 * around[-1] - around[-2]]])
        shift, count = 0, count + 2
    spans = count if closed else count - 3
    true = [spline(kind, around[np.arange(k + shift, k + shift + 4) % count], np.linspace(0, 1, 23))
            for k in range(spans)]
    for found, error in ((coarse, 0.5), (fine, 0.02)):
        off = distance(np.concatenate(true), found.ends)
        assert 0.3 * error * 0.02 < off.max() < error * 0.02 * 1.01
    np.testing.assert_allclose(fine.ends[0, 0, :3], true[0][0], atol=1e-6)
    np.testing.assert_allclose(fine.ends[-1, 1, :3], true[-1][-1], atol=1e-6)
    np.testing.assert_array_equal(fine.ends[1:, 0], fine.ends[:-1, 1])
    assert (fine.ends[0, 0] == fine.ends[-1, 1]).all() == closed


def test_a_spline_takes_radius_and_colour_along_and_keeps_them_above_0():
    radii, colors = np.float32([0, 0, 1, 0, 0, 0]), np.eye(6, 3, -2, dtype=np.float32)
    points = np.arange(18, dtype=np.float32).reshape(6, 3)
    found = segments(Curves("c", points, radii, [0, 6], [False], "catmull-rom", colors))
    assert found.ends[..., 3].max() == 1 and found.ends[..., 3].min() == 0 == found.colors.min()
    np.testing.assert_array_equal(found.colors[..., 0], found.ends[..., 3])


def test_cubics_without_a_radius_become_a_limited_number_of_segments():
    found = segments(wave("b-spline", radius=0.0))
    assert len(found) == 6 * MAX_PIECES
    same = Curves("dot", np.ones((4, 3)), np.zeros(4), [0, 4], [False], "b-spline")
    assert len(segments(same)) == 1 and np.isfinite(segments(same).along).all()


def test_strands_do_not_mix():
    one, two = wave("catmull-rom"), wave("catmull-rom", 7, closed=True)
    both = Curves("both", np.concatenate([one.points, two.points + 5]), np.full(16, 0.02), [0, 9, 16], [False, True],
                  "catmull-rom")
    found, first, second = segments(both), segments(one), segments(two)
    assert np.bincount(found.strand).tolist() == [len(first), len(second)]
    np.testing.assert_array_equal(found.ends[:len(first)], first.ends)
    np.testing.assert_allclose(found.ends[len(first):, :, :3] - 5, second.ends[..., :3], atol=1e-6)
    np.testing.assert_allclose(found.along[len(first):], second.along, atol=1e-6)


def test_too_many_segments_are_refused(monkeypatch):
    monkeypatch.setattr("viewer.scene.curve_segments.MAX_SEGMENTS", 6)
    assert len(segments(curves())) == 6
    problem = r"^curves 'wave': [0-9,]+ segments are too many; at most 6 are drawn$"
    for many in (wave("linear"), wave("b-spline"), wave("catmull-rom", 5)):
        with pytest.raises(UsageError, match=problem):
            segments(many)
    with pytest.raises(UsageError, match="error=0, longest=inf: both must be above 0"):
        segments(curves(), 0)


def test_curves_frame_a_scene_with_their_radii():
    shown = Scene("hair", curves=(curves(),))
    np.testing.assert_allclose(shown.bounds, [[-0.1, -0.2, -0.2], [5.3, 6.4, 8.4]], rtol=1e-6)
    center = np.array([2.6, 3.1, 4.1])
    assert shown.radius == pytest.approx(max(np.linalg.norm(POINTS - center, axis=1) + RADII))
    up = np.array([0.0, 0, 2])
    np.testing.assert_allclose(shown.farthest(up) + shown.center, [4, 6, 8.4], rtol=1e-6)
    near, far = Frame(shown, Camera.look_at((2.5, 3, 100), (2.5, 3, 0)), (8, 8), is_depth_reversed=True).depth_range
    beyond = 0.42 * 0.4  # the round ends of the thickest strand reach so far beyond its box (raster/curve.vert)
    assert near * shown.radius == pytest.approx(91.6 - beyond, rel=2e-4)
    assert far * shown.radius == pytest.approx(100.2 + beyond, rel=2e-4)
    thick = shown.with_curve_radius(1.0)
    np.testing.assert_allclose(thick.bounds, [[-1, -1, -1], [6, 7, 9]])
    assert shown.with_curve_radius(0) is shown and Scene("none").with_curve_radius(1).curves == ()
    assert thick.curves[0] is shown.with_curve_radius(1.0).curves[0] is not shown.with_curve_radius(2.0).curves[0]


def test_a_model_and_curves_are_framed_and_joined_together():
    ball = scene(sphere(segments=24))
    joined = viewer.join(ball, Scene("hair", curves=(curves(),)), Scene("more", curves=(wave("linear"),)))
    assert [c.name for c in joined.curves] == ["c", "wave"] and joined.instances == ball.instances
    np.testing.assert_allclose(joined.bounds, [[-1.02, -1.02, -1.02], [5.3, 6.4, 8.4]], atol=0.01)
    direction = np.array([-1.0, 0, 0])
    np.testing.assert_allclose((joined.farthest(direction) + joined.center)[0], -1.02, atol=1e-3)
    assert not joined.has_surfaces_of(ball) and joined.relit(lights=()).has_surfaces_of(joined)


def test_they_pickle_print_and_are_part_of_the_scenes_digest():
    shown = Scene("hair", curves=(curves(fibre=Fibre((1, 2, 3))),))
    twin = pickle.loads(pickle.dumps(shown))
    assert digest(twin) == digest(shown) and not twin.curves[0].points.flags.writeable
    assert twin.curves[0].fibre == Fibre((1.0, 2.0, 3.0)) and twin.layout == shown.layout
    assert repr(twin.curves[0]) == "<Curves 'c': 2 strands, linear, 7 points>" and "1 curves" in repr(twin)
    moved = Scene("hair", curves=(curves(fibre=Fibre((1, 2, 3)), points=POINTS + 1),))
    assert digest(moved) != digest(shown) and moved.layout == shown.layout != Scene("hair").layout
