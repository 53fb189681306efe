"""The axes of yarns: their frames are at right angles, turn no more than the axis, close, and survive bad yarns."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest

from viewer.scene.curves import Curves
from viewer.scene.yarn.frames import Axis, yarn_axis


def yarns(*strands: list, closed: bool = False, kind: str = "linear", radius: float = 0.1) -> Curves:
    points = np.concatenate([np.array(strand, np.float32) for strand in strands])
    offsets = np.cumsum([0, *map(len, strands)])
    return Curves("yarns", points, np.full(len(points), radius), offsets, np.full(len(strands), closed), kind)


def circle(count: int = 40, tilt: float = 0.0) -> np.ndarray:
    t = np.arange(count) * 2 * np.pi / count
    return np.stack([np.cos(t), np.sin(t), tilt * np.sin(2 * t)], axis=1)


def one_by_one(tangents: np.ndarray, normal: np.ndarray) -> np.ndarray:
    """The normals carried along in a loop by the matrices of the least rotations, Rodrigues' formula."""
    normals = [normal]
    for a, b in pairwise(tangents):
        v, cosine = np.cross(a, b), a @ b
        cross = np.array([[0, -v[2], v[1]], [v[2], 0, -v[0]], [-v[1], v[0], 0]])
        normals.append((np.eye(3) + cross + cross @ cross / (1 + cosine)) @ normals[-1])
    return np.array(normals)


def check(axis: Axis) -> None:
    tangents = np.cross(axis.normals, axis.binormals)
    for vectors in (axis.normals, axis.binormals, tangents):
        np.testing.assert_allclose(np.linalg.norm(vectors, axis=1), 1, atol=1e-9)
    assert all(np.isfinite(part).all() for part in (axis.points, axis.way, axis.whole))


def test_frames_are_carried_along_each_yarn_by_the_least_rotations() -> None:
    t = np.linspace(0, 6, 61)
    helix = np.stack([np.cos(t), np.sin(t), 0.3 * t], axis=1)
    axis = yarn_axis(yarns(helix, helix[::-2] + 5), 1.0, 1e9)
    check(axis)
    for first, end in pairwise(axis.offsets):
        tangents = np.cross(axis.normals, axis.binormals)[first:end]
        np.testing.assert_allclose(axis.normals[first:end], one_by_one(tangents, axis.normals[first]), atol=1e-9)


def test_frames_of_a_closed_yarn_close() -> None:
    """The frame that is carried from the last point to the first is the first one, up to what a step turns."""
    axis = yarn_axis(yarns(circle(80, 0.7), closed=True, kind="catmull-rom"), 0.02, 1.0)
    check(axis)
    steps = (axis.normals * np.roll(axis.normals, -1, axis=0)).sum(axis=1)
    assert len(axis.points) > 100 and steps.min() > 0.98
    turns = axis.turned(0.37)
    last = 2 * np.pi * np.round(0.37 * axis.whole[0])
    assert last > 0 and turns[-1] + turns[1] == pytest.approx(last, rel=1e-3)  # in nearly equal steps


def test_the_way_is_the_length_in_radii() -> None:
    axis = yarn_axis(yarns([[0, 0, 0], [0, 2, 0], [3, 2, 0]], radius=0.5), 0.1, 0.8)
    assert axis.whole[0] == pytest.approx(10) and axis.way[-1] == pytest.approx(10)
    assert np.linalg.norm(np.diff(axis.points, axis=0), axis=1).max() <= 0.4 + 1e-6


@pytest.mark.parametrize("strand, radius", [
    ([[0, 0, 0], [1, 0, 0]], 0.1),
    ([[0, 0, 0], [0, 0, 0]], 0.1),
    ([[0, 0, 0], [1, 0, 0], [0, 0, 0], [1, 0, 0]], 0.1),
    ([[0, 0, 0], [0, 0, 0], [1, 0, 0], [1, 0, 0]], 0.1),
    ([[0, 0, 0], [1, 1, 0], [2, 0, 0]], 0.0),
    ([[1e17, 0, 0], [2e17, 0, 0]], 1e16),
])
@pytest.mark.parametrize("closed", [False, True])
def test_yarns_that_are_hardly_any(strand: list, radius: float, closed: bool) -> None:
    """Two points, one place, cusps, no thickness, huge ones."""
    strand = [*strand, [0, 0.5, 0]] if len(strand) < 3 and closed else strand
    check(yarn_axis(yarns(strand, closed=closed, radius=radius), 0.05, 1.0))
