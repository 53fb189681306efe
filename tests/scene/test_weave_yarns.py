"""The yarns of a weave: over and under as its draft says, none through another, in its colours."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from viewer.errors import UsageError
from viewer.scene.curve_segments import segments
from viewer.scene.curves import Curves
from viewer.scene.weave import WEAVES, Weave, Yarn
from viewer.scene.yarn.kind import YARNS
from viewer.scene.yarn.woven import weave_fibres, weave_yarns

UNEVEN = Weave(((True, True, False), (False, True, True), (True, False, True)), Yarn((0.1, 0.2, 0.3), width=0.5),
               Yarn((0.9, 0.8, 0.7), width=0.8, bend=10.0), (10.0, 16.0))
KIND = replace(YARNS["silk"], hairs=0.0)
ALL = pytest.mark.parametrize("weave", [*WEAVES.values(), UNEVEN], ids=[*WEAVES, "uneven"])


def axis(yarns: Curves, strand: int) -> np.ndarray:
    pieces = segments(yarns, 0.01)
    return pieces.ends[pieces.strand == strand, 0, :3].astype(np.float64)


@ALL
def test_yarns_lie_above_where_the_draft_says(weave: Weave) -> None:
    yarns, rows, columns = weave_yarns(weave, (2, 1)), len(weave.draft), 2 * len(weave.draft[0])
    assert yarns.strand_count == rows + columns
    u, v = ((np.arange(count) + 0.5 - count / 2) / density for count, density in zip((columns, rows), weave.density))
    for j in range(rows):
        for i in range(columns):
            warp, weft = axis(yarns, i), axis(yarns, columns + j)
            z = np.interp(v[j], warp[:, 1], warp[:, 2]), np.interp(u[i], weft[:, 0], weft[:, 2])
            assert (z[0] > z[1]) == weave.draft[j][i % len(weave.draft[0])], (i, j)
            np.testing.assert_allclose([warp[:, 0].mean(), weft[:, 1].mean()], [u[i], v[j]], atol=1e-6)
    assert yarns.colors is not None
    assert (yarns.colors[0] == np.float32(weave.warp.color)).all()
    assert (yarns.colors[-1] == np.float32(weave.weft.color)).all()


@ALL
def test_no_yarn_goes_through_another(weave: Weave) -> None:
    """All pairs of a warp and a weft yarn, and of neighbours, of one repeat."""
    yarns = weave_yarns(weave)
    warps = len(weave.draft[0])
    axes = [axis(yarns, k) for k in range(yarns.strand_count)]
    radii = yarns.radii[yarns.offsets[:-1]]
    for i in range(yarns.strand_count):
        for j in range(max(i + 1, warps) if i < warps else yarns.strand_count, yarns.strand_count):
            gap = np.sqrt(((axes[i][:, None] - axes[j][None])**2).sum(axis=2)).min()
            assert gap >= 0.99 * (radii[i] + radii[j]), (i, j)
    assert 2 * radii[0] <= 1 / weave.density[0] and 2 * radii[-1] <= 1 / weave.density[1]
    assert radii.min() > 0.19 / max(weave.density)


@ALL
def test_flat_yarns_bend_as_the_weave_says_and_stay_apart(weave: Weave) -> None:
    """At each crossing the fibres of the yarn that lies above are above those of the other."""
    made, (columns, rows) = weave_fibres(weave, KIND), (len(weave.draft[0]), len(weave.draft))
    assert made.strand_count == KIND.fibres * (columns + rows)
    points, strand = made.points.astype(np.float64), np.repeat(np.arange(made.strand_count), made.lengths)
    is_warp = strand < KIND.fibres * columns
    for yarn, along, of_system in ((weave.warp, 1, is_warp), (weave.weft, 0, ~is_warp)):
        steps = np.diff(points[of_system], axis=0)
        steps = steps[steps[:, along] > 0]
        steepest = np.percentile(np.abs(steps[:, 2] / steps[:, along]), 99)
        assert np.degrees(np.arctan(steepest)) == pytest.approx(yarn.bend, rel=0.25)
    yarn = np.where(is_warp, strand % columns, (strand - KIND.fibres * columns) % rows)
    for j in range(rows):
        for i in range(columns):
            middle = (np.array([i, j]) + 0.5 - np.array([columns, rows]) / 2) / weave.density
            here = (np.abs(points[:, :2] - middle) < 0.1 / np.array(weave.density)).all(axis=1)
            warp, weft = points[here & is_warp & (yarn == i), 2], points[here & ~is_warp & (yarn == j), 2]
            upper, lower = (warp, weft) if weave.draft[j][i] else (weft, warp)
            assert len(upper) and len(lower) and upper.min() > lower.max() - 1e-3 / weave.density[0], (i, j)


def test_the_width_is_the_weaves() -> None:
    made = weave_fibres(WEAVES["plain"], replace(KIND, fibres=400))
    first = np.concatenate([made.points[made.offsets[k]:made.offsets[k + 1], 0] for k in range(0, 800, 2)])
    assert np.ptp(first) == pytest.approx(0.0095, rel=0.1)


@pytest.mark.parametrize("repeats", [(0, 1), (1,), (1.5, 1), 3])
def test_repeats_are_two_whole_numbers(repeats: object) -> None:
    with pytest.raises(UsageError, match=r"they must be two whole numbers above 0$"):
        weave_yarns(WEAVES["plain"], repeats)
