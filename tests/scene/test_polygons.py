import numpy as np
import pytest

from viewer.scene import polygons
from viewer.scene.polygons import triangulate

C = [(0, 0), (4, 0), (4, 4), (0, 4), (0, 3), (3, 3), (3, 1), (0, 1)]
DART = [(0, 0), (2, 1), (4, 0), (2, 4)]
STAR = [(np.cos(k * np.pi / 20) * (1 + k % 2), np.sin(k * np.pi / 20) * (1 + k % 2)) for k in range(40)]
RING = [(0, 0), (4, 0), (4, 4), (0, 4), (0, 0), (1, 1), (1, 3), (3, 3), (3, 1), (1, 1)]  # a hole and a bridge to it


def area(points):
    x, y = np.transpose(points)
    return (x * np.roll(y, -1) - y * np.roll(x, -1)).sum() / 2


TWICE = [point for point in C for _ in range(2)]  # each corner stands twice, and turns nowhere


@pytest.mark.parametrize("outline", [C, DART, STAR, RING, C[::-1], DART[1:] + DART[:1], TWICE])
@pytest.mark.parametrize("axes", [(0, 1, 2), (1, 2, 0), (0, 2, 1)])
def test_triangles_cover_the_polygon_once(outline, axes):
    """Their areas, of one sign, add up to the polygon's."""
    flat = np.array(outline, float)
    points = np.column_stack([flat, flat @ (0.5, -0.25)])[:, axes] + (5e6, 4e5, 7)
    triangles, polygon, uncut = triangulate(points, np.arange(len(flat)), np.array([len(flat)]))
    areas = [area(flat[t]) for t in triangles]
    assert min(np.array(areas) * np.sign(area(flat))) >= (1e-3 if outline is not TWICE else 0) and uncut == 0
    assert np.sum(areas) == pytest.approx(area(flat))
    assert len(triangles) == len(flat) - 2 and not polygon.any()


def test_many_at_once_stay_in_order():
    sizes = np.array([4, 3, 8, 4, 8])
    outlines = [DART, [(0, 0), (1, 0), (0, 1)], C, [(0, 0), (1, 0), (1, 1), (0, 1)], C]
    flat = np.concatenate(outlines).astype(float)
    triangles, polygon, _ = triangulate(np.column_stack([flat, 0 * flat[:, 0]]), np.arange(len(flat)), sizes)
    assert polygon.tolist() == [0, 0, 1, *[2] * 6, 3, 3, *[4] * 6]
    first = np.cumsum(sizes) - sizes
    for number, outline in enumerate(outlines):
        corners = triangles[polygon == number]
        assert corners.min() == first[number] and corners.max() == first[number] + sizes[number] - 1
        assert sum(area(flat[t]) for t in corners) == pytest.approx(area(outline))


def test_polygons_that_cut_themselves_end():
    points = np.random.default_rng(1).random((300, 3))
    triangles, _, _ = triangulate(points, np.arange(300), np.array([300]))
    assert triangles.shape == (298, 3) and set(triangles.ravel()) == set(range(300))


def test_what_takes_too_long_is_told(monkeypatch):
    """Two polygons begin within the budget, which ends midway, and a larger one does not begin."""
    monkeypatch.setattr(polygons, "MAX_WORK", 5000)
    outlines = [STAR, STAR, [(2 * x, 2 * y) for x, y in STAR for _ in range(2)]]
    flat, sizes = np.concatenate(outlines).astype(float), np.array([len(outline) for outline in outlines])
    points = np.column_stack([flat, 0 * flat[:, 0]])
    _, polygon, uncut = triangulate(points, np.arange(len(flat)), sizes)
    assert uncut == 3 and np.bincount(polygon).tolist() == (sizes - 2).tolist()
    monkeypatch.setattr(polygons, "MAX_WORK", 1 << 25)
    assert triangulate(points, np.arange(len(flat)), sizes)[2] == 0


def test_ears_that_would_take_too_long_are_not_begun(monkeypatch):
    """A large polygon that cuts itself, so that it cannot be swept, becomes a fan at once, and is told of."""
    points = np.random.default_rng(1).random((300, 3))
    monkeypatch.setattr(polygons, "MAX_WORK", 128 * 300 + 300 * 100)
    monkeypatch.setattr(polygons, "_clip_ears", None)
    triangles, _, uncut = triangulate(points, np.arange(300), np.array([300]))
    assert uncut == 1 and np.array_equal(triangles[:, 1:], np.arange(298)[:, None] + [1, 2])
