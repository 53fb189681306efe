"""Plies and fibres: as many as asked for, within their yarn, twisted as said, and bounded."""

from __future__ import annotations

import math
from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest

from viewer.errors import UsageError
from viewer.scene.curves import Curves
from viewer.scene.yarn import fibres
from viewer.scene.yarn.fibres import yarn_fibres, yarn_plies
from viewer.scene.yarn.kind import YARNS, YarnKind

PLAIN = YarnKind(3, 12, twist=30.0, fibre_twist=-20.0, radius=0.03, color=(0.5, 0.5, 0.5), roughness=(0.3, 0.3),
                 loops=0.0, hairs=0.0)


def straight(length: float = 20.0, radius: float = 1.0, colors: bool = False) -> Curves:
    """Along +Y."""
    points = np.array([[0, 0, 0], [0, length, 0]])
    return Curves("yarn", points, np.full(2, radius), [0, 2], [False], "catmull-rom",
                  [[0, 0, 0], [1, 1, 1]] if colors else None)


def ring(radius: float = 0.2) -> Curves:
    t = np.arange(24) * 2 * np.pi / 24
    points = np.stack([np.cos(t), np.sin(t), 0 * t], axis=1)
    return Curves("ring", points, np.full(24, radius), [0, 24], [True], "catmull-rom")


def distances(made: Curves) -> np.ndarray:
    return np.hypot(made.points[:, 0], made.points[:, 2])


@pytest.mark.parametrize("plies", [1, 2, 3, 7])
def test_fibres_and_plies_stay_within_the_yarn(plies: int) -> None:
    kind = replace(PLAIN, plies=plies)
    made, thick = yarn_fibres(straight(), kind), yarn_plies(straight(), kind)
    assert made.strand_count == 12 * plies and thick.strand_count == plies
    assert distances(made).max() + kind.radius <= 1 + 1e-6 and distances(made).max() > 0.8
    np.testing.assert_allclose(distances(thick) + thick.radii, 1, rtol=1e-5)
    assert made.fibre == kind.fibre and made.kind == "linear" and made.radii[0] == np.float32(0.03)


def test_the_plies_are_twisted_by_the_angle() -> None:
    """At the surface of the yarn a right-handed screw, by 30 degrees: a turn on 2 pi / tan(30) radii."""
    thick = yarn_plies(straight(), PLAIN)
    points = thick.points[:thick.offsets[1]].astype(np.float64)
    angle = np.unwrap(np.arctan2(points[:, 0], points[:, 2]))
    turned = (angle[-1] - angle[0]) / 20
    assert turned == pytest.approx(np.tan(np.radians(30)), rel=1e-6)
    mirrored = yarn_plies(straight(), replace(PLAIN, twist=-30.0))
    assert np.unwrap(np.arctan2(*mirrored.points[:mirrored.offsets[1], [0, 2]].T))[-1] < 0


def test_fibres_follow_their_ply() -> None:
    """They are spread about its axis: their mean is the ply's point, and none is farther than its half width."""
    made, thick = yarn_fibres(straight(), replace(PLAIN, fibres=200)), yarn_plies(straight(), PLAIN)
    size = thick.offsets[1]
    for ply in range(3):
        own = made.points.reshape(3, 200, size, 3)[ply]
        axis = thick.points.reshape(3, size, 3)[ply]
        np.testing.assert_allclose(own.mean(axis=0), axis, atol=0.05)
        assert np.linalg.norm(own - axis, axis=2).max() <= PLAIN.ply_width


def test_the_density_of_the_fibres_is_that_of_the_kind() -> None:
    """The share within R, by counting, is the integral of density times R."""
    kind = replace(PLAIN, plies=1, fibres=4000, beta=3.0, lowest=1.0, highest=1.0, radius=1e-4)
    made = yarn_fibres(straight(1.0), kind)
    distance = distances(made).reshape(4000, -1)[:, 0]
    r = (np.arange(4000) + 0.5) / 4000
    density = ((np.e - np.exp(r)) / (np.e - 1))**3 * r
    for within in (0.2, 0.4, 0.7):
        expected = density[r < within].sum() / density.sum()
        assert (distance < within).mean() == pytest.approx(expected, abs=0.02)


def test_loops_and_hairs_leave_the_yarn() -> None:
    loops, hairs = replace(PLAIN, loops=0.5, loop_reach=1.5), replace(PLAIN, hairs=2.0, hair_reach=0.5)
    assert 1.05 < distances(yarn_fibres(straight(), loops)).max() < 1.5
    made = yarn_fibres(straight(), hairs)
    assert made.strand_count == 36 + 40
    tips = distances(made)[made.offsets[36:-1]], distances(made)[made.offsets[37:] - 1]
    np.testing.assert_allclose(tips[0], 0.8, rtol=1e-5)
    assert tips[1].min() > 1 and 1.3 < tips[1].mean() < 1.7
    assert made.points[:, 1].min() >= 0 and made.points[:, 1].max() <= 20 + 1e-5


def test_a_closed_yarn_has_closed_fibres_without_a_step() -> None:
    made = yarn_fibres(ring(), PLAIN)
    assert made.closed.all()
    for first, end in pairwise(made.offsets):
        points = made.points[first:end]
        steps = np.linalg.norm(np.diff(points, axis=0, append=points[:1]), axis=1)
        assert steps[-1] < 1.5 * np.median(steps)


def test_colors_go_along() -> None:
    made = yarn_fibres(straight(colors=True), replace(PLAIN, hairs=1.0))
    assert made.colors is not None
    np.testing.assert_allclose(made.colors[:, 0], made.points[:, 1] / 20, atol=1e-6)


def test_the_same_fibres_each_time() -> None:
    first, second = (yarn_fibres(straight(), YARNS["wool"]) for _ in range(2))
    assert (first.points == second.points).all() and (first.offsets == second.offsets).all()


@pytest.mark.parametrize("name", YARNS)
def test_yarns_without_size_are_safe(name: str) -> None:
    for radius in (0.0, 0.05, 1e12):
        assert np.isfinite(yarn_fibres(straight(radius=radius), YARNS[name]).points).all()
    with pytest.raises(UsageError, match="segments, which take"):
        yarn_fibres(straight(radius=1e-9), YARNS[name])


def test_too_many_are_refused_in_one_line(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(fibres, "MAX_SEGMENTS", 500)
    with pytest.raises(UsageError, match=r"^curves 'yarn': their 36 fibres have [\d,]+ segments, which take 0\.0 GiB; "
                                         r"at most 500 are drawn. Fewer plies or fibres, or thicker yarns, have"):
        yarn_fibres(straight(), PLAIN)


@pytest.mark.parametrize("changes, problem", [
    ({"twist": 70}, "YarnKind.twist is 70: it must be a number from -60 to 60"),
    ({"plies": 2.5}, "YarnKind.plies is 2.5: it must be a whole number from 1 to 8"),
    ({"fibres": None}, "YarnKind.fibres is None: it must be a whole number from 1 to 4096"),
    ({"radius": math.nan}, "YarnKind.radius is nan: it must be a number from 0.0001 to 0.5"),
    ({"color": (0.1, 0.2)}, "YarnKind.color is (0.1, 0.2): it must be one number or three numbers from 0 to 1"),
    ({"roughness": 0.3}, "YarnKind.roughness is 0.3: it must be two numbers from 0 to 1"),
    ({"lowest": 0.9, "highest": 0.5}, "YarnKind.lowest is 0.9, above the highest, 0.5"),
    ({"plies": 8, "radius": 0.5}, "YarnKind.radius is 0.5, above that of a ply, 0.277"),
])
def test_a_kind_that_cannot_be_is_refused(changes: dict, problem: str) -> None:
    with pytest.raises(UsageError) as error:
        replace(PLAIN, **changes)
    assert str(error.value) == problem
