"""BasisCurves of USD as curves."""

from __future__ import annotations

import numpy as np
import pytest
from needs import needs
from usda import stage

from viewer.errors import InputError
from viewer.scene.curve_segments import segments
from viewer.scene.load import load_scene

pytestmark = needs("usd")
POINTS = [(0, 0, 0), (1, 0, 0), (2, 1, 0), (3, 1, 0), (4, 0, 0), (5, 0, 0), (6, 1, 0)]


def read(tmp_path, attributes, points=POINTS, meters=1):
    text = stage(f'def BasisCurves "Hair"\n{{\n    int[] curveVertexCounts = [{len(points)}]\n'
                 f"    point3f[] points = {points}\n    {attributes}\n}}", meters=meters)
    (tmp_path / "a.usda").write_text(text)
    (curves,) = load_scene(tmp_path / "a.usda").curves
    return curves


def test_lines_with_widths_and_colours(tmp_path):
    curves = read(tmp_path, 'uniform token type = "linear"\nfloat[] widths = [0.2, 0.1, 0.1, 0.1, 0.1, 0.1, 0] '
                            '(interpolation = "vertex")\ncolor3f[] primvars:displayColor = [(0.1, 0.2, 0.3)]',
                  meters=0.1)
    np.testing.assert_allclose(curves.points, 0.1 * np.array(POINTS), atol=1e-7)
    np.testing.assert_allclose(curves.radii, [0.01, *[0.005] * 5, 0], atol=1e-7)
    np.testing.assert_allclose(curves.colors, np.broadcast_to((0.1, 0.2, 0.3), (7, 3)), rtol=1e-6)
    assert curves.kind == "linear" and curves.name == "Hair" and not curves.closed.any()


def evaluated(basis, first, t):
    """A point of the segment whose four points begin at `first`, by the polynomials of the textbooks."""
    a, b, c, d = np.array(POINTS[first:first + 4], float)
    if basis == "bezier":
        return (1 - t) ** 3 * a + 3 * t * (1 - t) ** 2 * b + 3 * t ** 2 * (1 - t) * c + t ** 3 * d
    if basis == "bspline":
        return ((1 - t) ** 3 * a + (3 * t ** 3 - 6 * t ** 2 + 4) * b + (-3 * t ** 3 + 3 * t ** 2 + 3 * t + 1) * c
                + t ** 3 * d) / 6
    return b + (c - a) * t / 2 + (a - 2.5 * b + 2 * c - d / 2) * t ** 2 + (1.5 * (b - c) + (d - a) / 2) * t ** 3


@pytest.mark.parametrize(("basis", "step"), [("bezier", 3), ("bspline", 1), ("catmullRom", 1)])
def test_cubic_curves_go_where_they_should(tmp_path, basis, step):
    curves = read(tmp_path, f'uniform token type = "cubic"\nuniform token basis = "{basis}"\nfloat[] widths = [0.1] '
                            '(interpolation = "constant")')
    ends = segments(curves).ends[..., :3].astype(float)
    first = range(0, 4, step)
    np.testing.assert_allclose(ends[0, 0], evaluated(basis, 0, 0.0), atol=1e-5)
    np.testing.assert_allclose(ends[-1, 1], evaluated(basis, first[-1], 1.0), atol=1e-5)
    for start in first:
        for t in (0.25, 0.5, 0.75):
            point = evaluated(basis, start, t)
            along = ends[:, 1] - ends[:, 0]
            share = np.clip(((point - ends[:, 0]) * along).sum(1) / (along ** 2).sum(1), 0, 1)
            assert np.linalg.norm(ends[:, 0] + share[:, None] * along - point, axis=1).min() < 0.02


def test_pinned_curves_reach_their_ends(tmp_path):
    for basis in ("bspline", "catmullRom"):
        curves = read(tmp_path, f'uniform token type = "cubic"\nuniform token basis = "{basis}"\n'
                                'uniform token wrap = "pinned"\nfloat[] widths = [0.1] (interpolation = "constant")')
        ends = segments(curves).ends[..., :3]
        np.testing.assert_allclose([ends[0, 0], ends[-1, 1]], [POINTS[0], POINTS[-1]], atol=1e-5)


def test_counts_that_do_not_fit(tmp_path):
    (tmp_path / "a.usda").write_text(stage('def BasisCurves "Hair"\n{\nint[] curveVertexCounts = [3]\n'
                                           "point3f[] points = [(0, 0, 0), (1, 0, 0)]\n}"))
    with pytest.raises(InputError, match="has at /Hair curveVertexCounts for 3 points, and there are 2$"):
        load_scene(tmp_path / "a.usda")
