"""The schedule: which pixels get how many samples next.

Without a target error or a time budget, each pixel gets exactly `spp` samples. With one, all pixels get 16 samples
first, the pilot; from then on pixels get different numbers (viewer/trace/paths/distribution.py), which do not depend on
their own samples. To stop by the error of samples that also make the picture has a small bias: a tile that has missed
the light by chance looks finished too early. Three rules keep that bias small: each pixel gets 64 samples first, the
variance is pooled over the 256 pixels of a tile, and the noise of neighbouring tiles counts.
"""

from __future__ import annotations

from collections import deque
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ...settings import Settings
from ..layout import TILE
from .distribution import MOST_GROWTH, allocate
from .film import Film
from .wavefront import MOST_SAMPLES, SECOND, Work

PILOT = 16
"""Samples per pixel before pixels get different numbers."""
LEAST = 64
"""Samples per pixel before a target error counts as met."""
GROWTH = 4.0
"""Factor by which an adaptive round increases the total number of samples."""
MAX_CHUNK, LONG_CHUNK = 4, 8
"""Most samples of one work item. Small items keep the blocks of a wavefront busy until its end. The longer ones are for
pictures of a given number of samples whose tiles a wavefront holds all at once, where no item need wait for another."""
FULL = 0.95
"""Part of their places that the work of a small picture fills in two wavefronts, so that no item waits for a place."""
MIN_COLLECTED = 0.9
"""Part of the samples handed out that has to be in the film before the next adaptive round."""
_LARGEST = 1e30


@dataclass
class _Round:
    """Work `items`, (items, 4), that were planned at once and not handed out. `ends`, (rows, columns, TILE, TILE), has
    the number of the sample before which each pixel ends, if not all of a tile have as many."""

    items: NDArray[np.int64]
    ends: NDArray[np.int64] | None = None

    def take(self, count: int) -> list[Work]:
        """The next items, at most so many."""
        taken, self.items = self.items[:count], self.items[count:]
        if self.ends is None:
            return [Work(*item) for item in taken.tolist()]
        ends = self.ends[taken[:, 1], taken[:, 0]]
        is_whole = ends.min(axis=(1, 2)) > taken[:, 2]
        pixels = [None if whole else own for whole, own in zip(is_whole, ends > taken[:, 2, None, None], strict=True)]
        return [Work._make((*item, own)) for item, own in zip(taken.tolist(), pixels, strict=True)]


class Schedule:
    """Hands out work to the wavefronts of one picture. `done`: all work has been handed out."""

    def __init__(self, film: Film, settings: Settings, first: int = 0,
                 traced: NDArray[np.int64] | None = None) -> None:
        """`first` is the number of the first sample, for a part of a picture that is neither adaptive nor timed.

        `traced`, (rows, columns), is how many pixels of each tile are traced, if the work of a small picture is to
        begin at once; None: small rounds come first."""
        self._film, self._target, self._most = film, settings.error, first + settings.most_spp
        self._is_timed = settings.time_budget is not None
        self._is_adaptive = settings.error is not None or self._is_timed
        self._pilot = min(self._most, PILOT) if self._is_adaptive else self._most
        columns, rows = film.tiles
        self._issued = np.full((rows, columns), first, np.int64)
        self._given = np.full(film.size[::-1], first, np.int64)
        """Samples of each pixel that were handed out, row 0 at the bottom."""
        self._step = MAX_CHUNK * (2 if film.parts else 1)  # of a pixel's samples, as many for each part
        self._traced = traced
        self._rounds = 0
        self._parts = np.zeros((2, rows, columns), np.int64)
        """Samples of each tile that were handed out for each part of the film, if it has parts."""
        self._queue: deque[_Round] = deque()
        self.collected = 0
        """How many samples of all pixels together are in the film, or were left out of it."""
        self.done = False

    def next(self, count: int, is_last: bool) -> list[Work]:
        """At most `count` work items of about the same number of samples; none if there is no work at present.

        `is_last` says that all work handed out before is in the film. If there is no work then, there will be none
        later.
        """
        while self._queued < count and self._plan_round(count, is_last and not self._queued):
            pass
        work: list[Work] = []
        while self._queue and len(work) < count:
            work += self._queue[0].take(count - len(work))
            if not len(self._queue[0].items):
                self._queue.popleft()
        if self._film.parts:
            work = [self._of_part(item) for item in work]
        has_all = bool((self._issued >= self._most).all()) if not self._is_adaptive else (
            int(self._given.sum()) >= self._most * self._given.size)
        self.done = not self._queue and (has_all or (is_last and not work))
        return work

    @property
    def _queued(self) -> int:
        """How many work items are planned, but not handed out."""
        return sum(len(planned.items) for planned in self._queue)

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
            wanted, parts = self._first_round(count)
            planned = _Round(_in_turn(self._issued, wanted, parts))
            self._issued = wanted
            self._given[:] = wanted.max()  # tiles have equal numbers so far
        else:
            planned = self._distributed(is_last)
        if len(planned.items):
            self._queue.append(planned)
        self._rounds += 1
        return bool(len(planned.items))

    def _first_round(self, count: int) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
        """How many samples tiles have after a round in which they get equal numbers, and of how many work items it is,
        (rows, columns) each, if one wavefront asks for `count`."""
        has_parts = bool(self._film.parts)
        if self._traced is not None and not self._is_timed and not has_parts and count >= self._issued.size:
            fitting = max(int(2 * FULL * count * TILE**2) // max(int(self._traced.sum()), 1), 1)  # in two wavefronts
            each = np.minimum(self._pilot - self._issued, fitting * LONG_CHUNK)
            parts = np.minimum(fitting, each)
            return self._issued + each, np.where(self._traced > 0, parts, -(-each // MOST_SAMPLES))
        chunk = min(MAX_CHUNK, 1 << max(self._rounds - 1, 0))  # small first rounds show a picture soon
        if has_parts and self._issued.min() < MAX_CHUNK:
            chunk = 1  # so that both parts have as many of few samples
        more = chunk * (1 if self._is_timed and not self._rounds else max(count // self._issued.size, 1))
        wanted = np.minimum(self._issued + more, self._pilot)
        return wanted, -(-(wanted - self._issued) // chunk)

    def _distributed(self, is_last: bool) -> _Round:
        """Work for the pixels around which there is most noise, so as to lower the mean relative variance most."""
        total, limit = int(self._given.sum()), self._most * self._given.size
        if not self._is_adaptive or total >= limit or (not is_last and self.collected < MIN_COLLECTED * total):
            return _Round(np.zeros((0, 4), np.int64))
        tiles = self._film.tile_errors().astype(np.float64)
        deviation = self._film.deviation_around()
        most = MOST_GROWTH * self._given.astype(np.float64)
        if not deviation.any():  # there is no noise, or all pixels have missed the light so far
            deviation, most = np.ones(most.shape), np.minimum(most, LEAST)
        if self._target is not None:
            most = np.minimum(most, self._needed(tiles, deviation, self._target))
        more = allocate(deviation, self._given, most, min(GROWTH * total, limit), self._step)
        self._given += more
        by_tile, first = self._by_tile(more), self._issued
        self._issued = first + by_tile.max(axis=(2, 3)) // MAX_CHUNK * MAX_CHUNK
        items = _in_turn(first, self._issued, (self._issued - first) // MAX_CHUNK)
        return _Round(items, first[..., None, None] + by_tile)

    def _needed(self, tiles: np.ndarray, deviation: np.ndarray, target: float) -> np.ndarray:
        """How many samples of each pixel, (H, W), the target takes, if a tile's are in proportion to `deviation`.

        A tile's error is that of the film. That the variance of each sample is c deviation^2, with one c for a tile, is
        only a guess by which it gets there; the next round corrects it.
        """
        arrived = tiles[..., 2] / self._by_tile(self._given).sum(axis=(2, 3))  # the others are still on their way
        variance = tiles[..., 0] / np.maximum(tiles[..., 1], 1) * arrived
        least = np.maximum(self._given, LEAST)
        mean, square, now, soon = (self._by_tile(values).sum(axis=(2, 3)) / tiles[..., 3] for values in (
            deviation, deviation**2, deviation**2 / self._given, deviation**2 / least))
        with np.errstate(invalid="ignore", divide="ignore"):
            one = np.nan_to_num(variance / now * square, nan=0.0, posinf=_LARGEST)  # variance of a sample of the tile
            worst = dilated(one)
            factor = np.nan_to_num(worst / square * mean / target**2, nan=0.0)
        factor[worst * soon <= target**2 * square] = 0.0
        height, width = deviation.shape
        needed = np.maximum(np.repeat(np.repeat(factor, TILE, 0), TILE, 1)[:height, :width] * deviation, LEAST)
        return self._given + np.ceil((needed - self._given) / self._step) * self._step

    def _by_tile(self, pixels: np.ndarray) -> np.ndarray:
        """A picture, (H, W), as (rows, columns, TILE, TILE), with zeros outside."""
        rows, columns = self._issued.shape
        padded = np.pad(pixels, [(0, -side % TILE) for side in pixels.shape])
        return padded.reshape(rows, TILE, columns, TILE).swapaxes(1, 2)


def _in_turn(first: NDArray, last: NDArray, parts: NDArray) -> NDArray[np.int64]:
    """Work items, so many `parts` of each tile, (rows, columns), from number `first` to before `last`, in the order in
    which they are handed out: (items, 4), as `Work` has them.

    Tiles progress evenly: whenever the render is stopped, all have had about the same part of their samples.
    """
    rows, columns = np.nonzero(last > first)
    first, samples, parts = (of[rows, columns] for of in (first, last - first, parts))
    tile = np.repeat(np.arange(len(parts)), parts)
    part = np.arange(len(tile)) - (np.cumsum(parts) - parts)[tile]
    order = np.argsort(part / parts[tile], kind="stable")
    tile, part = tile[order], part[order]
    low, high = (first[tile] + samples[tile] * k // parts[tile] for k in (part, part + 1))
    return np.stack([columns[tile], rows[tile], low, high - low], axis=1)


def dilated(variance: np.ndarray) -> np.ndarray:
    """The variance of each tile, (rows, columns), raised to at least a quarter of that of any of its eight neighbours.

    A tile may not have found the light yet that its neighbour has found. A quarter of the variance is half the error.
    """
    padded = np.pad(variance, 1)
    rows, columns = variance.shape
    around = np.max([padded[y:y + rows, x:x + columns] for y in range(3) for x in range(3)], axis=0)
    return np.maximum(variance, around / 4)
