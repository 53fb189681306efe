"""Polygons cut into triangles: as fans where a fan covers them, others by clipping ears, large ones by a sweep."""

from __future__ import annotations

import numpy as np

from .sweep import sweep

MAX_WORK = 1 << 25
"""How often ear clipping may look at a corner in one file, a few seconds; what is beyond it is cut in any way."""
SWEPT = 256
"""Polygons of so many corners are swept, each for itself. Ears are clipped of many side by side, but in n^2 steps."""
_BATCH = 1 << 20
_ROUND = 1000  # what one round costs besides, in such looks
_SWEEP = 128  # what a sweep costs for each corner, in such looks


def triangulate(positions: np.ndarray, corners: np.ndarray, sizes: np.ndarray) -> tuple[np.ndarray, np.ndarray, int]:
    """Cut polygons into triangles, a polygon of n corners into n - 2.

    positions (N, 3) float64; corners (C,) the vertex of each corner, polygon after polygon; sizes (P,) corners of each
    polygon, at least 3. Returns the triangles (T, 3) as numbers of corners 0..C-1, in the order and with the winding of
    the polygons, the polygon of each triangle (T,), and the number of concave polygons that were cut in any way, or
    whose ears were not clipped to their end, since MAX_WORK was done. Exact for polygons that are plane and do not cut
    themselves.
    """
    if (sizes == 3).all():
        return np.arange(len(corners)).reshape(-1, 3), np.arange(len(sizes)), 0
    first = np.cumsum(sizes) - sizes
    at = np.cumsum(sizes - 2) - (sizes - 2)
    polygon = np.repeat(np.arange(len(sizes)), sizes - 2)
    step = np.arange(len(polygon)) - at[polygon]
    fan = first[polygon]
    triangles = np.stack([fan, fan + step + 1, fan + step + 2], axis=1)

    work, uncut = 0, 0
    for size in np.unique(sizes[sizes > 3]):
        group = np.flatnonzero(sizes == size)
        for some in np.array_split(group, max(1, len(group) * int(size) // _BATCH)):
            points = _flattened(positions[corners[first[some, None] + np.arange(size)]])
            wrong = ~_is_fan(points)
            some, points = some[wrong], points[wrong]
            if size >= SWEPT:
                kept = np.ones(len(some), bool)
                for k, outline in enumerate(points):
                    if work > MAX_WORK:
                        break
                    work += _SWEEP * int(size)
                    swept = sweep(outline)
                    if swept is not None:
                        triangles[at[some[k]] + np.arange(size - 2)] = first[some[k]] + swept
                        kept[k] = False
                    elif int(size) * int(_turns_right(outline).sum()) > MAX_WORK - work:  # as many looks as ears take
                        uncut += 1
                        kept[k] = False
                some, points = some[kept], points[kept]
            if len(some) == 0:
                continue
            if size == 4:
                # A quad has two diagonals; where the fan's leaves it, the other one does not.
                triangles[at[some, None] + np.arange(2)] = first[some, None, None] + [[0, 1, 3], [1, 2, 3]]
            elif work > MAX_WORK:
                uncut += len(some)
            else:
                cut, looked_at, unfinished = _clip_ears(points, MAX_WORK - work)
                work += looked_at
                uncut += unfinished
                triangles[at[some, None] + np.arange(size - 2)] = first[some, None, None] + cut
    return triangles, polygon, uncut


def _flattened(points: np.ndarray) -> np.ndarray:
    """(P, n, 3) polygons to (P, n, 2), counter-clockwise: along the axis that their normals are nearest to."""
    points = points - points[:, :1]
    # Newell's normal, twice the area long: the sum of the cross products of successive corners.
    normal = np.cross(points, np.roll(points, -1, axis=1)).sum(axis=1)
    axis = np.abs(normal).argmax(axis=1)
    negative = normal[np.arange(len(points)), axis] < 0
    u, v = (axis + 1) % 3, (axis + 2) % 3
    kept = np.stack([np.where(negative, v, u), np.where(negative, u, v)], axis=1)
    return np.take_along_axis(points, kept[:, None, :], axis=2)


def _area(a: np.ndarray, b: np.ndarray, c: np.ndarray) -> np.ndarray:
    """Twice the signed area of triangles of (..., 2) points, positive counter-clockwise."""
    return (b[..., 0] - a[..., 0]) * (c[..., 1] - a[..., 1]) - (b[..., 1] - a[..., 1]) * (c[..., 0] - a[..., 0])


def _is_fan(points: np.ndarray) -> np.ndarray:
    """Of which (P, n, 2) counter-clockwise polygons the first corner sees every side from the left, but for rounding.

    They are cut as they should be by diagonals from there, and all that are convex are among them.
    """
    areas = _area(points[:, :1], points[:, 1:-1], points[:, 2:])
    extent = np.ptp(points, axis=1).max(axis=1, keepdims=True)
    is_fan: np.ndarray = (areas >= -1e-9 * extent**2).all(axis=1)
    return is_fan


def _clip_ears(points: np.ndarray, budget: int) -> tuple[np.ndarray, int, int]:
    """Ear clipping (Meisters 1975) of (P, n, 2) polygons side by side: (P, n - 2, 3) corners, the work done, and how
    many polygons were not finished within the budget.

    Every round looks at one corner of each polygon. A polygon of which no corner is an ear cuts itself: from then on
    any corner that turns left is cut off, and once there is none, every one. So it is beyond the budget.
    """
    count, size, _ = points.shape
    before = np.tile(np.roll(np.arange(size), 1), (count, 1))
    after = np.tile(np.roll(np.arange(size), -1), (count, 1))
    # Only corners that turn right at first can ever lie in an ear. Each polygon's come first in its row of `right`.
    turns_right = _turns_right(points)
    right = np.argsort(~turns_right, axis=1, kind="stable")[:, :max(1, int(turns_right.sum(axis=1).max()))]
    alive = turns_right.copy()
    out = np.empty((count, size - 2, 3), np.int64)
    left = np.full(count, size)
    tries = np.zeros(count, np.int64)
    cuts_itself, is_hopeless = np.zeros(count, bool), np.zeros(count, bool)
    current = np.zeros(count, np.int64)
    here = np.arange(count)
    work, unfinished = 0, 0
    while len(here):
        b = current[here]
        a, c = before[here, b], after[here, b]
        pa, pb, pc = points[here, a], points[here, b], points[here, c]
        cut = _area(pa, pb, pc) > 0
        test = np.flatnonzero(cut & ~cuts_itself[here])
        cut |= (pb == pa).all(axis=1) | (pb == pc).all(axis=1)  # a corner that stands twice
        if work > budget:
            unfinished = unfinished or len(here)
            is_hopeless[:] = True
        else:
            row, others = here[test, None], right[here[test]]
            inside = _is_inside(points[row, others], pa[test], pb[test], pc[test]) & alive[row, others]
            cut[test] = ~inside.any(axis=1)
            work += inside.size + _ROUND
        cuts_itself[here] |= tries[here] >= left[here]
        is_hopeless[here] |= tries[here] >= 2 * left[here]
        cut |= is_hopeless[here]
        done, kept = here[cut], here[~cut]
        out[done, size - left[done]] = np.stack([a, b, c], axis=1)[cut]
        alive[done, b[cut]] = False
        after[done, a[cut]], before[done, c[cut]] = c[cut], a[cut]
        left[done] -= 1
        tries[done] = 0
        tries[kept] += 1
        current[done], current[kept] = c[cut], c[~cut]
        here = here[left[here] > 2]
    return out, work, unfinished


def _turns_right(points: np.ndarray) -> np.ndarray:
    """At which corners of (..., n, 2) polygons, or does not turn."""
    return _area(np.roll(points, 1, axis=-2), points, np.roll(points, -1, axis=-2)) <= 0


def _is_inside(points: np.ndarray, a: np.ndarray, b: np.ndarray, c: np.ndarray) -> np.ndarray:
    """Which of (P, m, 2) points lie in or on the triangle a, b, c, (P, 2) each.

    Points at the place of a, b or c do not: bridges to holes pass the same point twice.
    """
    a, b, c = a[:, None], b[:, None], c[:, None]
    inside = (_area(a, b, points) >= 0) & (_area(b, c, points) >= 0) & (_area(c, a, points) >= 0)
    for corner in (a, b, c):
        inside &= (points != corner).any(axis=2)
    return inside
