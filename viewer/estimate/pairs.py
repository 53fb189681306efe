"""What estimates of relMSE from a few independent pictures share: products of pairs, the interval, the worst pixels.

`raster_error.py` tells the error of a picture of the raster, `viewer/budget/combine.py` that of a mixture.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

TRIMMED = 0.01
"""Share of the pixels, those with the largest errors, that `trimmed_mean` leaves out."""
_SURE = 2.0
"""Standard deviations on each side: 95 % of a normal distribution."""
_WEIGHTS = 0.4
"""What weights of one sample a pixel are wrong by; it falls with the root of their number."""


def squared_error(apart: np.ndarray) -> np.ndarray:
    """The U-statistic of `apart`, (G, ...): how far a picture is from each of G independent ones."""
    count = len(apart)
    return (apart.sum(axis=0) ** 2 - (apart**2).sum(axis=0)) / (count * (count - 1))


def interval(estimates: Sequence[tuple[float, float]], samples: float) -> tuple[float, float, float]:
    """relMSE, which is the first of these values with their standard deviations, and the ends of the interval of 95 %
    for all of them, wider by what the weights of so many samples a pixel may be wrong by."""
    relmse = max(estimates[0][0], 0.0)
    more = _WEIGHTS / math.sqrt(samples) * relmse
    low = max(min(value - _SURE * deviation for value, deviation in estimates) - more, 0.0)
    high = max(value + _SURE * deviation for value, deviation in estimates) + more
    return relmse, low, max(high, relmse)


def trimmed_mean(first: np.ndarray, second: np.ndarray) -> float:
    """The mean of two independent estimates of each pixel's error, without the worst pixels. Which these are is decided
    by one estimate, and what the others have by the other."""
    kept = first.size - int(TRIMMED * first.size)
    return float(np.mean([b.ravel()[np.argsort(a, axis=None)[:kept]].mean() for a, b in
                          ((first, second), (second, first))]))
