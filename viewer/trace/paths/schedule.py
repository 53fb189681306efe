"""Which pixels get how many samples next.

Every pixel gets the same number until that is a pilot of 64; only then do tiles differ. Without a target or a time
budget that is all: each pixel gets exactly `spp`. Deciding from the very samples that make the picture biases it, a
little: a tile that happens to have missed the light looks done too early. So the pilot comes first, the variance is
pooled over the tile's 256 pixels, and noise next door counts.
"""

from __future__ import annotations

from collections import deque
from itertools import pairwise
from operator import itemgetter

import numpy as np

from ...settings import Settings
from ..layout import TILE
from .film import Film
from .wavefront import Work

PILOT = 64
"""Samples a pixel before tiles differ."""
GROWTH = 1.5
"""How many times the samples there are after one more round, in which tiles differ."""
MAX_CHUNK = 4
"""Samples of one work item: a wave is taken in when the slowest of its items is done."""
KNOWN = 0.75
"""How much of what was handed out has to be in the film before the next round is decided on."""
DEFENSIVE = 0.25
"""How much of the mean deviation a tile is given on top of its own, which it may have underestimated."""


class Schedule:
    """Work for the waves of one picture. `done`: there is none left."""

    def __init__(self, film: Film, settings: Settings) -> None:
        self._film, self._target, self._most = film, settings.error, settings.most_spp
        self._is_adaptive = settings.error is not None or settings.time_budget is not None
        self._pilot = min(self._most, PILOT) if self._is_adaptive else self._most
        columns, rows = film.tiles
        self._issued = np.zeros((rows, columns), np.int64)
        self._pixels = np.outer(_sides(film.size[1], rows), _sides(film.size[0], columns))
        self._rounds = 0
        self._queue: deque[Work] = deque()
        self.done = False

    def next(self, count: int, is_last: bool) -> list[Work]:
        """At most `count` items of about the same number of samples; none where there is nothing to do at present.

        `is_last` says that all that was handed out before has reached the film, so that none now means none ever.
        """
        while len(self._queue) < count and self._plan_round(count, is_last and not self._queue):
            pass
        work = [self._queue.popleft() for _ in range(min(count, len(self._queue)))]
        self.done = not self._queue and (bool((self._issued >= self._most).all()) or (is_last and not work))
        return work

    def _plan_round(self, count: int, is_last: bool) -> bool:
        """Queue one more round; whether there was something to queue."""
        if self._issued.min() < self._pilot:
            chunk = min(MAX_CHUNK, 1 << max(self._rounds - 1, 0))  # a first picture soon
            each = chunk * max(count // self._issued.size, 1)
            wanted = np.minimum(self._issued + each, self._pilot)
        else:
            chunk, wanted = MAX_CHUNK, self._adapt(is_last)
        self._rounds += 1
        has_more = bool((wanted > self._issued).any())
        self._enqueue(wanted, chunk)
        return has_more

    def _adapt(self, is_last: bool) -> np.ndarray:
        """What each tile shall have had, to lower the picture's mean relative variance most."""
        if self._issued.min() >= self._most:
            return self._issued
        tiles = self._film.tile_errors().astype(np.float64)
        if not is_last and tiles[..., 2].sum() < KNOWN * (self._issued * self._pixels).sum():
            return self._issued
        one = tiles[..., 0] / np.maximum(tiles[..., 1], 1) * tiles[..., 2] / tiles[..., 3]  # of one sample
        variance = dilated(np.nan_to_num(one, nan=0.0, posinf=1e30))
        most = np.full(self._issued.shape, float(self._most))
        if self._target is not None:
            most = np.minimum(np.ceil(variance / self._target**2), most)
        deviation = np.sqrt(variance)
        deviation += DEFENSIVE * deviation.mean()
        return allotment(deviation, self._pixels, self._issued, most, GROWTH * (self._issued * self._pixels).sum())

    def _enqueue(self, wanted: np.ndarray, chunk: int) -> None:
        items = []
        for row, column in np.argwhere(wanted > self._issued).tolist():
            first, last = int(self._issued[row, column]), int(wanted[row, column])
            parts = -(-(last - first) // chunk)
            bounds = [first + (last - first) * k // parts for k in range(parts + 1)]
            items += [((k + 0.5) / parts, Work(column, row, low, high - low))
                      for k, (low, high) in enumerate(pairwise(bounds))]
        # Wherever it is stopped, all tiles have had about the same share of what they are to get.
        self._queue.extend(work for _, work in sorted(items, key=itemgetter(0)))
        self._issued = wanted


def dilated(variance: np.ndarray) -> np.ndarray:
    """Each tile's variance, (rows, columns), but at least a quarter of what any of the eight around it has: half the
    error. What one tile found may lie hidden in the next."""
    padded = np.pad(variance, 1)
    rows, columns = variance.shape
    around = np.max([padded[y:y + rows, x:x + columns] for y in range(3) for x in range(3)], axis=0)
    return np.maximum(variance, around / 4)


def allotment(deviation: np.ndarray, pixels: np.ndarray, least: np.ndarray, most: np.ndarray,
              total: float) -> np.ndarray:
    """Samples of each tile, whole numbers in proportion to `deviation` between `least` and `most`, so that with
    `pixels` each they come to about `total`, or as near to it as `most` allows.

    The sum of deviation^2 / samples is least then, by Lagrange's multiplier (Neyman 1934).
    """
    most = np.maximum(least, most)
    low, high = 0.0, float((most[deviation > 0] / deviation[deviation > 0]).max(initial=0.0))
    for _ in range(60):
        middle = (low + high) / 2
        too_many = (np.clip(middle * deviation, least, most) * pixels).sum() > total
        low, high = (low, middle) if too_many else (middle, high)
    return np.ceil(np.clip(high * deviation, least, most) - 1e-6).astype(np.int64)


def _sides(size: int, tiles: int) -> np.ndarray:
    """Pixels of each tile along one side."""
    return np.minimum(size - TILE * np.arange(tiles), TILE)
