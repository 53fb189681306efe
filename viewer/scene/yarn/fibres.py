"""Plies and fibres of yarns (Zhao and others 2016; Wu and Yuksel 2017, "Real-time Fiber-level Cloth Rendering")."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from ...errors import UsageError
from ..curve_segments import MAX_SEGMENTS, segment_count
from ..curves import Curves
from .frames import Axis, yarn_axis
from .kind import YarnKind

FIBRE_BYTES = 60
"""Of memory for each segment of a fibre: its point and radius, and what `curve_segments.segments` makes of it."""
_ERROR = 0.05
"""How far the axis between two points departs from the yarn's, in radii: about the radius of a fibre."""
_PLY_STEPS, _FIBRE_STEPS = 10, 6
"""Points on a turn of the plies about the yarn, and of fibres about their ply."""
_LONGEST = 4.0
"""The longest segment in radii of the yarn: that of a yarn without twist."""
_HAIR_POINTS = 6
_GOLDEN_ANGLE = math.pi * (3 - math.sqrt(5))


def yarn_fibres(curves: Curves, kind: YarnKind) -> Curves:
    """The fibres of yarns whose axes and radii are those of `curves`, as straight strands.

    The first fibre of each yarn comes first, then the second one of each and so on, and hairs follow. They stay within
    the yarn, apart from loops and hairs; those of a closed yarn are closed. Colours are those of the yarn where it has
    any; `fibre` is that of `curves`, or that of the kind. The same arguments give the same fibres. Raises UsageError
    for more than MAX_SEGMENTS segments, which take FIBRE_BYTES each.
    """
    count = kind.plies * kind.fibres
    axis = axis_of(curves, kind, count)
    has_size = np.maximum.reduceat(axis.radii, axis.offsets[:-1]) > 0
    hairs = np.floor(kind.hairs * np.where(has_size, axis.whole, 0.0)).astype(np.int64)
    rng = np.random.default_rng(1)
    points = np.empty((count, len(axis.points), 3), np.float32)
    about_yarn, (about_ply, migrated) = ply_angle(axis, kind), fibre_angles(axis, kind)
    for k, numbers in enumerate(fibre_numbers(axis, kind, rng)):
        r, start, phase, highest = numbers[axis.yarn].T
        r = r * (highest + kind.lowest + (highest - kind.lowest) * np.cos(migrated + phase)) / 2
        points[k] = _placed(axis, about_yarn + 2 * np.pi * (k // kind.fibres) / kind.plies,
                            kind.ply_offset + kind.ply_radius * r * np.cos(about_ply + start),
                            kind.ply_width * r * np.sin(about_ply + start))
    made = _repeated(curves, axis, kind, points, kind.radius)
    return joined(made, _hairs(made, axis, kind, hairs, rng)) if hairs.any() else made


def yarn_plies(curves: Curves, kind: YarnKind) -> Curves:
    """The plies of yarns, as straight strands that are as thick as a ply. What else holds for `yarn_fibres` holds
    here."""
    axis = axis_of(curves, kind, kind.plies)
    points = np.empty((kind.plies, len(axis.points), 3), np.float32)
    for ply in range(kind.plies):
        angle = ply_angle(axis, kind) + 2 * np.pi * ply / kind.plies
        points[ply] = _placed(axis, angle, np.full(len(axis.points), kind.ply_offset), np.zeros(1))
    return _repeated(curves, axis, kind, points, kind.ply_radius)


def axis_of(curves: Curves, kind: YarnKind, times: int) -> Axis:
    """The axis of yarns, fine enough for so many strands that follow each. Raises UsageError for too many segments."""
    about_yarn, about_ply = (abs(turns) for turns in kind.turns)
    longest = 1 / max(_PLY_STEPS * about_yarn, _FIBRE_STEPS * about_ply, 1 / _LONGEST)
    total = times * segment_count(curves, _ERROR, longest)
    if total > MAX_SEGMENTS:
        raise UsageError(
            f"curves {curves.name!r}: their {times * curves.strand_count:,} fibres have {total:,} segments, which take "
            f"{total * FIBRE_BYTES / 2**30:.1f} GiB; at most {MAX_SEGMENTS:,} are drawn. Fewer plies or fibres, or "
            "thicker yarns, have fewer")
    return yarn_axis(curves, _ERROR, longest)


def _placed(axis: Axis, angle: np.ndarray, outwards: np.ndarray, around: np.ndarray) -> np.ndarray:
    """Points (n, 3) that lie so many radii of the yarn from its axis, in the direction `angle` and at a right angle to
    it."""
    cosine, sine = np.cos(angle), np.sin(angle)
    x, y = axis.radii * (outwards * cosine - around * sine), axis.radii * (outwards * sine + around * cosine)
    placed: np.ndarray = axis.points + x[:, None] * axis.normals + y[:, None] * axis.binormals
    return placed


def ply_angle(axis: Axis, kind: YarnKind) -> np.ndarray:
    """The angle of the first ply's axis about the yarn's, (n,); the others follow evenly."""
    return axis.turned(kind.turns[0])


def fibre_angles(axis: Axis, kind: YarnKind) -> tuple[np.ndarray, np.ndarray]:
    """How far fibres have gone round their ply, in a frame that turns with it, and how far they have migrated, (n,)
    each."""
    return axis.turned(kind.turns[1]), axis.turned(kind.migration * (abs(kind.turns[1]) or abs(kind.turns[0])))


def fibre_numbers(axis: Axis, kind: YarnKind, rng: np.random.Generator) -> np.ndarray:
    """For each fibre of each yarn, in the order of its plies, (plies * fibres, yarns, 4): R, so reduced that also the
    fibre's side stays within its ply; the angles at which it begins about its ply and to migrate; and the highest share
    of R to which it migrates. The lowest is `YarnKind.lowest`."""
    return np.concatenate([_numbers_of_ply(len(axis.closed), kind, rng) for _ in range(kind.plies)])


def _numbers_of_ply(yarns: int, kind: YarnKind, rng: np.random.Generator) -> np.ndarray:
    k, shape = np.arange(kind.fibres)[:, None], (kind.fibres, yarns)
    # Spread evenly over the cross-section, as the points of a sunflower, and turned by chance in each yarn
    distance = _distances((k + rng.random(shape)) / kind.fibres, kind)
    start = _GOLDEN_ANGLE * k + 2 * np.pi * rng.random((1, yarns)) + 0.5 * rng.standard_normal(shape)
    phase = 2 * np.pi * rng.random(shape)
    is_loop = (rng.random(shape) < kind.loops) & (distance > 0.5)
    highest = np.where(is_loop, kind.loop_reach / distance, kind.highest)
    return np.stack([(1 - kind.radius / kind.ply_radius) * distance, start, phase, highest], axis=-1)


def _distances(shares: np.ndarray, kind: YarnKind) -> np.ndarray:
    """The distances R below which such shares of the fibres lie, by the density of `YarnKind`."""
    r = np.linspace(0, 1, 257)
    density = (1 - 2 * kind.epsilon) * ((math.e - np.exp(r)) / (math.e - 1))**kind.beta + kind.epsilon
    below = np.concatenate([[0.0], np.cumsum((density * r)[1:] + (density * r)[:-1])])
    return np.interp(shares, below / below[-1], r)


def _hairs(made: Curves, axis: Axis, kind: YarnKind, hairs: np.ndarray, rng: np.random.Generator) -> Curves:
    """Fibres that leave their yarn, so many of each, like those that are `made`."""
    yarn = np.repeat(np.arange(len(hairs)), hairs)
    count = len(yarn)
    length = np.minimum(kind.hair_length * np.exp(0.5 * rng.standard_normal(count)), 0.9 * axis.whole[yarn])
    back = rng.random(count) < 0.5  # half of them lean towards the yarn's root
    reach = kind.hair_reach * (0.3 + rng.exponential(0.7, count).clip(0, 2))
    begin = rng.random(count) * (axis.whole[yarn] - length)
    angle, turn = 2 * np.pi * rng.random(count), 0.5 * rng.standard_normal(count)
    t = np.linspace(0, 1, _HAIR_POINTS)
    along = begin[:, None] + length[:, None] * np.where(back[:, None], 1 - t, t)
    low, share = axis.at(np.repeat(yarn, _HAIR_POINTS), along.ravel())
    center, normal, binormal, radius = ((1 - share) * values[low] + share * values[low + 1] for values in (
        axis.points, axis.normals, axis.binormals, axis.radii[:, None]))
    twisted = 2 * np.pi * kind.turns[0] * along + (angle[:, None] + turn[:, None] * t)
    out = 0.8 + (0.2 + reach[:, None]) * t**1.5
    x, y = (out * np.cos(twisted)).reshape(-1, 1), (out * np.sin(twisted)).reshape(-1, 1)
    colors = None if axis.colors is None else (1 - share) * axis.colors[low] + share * axis.colors[low + 1]
    return Curves(made.name, center + radius * (x * normal + y * binormal), kind.radius * radius[:, 0],
                  np.arange(count + 1) * _HAIR_POINTS, np.zeros(count, bool), "linear", colors, made.fibre)


def _repeated(source: Curves, axis: Axis, kind: YarnKind, points: np.ndarray, radius: float) -> Curves:
    """Curves of `points` (times, n, 3), which follow the axis so many times; `radius` is in radii of the yarn."""
    times = len(points)
    radii = np.tile((radius * axis.radii).astype(np.float32), times)
    colors = None if axis.colors is None else np.tile(axis.colors.astype(np.float32), (times, 1))
    starts = (np.arange(times)[:, None] * axis.offsets[-1] + axis.offsets[:-1]).ravel()
    points = points.reshape(-1, 3)
    for values in (points, radii, colors):
        if values is not None:
            values.flags.writeable = False  # so that it is not copied
    return Curves(source.name, points, radii, np.append(starts, len(points)), np.tile(axis.closed, times), "linear",
                  colors, source.fibre or kind.fibre)


def joined(a: Curves, b: Curves) -> Curves:
    """The strands of `a` and then those of `b`, which are of the same kind and have colours if those of `a` have."""
    colors = None if a.colors is None or b.colors is None else np.concatenate([a.colors, b.colors])
    return replace(a, points=np.concatenate([a.points, b.points]), radii=np.concatenate([a.radii, b.radii]),
                   offsets=np.concatenate([a.offsets, a.offsets[-1] + b.offsets[1:]]),
                   closed=np.concatenate([a.closed, b.closed]), colors=colors)
