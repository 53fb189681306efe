"""Alias tables: one of many weighted things chosen by one look-up."""

from __future__ import annotations

import numpy as np


def alias_table(weights: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Thresholds (N,) float64 and aliases (N,) uint32 for `weights` (N,), finite, not negative, some of them positive.

    Choose entry k of N evenly and x in [0, 1): k itself where x < threshold[k], else alias[k]. Walker 1977; without a
    loop as in Huebschle-Schneider & Sanders 2022, "Parallel Weighted Random Sampling": the light entries, of at most
    the mean, are filled up by the heavy ones in turn, and a heavy one that has thereby become light by the next.
    Which one it is follows from how prefix sums of what light ones lack and of what heavy ones have too much compare.
    """
    weights = np.asarray(weights, np.float64)
    scaled = weights / weights.max()  # the sum of huge ones must not overflow
    scaled *= len(scaled) / scaled.sum()
    is_heavy = scaled > 1
    light, heavy = np.flatnonzero(~is_heavy), np.flatnonzero(is_heavy)
    threshold, alias = np.ones(len(scaled)), np.arange(len(scaled), dtype=np.uint32)
    if not len(heavy):
        return threshold, alias
    lack = np.concatenate([[0.0], np.cumsum(1 - scaled[light])])  # of the first 0, 1, 2, ... light ones
    excess = np.cumsum(scaled[heavy] - 1)
    # A light one is filled by the first heavy one that has still something to give.
    giver = np.minimum(np.searchsorted(excess, lack[:-1], side="right"), len(heavy) - 1)
    threshold[light], alias[light] = scaled[light], heavy[giver]
    # A heavy one is light itself after the first light one that took all its excess, and more.
    taken = lack[np.minimum(np.searchsorted(lack, excess[:-1], side="left"), len(light))]
    threshold[heavy[:-1]] = np.clip(1 + excess[:-1] - taken, 0, 1)
    alias[heavy[:-1]] = heavy[1:]
    return threshold, alias
