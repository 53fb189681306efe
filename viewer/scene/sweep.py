"""Polygons of many corners cut into triangles by a sweep over their corners, from left to right: n log n steps."""

from __future__ import annotations

from bisect import bisect_left

import numpy as np


def sweep(points: np.ndarray) -> np.ndarray | None:
    """Cut a counter-clockwise polygon, (n, 2) float64, into (n - 2, 3) corners; None if its sides cross or touch in a
    way that the sweep does not see through.

    Hertel and Mehlhorn 1983, "Fast Triangulation of Simple Polygons". The line of the sweep cuts the inside into
    intervals. Each has a chain of corners that were passed and that no triangle separates from the line yet; a corner
    that is passed next cuts off from an end of the chain what it sees.
    """
    found = _Sweep(points).triangles()
    if found is None or len(found) != len(points) - 2:
        return None
    a, b, c = (points[found[:, k]] for k in range(3))
    areas = (b - a)[:, 0] * (c - a)[:, 1] - (b - a)[:, 1] * (c - a)[:, 0]
    x, y = points.T
    whole = float((x * np.roll(y, -1) - y * np.roll(x, -1)).sum())
    tiny = 1e-9 * float(np.ptp(points, axis=0).max()) ** 2
    return found if areas.min() >= -tiny and abs(areas.sum() - whole) <= tiny else None


class _Interval:
    """What the line cuts between two sides: `lower` and `upper`, (left, right) corner each. `first`, `last` and
    `newest` are links of its chain, from the lower side to the upper one, and the one that was passed last."""

    __slots__ = ("first", "last", "lower", "newest", "upper")

    def __init__(self, link: int, lower: tuple[int, int], upper: tuple[int, int]) -> None:
        self.first = self.last = self.newest = link
        self.lower, self.upper = lower, upper


class _Sweep:
    def __init__(self, points: np.ndarray) -> None:
        self._count = len(points)
        self._order = np.lexsort((points[:, 1], points[:, 0]))
        self._x, self._y = points.T.tolist()
        self._corner: list[int] = []  # of each link of a chain
        self._next: list[int] = []
        self._previous: list[int] = []
        self._cut: list[tuple[int, int, int]] = []
        self._intervals: list[_Interval] = []  # from below
        self._lower_ends: dict[int, _Interval] = {}  # by the right corner of their lower side
        self._upper_ends: dict[int, _Interval] = {}

    def triangles(self) -> np.ndarray | None:
        rank = np.empty(self._count, int)
        rank[self._order] = np.arange(self._count)
        ranks = rank.tolist()
        try:
            for corner in self._order.tolist():
                before, after = (corner - 1) % self._count, (corner + 1) % self._count
                is_left = ranks[before] > ranks[corner], ranks[after] > ranks[corner]
                self._pass(corner, before, after, is_left)
        except (KeyError, IndexError, ValueError):  # a side is not where it should be
            return None
        return np.array(self._cut, int).reshape(-1, 3)

    def _pass(self, corner: int, before: int, after: int, is_left: tuple[bool, bool]) -> None:
        """`is_left`: whether `corner` lies left of the corners before and after it. The inside lies above a side that
        goes to the right, and below one that goes to the left."""
        if is_left == (False, True):
            interval = self._lower_ends.pop(corner)
            self._see_from_below(interval, corner)
            self._set_lower(interval, corner, after)
        elif is_left == (True, False):
            interval = self._upper_ends.pop(corner)
            self._see_from_above(interval, corner)
            self._set_upper(interval, corner, before)
        elif is_left == (True, True):
            if self._area(before, corner, after) > 0:
                interval = _Interval(self._link(corner), (corner, after), (corner, before))
                self._intervals.insert(self._below(corner), interval)
                self._set_lower(interval, corner, after)
                self._set_upper(interval, corner, before)
            else:
                self._split(corner, before, after)
        elif self._area(before, corner, after) > 0:
            self._end(corner)
        else:
            self._merge(corner)

    def _split(self, corner: int, before: int, after: int) -> None:
        """A corner from which the inside lies to the left, between two sides that go on to the right."""
        place = self._below(corner)
        lower = self._intervals[place - 1] if place else None
        if lower is None:
            raise IndexError
        newest, upper_side = lower.newest, lower.upper
        upper = _Interval(self._link(self._corner[newest]), (corner, after), upper_side)
        if newest == lower.last:
            upper.last = upper.first
        else:
            self._join(upper.first, self._next[newest])
            upper.last = lower.last
        lower.last = newest
        self._see_from_above(lower, corner)
        self._see_from_below(upper, corner)
        self._set_upper(lower, corner, before)
        self._set_lower(upper, corner, after)
        self._set_upper(upper, *upper_side)
        self._intervals.insert(place, upper)

    def _merge(self, corner: int) -> None:
        """A corner from which the inside lies to the right, between two sides that come from the left."""
        lower, upper = self._upper_ends.pop(corner), self._lower_ends.pop(corner)
        self._remove(upper, corner)
        self._see_from_above(lower, corner)
        self._see_from_below(upper, corner)
        self._join(lower.last, self._next[upper.first])
        lower.newest, lower.last = lower.last, upper.last
        self._set_upper(lower, *upper.upper)

    def _end(self, corner: int) -> None:
        interval = self._lower_ends.pop(corner)
        if self._upper_ends.pop(corner) is not interval:
            raise KeyError
        link = interval.first
        while link != interval.last:
            self._cut.append((self._corner[link], corner, self._corner[self._next[link]]))
            link = self._next[link]
        self._remove(interval, corner)

    def _see_from_below(self, interval: _Interval, corner: int) -> None:
        """Cut off what `corner`, at the lower side, sees of the chain, and put it there."""
        link = interval.first
        while link != interval.last:
            following = self._next[link]
            if self._area(self._corner[link], corner, self._corner[following]) <= 0:
                break
            self._cut.append((self._corner[link], corner, self._corner[following]))
            link = following
        interval.first = interval.newest = self._link(corner)
        self._join(interval.first, link)

    def _see_from_above(self, interval: _Interval, corner: int) -> None:
        link = interval.last
        while link != interval.first:
            preceding = self._previous[link]
            if self._area(self._corner[preceding], corner, self._corner[link]) <= 0:
                break
            self._cut.append((self._corner[preceding], corner, self._corner[link]))
            link = preceding
        interval.last = interval.newest = self._link(corner)
        self._join(link, interval.last)

    def _set_lower(self, interval: _Interval, left: int, right: int) -> None:
        interval.lower = left, right
        self._lower_ends[right] = interval

    def _set_upper(self, interval: _Interval, left: int, right: int) -> None:
        interval.upper = left, right
        self._upper_ends[right] = interval

    def _below(self, corner: int) -> int:
        """How many intervals have their lower side below `corner`."""
        return bisect_left(self._intervals, True, key=lambda i: self._area(i.lower[0], i.lower[1], corner) <= 0)

    def _remove(self, interval: _Interval, corner: int) -> None:
        place = self._below(corner)
        if self._intervals[place] is not interval:
            place = self._intervals.index(interval)
        del self._intervals[place]

    def _link(self, corner: int) -> int:
        self._corner.append(corner)
        self._next.append(-1)
        self._previous.append(-1)
        return len(self._corner) - 1

    def _join(self, first: int, second: int) -> None:
        self._next[first], self._previous[second] = second, first

    def _area(self, a: int, b: int, c: int) -> float:
        """Twice the area of a triangle of corners, positive counter-clockwise."""
        x, y = self._x, self._y
        return (x[b] - x[a]) * (y[c] - y[a]) - (y[b] - y[a]) * (x[c] - x[a])
