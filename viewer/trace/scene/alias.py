"""Alias tables: choose one of many weighted items, or cells of a grid, with one look-up."""

from __future__ import annotations

import numpy as np


def alias_table(weights: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Thresholds (N,) float64 and aliases (N,) uint32 for `weights` (N,), finite, not negative, some of them positive.

    To sample, choose k of N and x in [0, 1) uniformly, and take k if x < threshold[k], else alias[k] (Walker 1977). The
    construction without a loop is that of Huebschle-Schneider & Sanders 2022, "Parallel Weighted Random Sampling". The
    heavy entries, above the mean, fill up the light ones in turn. A heavy entry that falls below the mean by that is
    filled up by the next heavy one. Prefix sums, of what light entries lack and of what heavy ones have in excess, tell
    which heavy entry fills which light one.
    """
    weights = np.asarray(weights, np.float64)
    scaled = weights / weights.max()  # the sum of huge weights must not overflow
    return alias_table_of_mean_one(scaled * (len(scaled) / scaled.sum()))


def alias_table_of_mean_one(scaled: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """As `alias_table` for weights that have the mean 1. There is no rounding if they are multiples of a power of two:
    then runs of entries that have the mean 1, too, have aliases among themselves wherever a threshold is below 1."""
    is_heavy = scaled > 1
    light, heavy = np.flatnonzero(~is_heavy), np.flatnonzero(is_heavy)
    threshold, alias = np.ones(len(scaled)), np.arange(len(scaled), dtype=np.uint32)
    if not len(heavy):
        return threshold, alias
    lack = np.concatenate([[0.0], np.cumsum(1 - scaled[light])])  # of the first 0, 1, 2, ... light entries
    excess = np.cumsum(scaled[heavy] - 1)
    # The first heavy entry that has excess left fills a light one.
    giver = np.minimum(np.searchsorted(excess, lack[:-1], side="right"), len(heavy) - 1)
    threshold[light], alias[light] = scaled[light], heavy[giver]
    # A heavy entry falls below the mean at the first light entry that takes more than the excess it has left.
    taken = lack[np.minimum(np.searchsorted(lack, excess[:-1], side="left"), len(light))]
    threshold[heavy[:-1]] = np.clip(1 + excess[:-1] - taken, 0, 1)
    alias[heavy[:-1]] = heavy[1:]
    return threshold, alias


def alias_grid(weights: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """As `alias_table` for the cells of a grid, (rows, columns): flat arrays, row by row.

    Light cells are filled in the order of a Z-order curve (Morton 1966) by heavy ones in the same order. So cells of a
    square whose side is a power of two have the cells of a compact place as their aliases, and points that are
    stratified in the grid are stratified among the heavy cells, too.
    """
    order = morton_order(*weights.shape)
    threshold, alias = np.empty(weights.size), np.empty(weights.size, np.uint32)
    threshold[order], along = alias_table(weights.ravel()[order])
    alias[order] = order[along]
    return threshold, alias


def morton_order(rows: int, columns: int) -> np.ndarray:
    """The cells of a grid, row by row, in the order of a Z-order curve: (rows * columns,) int64."""
    codes = _spread_bits(np.arange(columns)) | _spread_bits(np.arange(rows))[:, None] << 1
    order = np.full(codes.max() + 1, -1)
    order[codes.ravel()] = np.arange(rows * columns)
    return order[order >= 0]


def _spread_bits(numbers: np.ndarray) -> np.ndarray:
    """The numbers, below 2^16, with a zero after each of their bits."""
    bits = np.arange(16)
    return ((numbers[:, None] >> bits & 1) << 2 * bits).sum(axis=1)
