"""The schedule: how many samples each tile gets next.

Without a target error or a time budget, each pixel gets exactly `spp` samples. With one, all pixels get 64 samples
first, the pilot; from then on tiles get different numbers. To decide from the samples that also make the picture has a
small bias: a tile that has missed the light by chance looks finished too early. Three rules keep the bias small: the
pilot comes first, the variance is pooled over the 256 pixels of a tile, and the noise of neighbouring tiles counts.
"""

from __future__ import annotations

from collections import deque
from itertools import pairwise
from operator import itemgetter

import numpy as np

from ...settings import Settings
from ..layout import TILE
from .film import Film
from .wavefront import SECOND, Work

PILOT = 64
"""Samples per pixel before tiles get different numbers."""
GROWTH = 1.5
"""Factor by which an adaptive round increases the total number of samples."""
MAX_CHUNK, LONG_CHUNK = 4, 8
"""Most samples of one work item. Small items keep the blocks of a wavefront busy until its end. The longer ones are for
pictures of a given number of samples whose tiles a wavefront holds all at once, where no item need wait for another."""
MIN_COLLECTED = 0.75
"""Part of the samples handed out that has to be in the film before the next adaptive round."""
DEFENSIVE = 0.25
"""Part of the mean deviation that is added to that of each tile, since a tile may underestimate its own."""


class Schedule:
    """Hands out work to the wavefronts of one picture. `done`: all work has been handed out."""

    def __init__(self, film: Film, settings: Settings, first: int = 0, traced: int | None = None) -> None:
        """`first` is the number of the first sample, for a part of a picture that is neither adaptive nor timed.

        `traced` is how many tiles have pixels that are traced, if the work of a small picture is to begin at once;
        None: small rounds come first."""
        self._film, self._target, self._most = film, settings.error, first + settings.most_spp
        self._is_timed = settings.time_budget is not None
        self._is_adaptive = settings.error is not None or self._is_timed
        self._pilot = min(self._most, PILOT) if self._is_adaptive else self._most
        columns, rows = film.tiles
        self._issued = np.full((rows, columns), first, np.int64)
        self._pixels = np.outer(_sides(film.size[1], rows), _sides(film.size[0], columns))
        self._traced = traced
        self._rounds = 0
        self._chunk: int | None = None
        self._parts = np.zeros((2, rows, columns), np.int64)
        """Samples of each tile that were handed out for each part of the film, if it has parts."""
        self._queue: deque[Work] = deque()
        self.done = False

    def next(self, count: int, is_last: bool) -> list[Work]:
        """At most `count` work items of about the same number of samples; none if there is no work at present.

        `is_last` says that all work handed out before is in the film. If there is no work then, there will be none
        later.
        """
        while len(self._queue) < count and self._plan_round(count, is_last and not self._queue):
            pass
        work = [self._queue.popleft() for _ in range(min(count, len(self._queue)))]
        if self._film.parts:
            work = [self._of_part(item) for item in work]
        self.done = not self._queue and (bool((self._issued >= self._most).all()) or (is_last and not work))
        return work

    def _of_part(self, item: Work) -> Work:
        """The item for the part of the film that has fewer samples of its tile."""
        given = self._parts[:, item.tile_y, item.tile_x]
        part = int(given[1] < given[0])
        first = int(given[part]) + part * SECOND
        given[part] += item.samples
        return item._replace(first=first)

    def _plan_round(self, count: int, is_last: bool) -> bool:
        """Queue one more round; returns whether it has any work.

        A time budget can end only when each pixel has a sample. So the first round has one for each then, and no other
        work delays it.
        """
        if self._is_timed and self._rounds == 1 and not is_last:
            return False
        if self._issued.min() < self._pilot:
            chunk = self._first_chunk(count)
            each = chunk * (1 if self._is_timed and not self._rounds else max(count // self._issued.size, 1))
            wanted = np.minimum(self._issued + each, self._pilot)
        else:
            chunk, wanted = MAX_CHUNK, self._adapt(is_last)
        self._rounds += 1
        has_more = bool((wanted > self._issued).any())
        self._enqueue(wanted, chunk)
        return has_more

    def _first_chunk(self, count: int) -> int:
        """Samples of a work item, if one wavefront asks for so many items, before tiles get different numbers."""
        if self._film.parts and self._issued.min() < MAX_CHUNK:
            return 1  # so that both parts have as many of few samples
        if self._traced is not None and not self._rounds and not self._is_adaptive and count >= self._issued.size:
            left = self._most - int(self._issued.min())
            self._chunk = min(max(-(-self._traced * left // (2 * count)), 1), LONG_CHUNK)  # fills two wavefronts
        return self._chunk or min(MAX_CHUNK, 1 << max(self._rounds - 1, 0))  # small first rounds show a picture soon

    def _adapt(self, is_last: bool) -> np.ndarray:
        """The number of samples that each tile shall have, so as to lower the mean relative variance most."""
        if self._issued.min() >= self._most:
            return self._issued
        tiles = self._film.tile_errors().astype(np.float64)
        if not is_last and tiles[..., 2].sum() < MIN_COLLECTED * (self._issued * self._pixels).sum():
            return self._issued
        one = tiles[..., 0] / np.maximum(tiles[..., 1], 1) * tiles[..., 2] / tiles[..., 3]  # variance of one sample
        variance = dilated(np.nan_to_num(one, nan=0.0, posinf=1e30))
        most = np.full(self._issued.shape, float(self._most))
        if self._target is not None:
            most = np.minimum(np.ceil(variance / self._target**2), most)
        deviation = np.sqrt(variance)
        deviation += DEFENSIVE * deviation.mean()
        return allocate(deviation, self._pixels, self._issued, most, GROWTH * (self._issued * self._pixels).sum())

    def _enqueue(self, wanted: np.ndarray, chunk: int) -> None:
        items = []
        for row, column in np.argwhere(wanted > self._issued).tolist():
            first, last = int(self._issued[row, column]), int(wanted[row, column])
            parts = -(-(last - first) // chunk)
            bounds = [first + (last - first) * k // parts for k in range(parts + 1)]
            items += [((k + 0.5) / parts, Work(column, row, low, high - low))
                      for k, (low, high) in enumerate(pairwise(bounds))]
        # Tiles progress evenly: whenever the render is stopped, all have had about the same part of their samples.
        self._queue.extend(work for _, work in sorted(items, key=itemgetter(0)))
        self._issued = wanted


def dilated(variance: np.ndarray) -> np.ndarray:
    """The variance of each tile, (rows, columns), raised to at least a quarter of that of any of its eight neighbours.

    A tile may not have found the light yet that its neighbour has found. A quarter of the variance is half the error.
    """
    padded = np.pad(variance, 1)
    rows, columns = variance.shape
    around = np.max([padded[y:y + rows, x:x + columns] for y in range(3) for x in range(3)], axis=0)
    return np.maximum(variance, around / 4)


def allocate(deviation: np.ndarray, pixels: np.ndarray, least: np.ndarray, most: np.ndarray,
              total: float) -> np.ndarray:
    """Neyman allocation: the number of samples of each tile, in proportion to its `deviation`.

    The numbers are between `least` and `most`. Summed over tiles with `pixels` pixels each they are about `total`, or
    as near to it as `most` allows. This minimises the sum of deviation^2 / samples (Neyman 1934).
    """
    most = np.maximum(least, most)
    low, high = 0.0, float((most[deviation > 0] / deviation[deviation > 0]).max(initial=0.0))
    for _ in range(60):
        middle = (low + high) / 2
        too_many = (np.clip(middle * deviation, least, most) * pixels).sum() > total
        low, high = (low, middle) if too_many else (middle, high)
    return np.ceil(np.clip(high * deviation, least, most) - 1e-6).astype(np.int64)


def _sides(size: int, tiles: int) -> np.ndarray:
    """Width or height of each tile in pixels."""
    return np.minimum(size - TILE * np.arange(tiles), TILE)
