"""The axis of yarns: points along it, each with a frame that turns no more than the axis does."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..curve_segments import segments
from ..curves import Curves

_THINNEST = 1e-3
"""Of the largest radius of a yarn: a thinner place counts as so thick where its twist is worked out."""


@dataclass(frozen=True, eq=False)
class Axis:
    """n points of yarns, float64: `points` (n, 3), `radii` (n,), `normals` and `binormals` (n, 3), which are at right
    angles to the yarn, `colors` (n, 3) or None.

    `offsets` (yarns + 1,) and `closed` (yarns,) are those of `Curves`, and `yarn` (n,) is the yarn of each point.
    `way` (n,) is the length of the yarn up to the point, in its radii there, and `whole` (yarns,) that of all of it.
    """

    points: np.ndarray
    radii: np.ndarray
    normals: np.ndarray
    binormals: np.ndarray
    colors: np.ndarray | None
    offsets: np.ndarray
    closed: np.ndarray
    yarn: np.ndarray
    way: np.ndarray
    whole: np.ndarray

    def turned(self, turns: float) -> np.ndarray:
        """The angle (n,) by which something has turned that turns so often on each radius of the way; on a closed yarn
        it comes back to where it began."""
        all_turns = turns * self.whole
        fitted = np.where(self.closed, np.round(all_turns), all_turns)
        angle: np.ndarray = 2 * np.pi * self.way * (fitted / self.whole)[self.yarn]
        return angle

    def at(self, yarn: np.ndarray, way: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """For places (k,) of yarns (k,) the number of the point before, and the share (k, 1) of the step to the next;
        what lies behind the last point is there."""
        starts = np.cumsum(self.whole + 1) - self.whole  # the ways of all yarns one after the other
        low = np.searchsorted(self.way + starts[self.yarn], way + starts[yarn], side="right") - 1
        low = np.clip(low, self.offsets[yarn], self.offsets[yarn + 1] - 2)
        step = self.way[low + 1] - self.way[low]
        return low, np.clip((way - self.way[low]) / np.maximum(step, 1e-300), 0, 1)[:, None]


def yarn_axis(curves: Curves, error: float, longest: float) -> Axis:
    """The axis of each strand, at points between which it departs by at most `error` from a straight line and that are
    at most about `longest` apart, both in radii. Raises UsageError for too many of them."""
    pieces = segments(curves, error, longest)
    counts = np.bincount(pieces.strand, minlength=curves.strand_count)
    final = np.cumsum(counts) - 1
    at = np.arange(len(pieces)) + (np.cumsum(~curves.closed) - ~curves.closed)[pieces.strand]
    rows = np.empty((len(pieces) + int((~curves.closed).sum()), 4))
    tips = at[final[~curves.closed]] + 1
    rows[at], rows[tips] = pieces.ends[:, 0], pieces.ends[final[~curves.closed], 1]
    colors = None
    if pieces.colors is not None:
        colors = np.empty((len(rows), 3))
        colors[at], colors[tips] = pieces.colors[:, 0], pieces.colors[final[~curves.closed], 1]
    offsets = np.concatenate([[0], np.cumsum(counts + ~curves.closed)])
    yarn = np.repeat(np.arange(curves.strand_count), np.diff(offsets))
    points, radii = rows[:, :3], rows[:, 3]
    first, last = offsets[:-1], offsets[1:] - 1
    index = np.arange(len(rows))
    before = np.where(index == first[yarn], np.where(curves.closed, last, first)[yarn], index - 1)
    after = np.where(index == last[yarn], np.where(curves.closed, first, last)[yarn], index + 1)
    tangents = _tangents(points, before, after, first[yarn])
    normals = _transported(tangents, before, index - first[yarn])
    thickness = np.maximum(radii, np.maximum(_THINNEST * np.maximum.reduceat(radii, first)[yarn], 1e-300))
    step = np.linalg.norm(points - points[before], axis=1) * 2 / (thickness + thickness[before])
    way = np.cumsum(np.where(index == first[yarn], 0.0, step))
    way -= way[first[yarn]]
    whole = way[last] + np.where(curves.closed, step[first], 0.0)
    whole = np.where(whole > 0, whole, 1.0)
    lost = np.where(curves.closed, _holonomy(tangents, normals, first, last), 0.0)
    normals = _rotated(normals, tangents, -lost[yarn] * way / whole[yarn])
    return Axis(points, radii, normals, np.cross(tangents, normals), colors, offsets, np.asarray(curves.closed), yarn,
                way, whole)


def _tangents(points: np.ndarray, before: np.ndarray, after: np.ndarray, first: np.ndarray) -> np.ndarray:
    """Unit tangents (n, 3). Where neighbours coincide, as at a cusp, that of the point before."""
    tangents = points[after] - points[before]
    for other in (points[after] - points, points - points[before]):
        zero = ~(np.abs(tangents).max(axis=1) > 0)
        tangents[zero] = other[zero]
    length = np.linalg.norm(tangents, axis=1)
    valid = length > 0
    source = np.maximum.accumulate(np.where(valid, np.arange(len(points)), -1))
    known = source >= first
    unit = tangents / np.where(valid, length, 1.0)[:, None]
    return np.where(known[:, None], unit[source], [1.0, 0.0, 0.0])


def _transported(tangents: np.ndarray, before: np.ndarray, number: np.ndarray) -> np.ndarray:
    """Unit normals (n, 3), each carried from the point before by the least rotation between the tangents.

    Rotations are quaternions. Their products from the first point of each yarn on, whose points have the `number`s 0, 1
    and so on, come by doubling: after k steps each is a product of 2^k of them.
    """
    a, b = tangents[before], tangents
    turn = np.concatenate([1 + (a * b).sum(axis=1)[:, None], np.cross(a, b)], axis=1)
    back = turn[:, 0] < 1e-9  # the axis turns round: by half a turn about anything at a right angle to it
    turn[back, 0], turn[back, 1:] = 0.0, _across(a[back])
    turn[number == 0] = [1.0, 0.0, 0.0, 0.0]
    turn /= np.linalg.norm(turn, axis=1)[:, None]
    reach = 1
    while reach <= number.max(initial=0):
        later = np.flatnonzero(number >= reach)
        turn[later] = _product(turn[later], turn[later - reach])
        turn[later] /= np.linalg.norm(turn[later], axis=1)[:, None]
        reach *= 2
    start = np.arange(len(number)) - number
    normal = _across(tangents[start])
    w, axis = turn[:, :1], turn[:, 1:]
    twice = 2 * np.cross(axis, normal)
    normal = normal + w * twice + np.cross(axis, twice)
    normal -= tangents * (normal * tangents).sum(axis=1)[:, None]
    unit: np.ndarray = normal / np.linalg.norm(normal, axis=1)[:, None]
    return unit


def _product(p: np.ndarray, q: np.ndarray) -> np.ndarray:
    """Of quaternions (n, 4), w first: q is the rotation that comes first."""
    w = p[:, 0] * q[:, 0] - (p[:, 1:] * q[:, 1:]).sum(axis=1)
    v = p[:, :1] * q[:, 1:] + q[:, :1] * p[:, 1:] + np.cross(p[:, 1:], q[:, 1:])
    return np.concatenate([w[:, None], v], axis=1)


def _across(directions: np.ndarray) -> np.ndarray:
    """Unit vectors at right angles to unit `directions`, (n, 3)."""
    least = np.eye(3)[np.abs(directions).argmin(axis=1)]
    found = np.cross(directions, least)
    unit: np.ndarray = found / np.linalg.norm(found, axis=1)[:, None]
    return unit


def _holonomy(tangents: np.ndarray, normals: np.ndarray, first: np.ndarray, last: np.ndarray) -> np.ndarray:
    """The angle (yarns,) from the first normal to the last one, carried on to the first point."""
    a, b, n = tangents[last], tangents[first], normals[last]
    mean = a + b
    size = (mean * mean).sum(axis=1)
    # The least rotation from a to b, of a vector at a right angle to a: n - 2 (a + b) (b . n) / |a + b|^2
    with np.errstate(divide="ignore", invalid="ignore"):
        carried = n - mean * (2 * (b * n).sum(axis=1) / size)[:, None]
    carried = np.where(size[:, None] > 1e-9, carried, n)
    start = normals[first]
    angle: np.ndarray = np.arctan2((np.cross(start, carried) * b).sum(axis=1), (start * carried).sum(axis=1))
    return angle


def _rotated(normals: np.ndarray, tangents: np.ndarray, angle: np.ndarray) -> np.ndarray:
    turned: np.ndarray = normals * np.cos(angle)[:, None] + np.cross(tangents, normals) * np.sin(angle)[:, None]
    return turned
