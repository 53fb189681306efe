"""Large polygons are cut as small ones are: their triangles cover them once."""

from __future__ import annotations

import numpy as np
import pytest

from viewer.scene import polygons
from viewer.scene.polygons import triangulate
from viewer.scene.sweep import sweep


def star(count: int) -> np.ndarray:
    rng = np.random.default_rng(count)
    angle, radius = np.sort(rng.random(count)) * 2 * np.pi, 1 + rng.random(count)
    return np.column_stack([radius * np.cos(angle), radius * np.sin(angle)])


def comb(count: int) -> np.ndarray:
    """Teeth that point up, from a bar."""
    teeth = np.column_stack([np.arange(count)[::-1], np.where(np.arange(count) % 2, 9.0, 0.1)])
    return np.concatenate([teeth, [(0, -1), (count, -1)]])


def spiral(count: int) -> np.ndarray:
    turn = np.linspace(1, count / 40, count // 2)
    angle = 2 * np.pi * turn
    inner, outer = (np.column_stack([r * np.cos(angle), r * np.sin(angle)]) for r in (turn - 0.4, turn))
    return np.concatenate([outer, inner[::-1]])


def stairs(count: int) -> np.ndarray:
    """Sides along the axes, so that many corners have the same x, with corners midway along the sides."""
    step = np.arange(count) // 2
    down = np.column_stack([step, count - step + 0.5 * (np.arange(count) % 2)])
    return np.concatenate([[(0, 0), (count, 0), (count, 1)], down[::-1]])


def ring(count: int) -> np.ndarray:
    """A hole, and a bridge to it that is passed twice."""
    angle = np.linspace(0, 2 * np.pi, count // 2)
    circle = np.column_stack([np.cos(angle), np.sin(angle)])
    circle[-1] = circle[0]
    return np.concatenate([2 * circle, circle[::-1]])


def area(points: np.ndarray) -> float:
    x, y = points.T
    return float((x * np.roll(y, -1) - y * np.roll(x, -1)).sum()) / 2


def turned(points: np.ndarray, angle: float) -> np.ndarray:
    c, s = np.cos(angle), np.sin(angle)
    return points @ np.array([[c, s], [-s, c]])


def areas(points: np.ndarray, triangles: np.ndarray) -> np.ndarray:
    a, b, c = (points[triangles[:, k]] for k in range(3))
    return ((b - a)[:, 0] * (c - a)[:, 1] - (b - a)[:, 1] * (c - a)[:, 0]) / 2


@pytest.mark.parametrize("make", [star, comb, spiral, stairs])
@pytest.mark.parametrize("angle", [0.0, 0.5 * np.pi, 2.0])
@pytest.mark.parametrize("count", [12, 600])
def test_triangles_cover_the_polygon_once(make, angle, count):
    points = turned(make(count), angle)
    points = points if area(points) > 0 else points[::-1]
    triangles = sweep(points)
    assert triangles is not None and triangles.shape == (len(points) - 2, 3)
    found = areas(points, triangles)
    assert found.min() > -1e-9 * area(points) and found.sum() == pytest.approx(area(points))
    assert set(triangles.ravel()) == set(range(len(points)))
    # No triangle overlaps another: every side is that of the polygon or lies between two triangles.
    sides = triangles[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2)
    inner = {tuple(side) for side in sides if (side[1] - side[0]) % len(points) != 1}
    assert len({tuple(side) for side in sides}) == len(sides) and inner == {(b, a) for a, b in inner}


def test_a_bridge_to_a_hole_is_cut_or_left_to_the_ears():
    points = ring(400)
    points = points if area(points) > 0 else points[::-1]
    lifted = np.column_stack([points, 0 * points[:, 0]])
    triangles, _, uncut = triangulate(lifted, np.arange(len(points)), np.array([len(points)]))
    found = areas(points, triangles)
    assert uncut == 0 and found.min() > -1e-9 and found.sum() == pytest.approx(area(points))


@pytest.mark.parametrize("points", [np.random.default_rng(2).random((300, 2)), np.zeros((300, 2)),
                                    np.array([(0, 0), (1, 1), (1, 0), (0, 1)], float)])
def test_what_cuts_itself_is_not_swept(points):
    cut = sweep(points)
    assert cut is None or np.ptp(points) == 0


def test_a_large_polygon_takes_no_ears(monkeypatch):
    """Of which clipping looks at n^2 corners: at 2,000 more than the budget here."""
    monkeypatch.setattr(polygons, "MAX_WORK", 1 << 19)
    flat = np.concatenate([star(2000), star(300)])
    points = np.column_stack([flat[:, 0], 0 * flat[:, 0], -flat[:, 1]])
    triangles, polygon, uncut = triangulate(points, np.arange(2300), np.array([2000, 300]))
    assert uncut == 0 and np.bincount(polygon).tolist() == [1998, 298]
    found = areas(flat, triangles)
    assert found.min() >= -1e-9 and found.sum() == pytest.approx(area(flat[:2000]) + area(flat[2000:]))
    monkeypatch.setattr(polygons, "MAX_WORK", 0)
    assert triangulate(points, np.arange(2300), np.array([2000, 300]))[2] == 1  # the second does not begin
