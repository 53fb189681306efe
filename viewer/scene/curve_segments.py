"""Curves as round linear segments: what both renderers draw."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from ..errors import UsageError
from .curves import Curves

MAX_SEGMENTS = 1 << 26
"""The most segments of a set of curves. They take 44 bytes each, and 24 more where there are colours."""
MAX_PIECES = 64
"""The most segments that one cubic becomes, so that a tip of radius 0 does not ask for infinitely many."""
_BLOCK = 1 << 18
"""Cubics, or pieces of them, that are worked out at a time in float64: 25 MiB."""

# The cubic over one span from the four points about it, as coefficients of 1, t, t^2 and t^3.
_CUBICS = {"linear": np.array([[0, 1, 0, 0], [0, -1, 1, 0], [0, 0, 0, 0], [0, 0, 0, 0]], np.float64),
           "catmull-rom": np.array([[0, 2, 0, 0], [-1, 0, 1, 0], [2, -5, 4, -1], [-1, 3, -3, 1]]) / 2,
           "b-spline": np.array([[1, 4, 1, 0], [-3, 0, 3, 0], [3, -6, 3, 0], [-1, 3, -3, 1]]) / 6}


@dataclass(frozen=True, eq=False)
class Segments:
    """m cones with spheres at both ends, in the order of the strands, from root to tip.

    `ends` (m, 2, 4) float32: x, y, z and the radius at both ends. Neighbours in a strand share an end to the last bit.
    `strand` (m,) int32: the strand that each belongs to. `along` (m, 2) float32: the share of the strand's length up to
    each end, 0 at the root and 1 at the tip. `colors` (m, 2, 3) float32 at both ends, or None. A segment between two
    equal points is a sphere, and is kept.
    """

    ends: np.ndarray
    strand: np.ndarray
    along: np.ndarray
    colors: np.ndarray | None

    def __len__(self) -> int:
        return len(self.strand)


def segments(curves: Curves, error: float = 0.05, longest: float = math.inf) -> Segments:
    """The curves as round linear segments.

    Segments of cubics depart from the curve by at most `error` times the larger radius of the four points that define
    the cubic, unless that takes more than MAX_PIECES of them for one cubic. With `longest`, none is much longer than so
    many of these radii. Raises UsageError if there are more than MAX_SEGMENTS.
    """
    corners, counts = polylines(curves, error, longest)
    strand = np.repeat(np.arange(len(counts), dtype=np.int32), counts)
    first = np.arange(len(strand)) + strand
    both = np.stack([corners[first], corners[first + 1]], axis=1)
    colors = np.ascontiguousarray(both[..., 4:]) if curves.colors is not None else None
    ends = np.ascontiguousarray(both[..., :4])
    return Segments(ends, strand, _along(ends, counts), colors)


def polylines(curves: Curves, error: float = 0.05, longest: float = math.inf) -> tuple[np.ndarray, np.ndarray]:
    """The points between which `segments` run, (n, 4 or 7) float32: x, y, z, the radius and the colour if there is one;
    and the number of segments of each strand, (strands,), which has one point more. A closed strand ends with its first
    point. Raises as `segments`."""
    if not error > 0 or not longest > 0:
        raise UsageError(f"error={error}, longest={longest}: both must be above 0")
    if (total := int(curves.spans.sum())) > MAX_SEGMENTS:
        raise _too_many(curves, total)
    stacked = _stacked(curves)
    if curves.kind == "linear" and longest == math.inf:
        if not curves.closed.any():
            return stacked, curves.spans
        begin, last, counts = stacked[_starts(curves)], stacked[curves.offsets[1:] - 1], curves.spans
    else:
        begin, last, counts = _flattened(curves, stacked, error, longest)
    np.maximum(begin[:, 3:], 0.0, out=begin[:, 3:])  # Catmull-Rom splines overshoot
    np.maximum(last[:, 3:], 0.0, out=last[:, 3:])
    root = np.cumsum(counts) - counts
    last[curves.closed] = begin[root[curves.closed]]
    return np.insert(begin, root + counts, last, axis=0), counts


def _too_many(curves: Curves, count: int) -> UsageError:
    return UsageError(f"curves {curves.name!r}: {count:,} segments are too many; at most {MAX_SEGMENTS:,} are drawn")


def _starts(curves: Curves) -> np.ndarray:
    """The points at which straight segments begin."""
    strand, number, _ = _spans(curves)
    starts: np.ndarray = curves.offsets[strand] + number
    return starts


def segment_count(curves: Curves, error: float, longest: float) -> int:
    """How many segments `segments` makes, or would make if they were not too many."""
    return int(_pieces(curves, _stacked(curves), error, longest).sum())


def _stacked(curves: Curves) -> np.ndarray:
    """Position, radius and colour of all points, (n, 4 or 7) float32."""
    values = [curves.points, curves.radii[:, None]] + ([curves.colors] if curves.colors is not None else [])
    return np.concatenate(values, axis=1)


def _spans(curves: Curves) -> tuple[np.ndarray, np.ndarray, list[slice]]:
    """The strand of each span and its number there, and blocks of spans."""
    spans = curves.spans
    strand = np.repeat(np.arange(len(spans)), spans)
    number = np.arange(len(strand)) - np.repeat(np.cumsum(spans) - spans, spans)
    return strand, number, [slice(k, k + _BLOCK) for k in range(0, len(strand), _BLOCK)]


def _pieces(curves: Curves, stacked: np.ndarray, error: float, longest: float) -> np.ndarray:
    """The number of segments of each span, (spans,) int64."""
    strand, number, blocks = _spans(curves)
    pieces = np.empty(len(strand), np.int64)
    for block in blocks:
        cubics, radii = _cubics(curves, stacked, strand[block], number[block])
        # A chord over a parameter step h departs from the curve by at most max|c''| h^2 / 8, and c'' is linear in t.
        bend = np.sqrt(np.maximum(np.square(2 * cubics[:, 2, :4]).sum(axis=1),
                                  np.square(2 * cubics[:, 2, :4] + 6 * cubics[:, 3, :4]).sum(axis=1)))
        # Below the spacing of float32 nothing is gained.
        allowed = np.maximum(error * radii, 2.0**-23 * np.abs(cubics[:, 0, :3]).max(axis=1))
        with np.errstate(divide="ignore", invalid="ignore"):
            wanted = np.sqrt(bend / (8 * allowed))
            chords = np.linalg.norm(cubics[:, 1:, :3].sum(axis=1), axis=1) / (longest * radii)
        needed = np.clip(np.nan_to_num(wanted, nan=1.0, posinf=MAX_PIECES), 1, MAX_PIECES)
        # Of a radius of 0 nothing is seen, however long its segments are.
        chords = np.clip(np.where(radii > 0, chords, 1.0), 1, MAX_SEGMENTS + 1)
        pieces[block] = np.ceil(np.maximum(needed, chords))
    return pieces


def _flattened(curves: Curves, stacked: np.ndarray, error: float,
               longest: float) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Where the pieces of all cubics begin, (m, columns) float32, where the last of each strand ends, (strands,
    columns), and the pieces of each strand, (strands,)."""
    spans = curves.spans
    strand, number, blocks = _spans(curves)
    pieces = _pieces(curves, stacked, error, longest)
    total = int(pieces.sum())
    if total > MAX_SEGMENTS:
        raise _too_many(curves, total)
    begin = np.empty((total, stacked.shape[1]), np.float32)
    last = np.empty((len(strand), stacked.shape[1]), np.float32)
    done = 0
    for block in blocks:
        cubics, _ = _cubics(curves, stacked, strand[block], number[block])
        last[block] = cubics.sum(axis=1)
        cubic = np.repeat(np.arange(len(cubics)), pieces[block])
        step = np.arange(len(cubic)) - np.repeat(np.cumsum(pieces[block]) - pieces[block], pieces[block])
        for first in range(0, len(cubic), _BLOCK):
            part = slice(first, first + _BLOCK)
            t = (step[part] / pieces[block][cubic[part]])[:, None]
            c = cubics[cubic[part]]
            begin[done:done + len(t)] = c[:, 0] + t * (c[:, 1] + t * (c[:, 2] + t * c[:, 3]))
            done += len(t)
    counts = np.bincount(strand, weights=pieces, minlength=len(spans)).astype(np.int64)
    return begin, last[np.cumsum(spans) - 1], counts


def _cubics(curves: Curves, stacked: np.ndarray, strand: np.ndarray,
            number: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """The coefficients (k, 4, columns) float64 of spans, each given by its strand and its number there, and the larger
    radius of their points, (k,)."""
    start, length, closed = curves.offsets[strand], curves.lengths[strand], curves.closed[strand]
    shift = 0 if curves.kind == "b-spline" else -1
    local = number[:, None] + np.arange(shift, shift + 4)
    inside = np.where(closed[:, None], local % length[:, None], np.clip(local, 0, length[:, None] - 1))
    points = stacked[start[:, None] + inside].astype(np.float64)
    if curves.kind == "catmull-rom":  # the further points 2 p0 - p1 and 2 p(n-1) - p(n-2) at the ends
        before, after = ~closed & (number == 0), ~closed & (number == length - 2)
        points[before, 0] = 2 * points[before, 1] - points[before, 2]
        points[after, 3] = 2 * points[after, 2] - points[after, 1]
    radii = np.abs(points[:, :, 3]).max(axis=1)
    return np.einsum("ij,kjc->kic", _CUBICS[curves.kind], points), radii


def _along(ends: np.ndarray, counts: np.ndarray) -> np.ndarray:
    """The share of its strand's length up to both ends of each segment, (m, 2) float32."""
    lengths = np.linalg.norm(ends[:, 1, :3] - ends[:, 0, :3], axis=1).astype(np.float64)
    upto = np.concatenate([[0.0], np.cumsum(lengths)])
    last = np.cumsum(counts)
    begin, whole = upto[last - counts], upto[last] - upto[last - counts]
    begin, whole = np.repeat(begin, counts), np.repeat(np.where(whole > 0, whole, 1.0), counts)
    out = np.empty((len(lengths), 2), np.float32)
    out[:, 0], out[:, 1] = (upto[:-1] - begin) / whole, (upto[1:] - begin) / whole
    return np.clip(out, 0.0, 1.0, out=out)
