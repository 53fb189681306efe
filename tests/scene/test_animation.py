"""Tracks against values that were worked out by hand from glTF 2.0, appendix C."""

from __future__ import annotations

import math
import pickle

import numpy as np
import pytest

from viewer.errors import UsageError
from viewer.scene.animation import Animation, Target, Track

PLACE, TURN = Target("node", 0, "translation"), Target("node", 0, "rotation")


def about_z(degrees: float) -> list[float]:
    half = math.radians(degrees) / 2
    return [0, 0, math.sin(half), math.cos(half)]


def angle_of(quaternion: np.ndarray) -> float:
    """Degrees about z, of a rotation about z."""
    assert quaternion[:2] == pytest.approx(0, abs=1e-9) and quaternion @ quaternion == pytest.approx(1)
    return math.degrees(2 * math.atan2(quaternion[2], quaternion[3]))


@pytest.mark.parametrize("time, expected", [(-1, 1), (0, 1), (1, 1), (1.999, 1), (2, 5), (3, 5), (6, 0), (99, 0)])
def test_step(time, expected):
    track = Track(PLACE, [1, 2, 6], [[1], [5], [0]], "step")
    assert track.at(time)[0] == expected


@pytest.mark.parametrize("time, expected", [(-1, 1), (1, 1), (1.5, 3), (2, 5), (3, 3.75), (6, 0), (99, 0)])
def test_linear(time, expected):
    assert Track(PLACE, [1, 2, 6], [[1], [5], [0]]).at(time)[0] == pytest.approx(expected)


def test_a_cubic_spline_that_is_a_known_polynomial():
    """t^3 - 2 t from 1 to 3: its values and derivatives at the ends define it, whatever the length of the interval."""
    value, slope = (lambda t: t**3 - 2 * t), (lambda t: 3 * t**2 - 2)
    keys = [[[99], [value(1)], [slope(1)]], [[slope(3)], [value(3)], [99]]]
    track = Track(PLACE, [1, 3], keys, "cubic")
    for time in (1, 1.25, 2, 2.9, 3):
        assert track.at(time)[0] == pytest.approx(value(time), rel=1e-6)
    assert track.at(0)[0] == value(1) and track.at(4)[0] == value(3)


@pytest.mark.parametrize("start, end, middle", [
    (0, 90, 30), (0, -90, -30), (170, -170, 176 + 2 / 3), (0, 1e-5, 1e-5 / 3)])
def test_rotations_are_interpolated_on_the_shorter_arc_at_constant_speed(start, end, middle):
    track = Track(TURN, [0, 3], [about_z(start), about_z(end)])
    assert angle_of(track.at(1)) == pytest.approx(middle, rel=1e-5)
    negated = Track(TURN, [0, 3], [about_z(start), [-x for x in about_z(end)]])
    assert angle_of(negated.at(1)) == pytest.approx(middle, rel=1e-5)


def test_a_cubic_rotation_has_unit_length():
    """Halfway between two values without tangents lies their mean: 45 degrees, at length cos 45 degrees before."""
    zero = [0, 0, 0, 0]
    track = Track(TURN, [0, 1], [[zero, about_z(0), zero], [zero, about_z(180), zero]], "cubic")
    assert angle_of(track.at(0.5)) == pytest.approx(90)
    assert angle_of(track.at(0)) == 0


def test_a_quaternion_without_length_is_no_rotation():
    assert track_values(Track(TURN, [0], [[0, 0, 0, 0]])) == [0, 0, 0, 1]
    assert angle_of(Track(TURN, [0], [[0, 0, 1e-30, 1e-30]]).at(0)) == pytest.approx(90)


def track_values(track):
    return track.at(0).tolist()


def test_two_key_frames_at_one_time_are_a_jump():
    track = Track(PLACE, [0, 1, 1, 2], [[0], [4], [8], [9]])
    assert [track.at(time)[0] for time in (0.5, 1, 1.5)] == [2, 8, 8.5]


@pytest.mark.parametrize("times, values, interpolation, problem", [
    ([0, 2, 1], [[0]] * 3, "linear", "each must follow"),
    ([], np.zeros((0, 1)), "linear", "there must be one"),
    ([0, math.nan], [[0]] * 2, "linear", "holds NaN"),
    ([0, 1], [[0], [math.inf]], "linear", "holds NaN"),
    ([0, 1], [[0]] * 3, "linear", "Track.values"),
    ([0, 1], [[0]] * 2, "cubic", "Track.values"),
    ([0, 1], [[0]] * 2, "bezier", "not one of step, linear, cubic"),
])
def test_what_is_no_track(times, values, interpolation, problem):
    with pytest.raises(UsageError, match=problem):
        Track(PLACE, np.array(times, float), np.array(values, float), interpolation)


def test_an_animation_tells_what_it_moves_and_survives_a_pickle():
    tracks = [Track(Target("node", k, "rotation"), [0, k + 1], [about_z(0)] * 2) for k in range(3)]
    tracks.append(Track(Target("node", 1, "weights"), [0], [[0, 1]]))
    animation = pickle.loads(pickle.dumps(Animation("wave", tuple(tracks))))
    assert animation.duration == 3 and animation.moves == "rotation of 3 nodes, weights of 1 node"
    assert not animation.tracks[0].times.flags.writeable
    assert Animation("before", (Track(PLACE, [-2, -1], [[0], [1]]),)).duration == 0
