"""Which pixels get the next samples: those around which the picture is noisiest.

The relative error of a picture is least if each pixel has samples in proportion to the standard deviation of one of
them (Neyman 1934). It is estimated from the pixels around, and never from the pixel itself: what decided by its own
samples would keep on sampling a pixel that has met a rare light, and so dilute it, while it leaves others that have
missed that light as they are. The picture would be too dark. A pixel's samples and those of its neighbours have nothing
in common, so the mean has no bias.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ...image.neighbours import EPSILON, LARGEST

REACH = 3
"""The pixels around are those of a square of 2 REACH + 1 pixels."""
DEFENSIVE = 1.0
"""How often the mean deviation is added to that of each pixel: those around may not know of its noise."""
MOST_GROWTH = 16
"""Factor by which a round increases the samples of a pixel at most."""
_LARGEST = 1e30
_MOST_STEPS, _CLOSE = 60, 1e-9
"""When `allocate` ends: after so many steps, or so near to the total."""


def deviation_around(total: NDArray, squares: NDArray) -> NDArray[np.float64]:
    """The relative standard deviation of one sample, (H, W), as the pixels around each tell it, from the sums of a film
    (`viewer.trace.paths.film.Film.read_sums`), and the mean of the picture.

    It is the mean deviation over (mean^2 + 0.01)^(1/2), averaged over the channels. The mean deviation and not the root
    of the mean variance: one lucky sample counts less in it. Pixels without two samples tell nothing; where there are
    no others around, it is twice the mean. Where no pixel has others, as in a picture of one, it is 1.
    """
    dtype = np.result_type(total, np.float32)
    known = total[..., 3] >= 2
    count = np.where(known, total[..., 3], 2).astype(dtype)
    others = around(known.astype(dtype), REACH)
    is_told = others > 0
    if not is_told.any():
        return np.ones(known.shape)
    relative = np.zeros(known.shape, dtype)
    for channel in range(3):  # planes fit into caches
        mean = np.where(known, np.clip(total[..., channel] / count, 0, LARGEST), 0)
        variance = np.where(known, squares[..., channel] / count - mean**2, 0) * (count / (count - 1))
        deviation = np.sqrt(np.clip(np.nan_to_num(variance), 0, _LARGEST))
        mean_around = around(mean, REACH) / np.maximum(others, 1)
        relative += around(deviation, REACH) / np.maximum(others, 1) / np.sqrt(mean_around**2 + dtype.type(EPSILON)) / 3
    mean_of_all = relative.sum(dtype=np.float64) / np.count_nonzero(is_told)
    return np.where(is_told, relative, 2 * mean_of_all) + DEFENSIVE * mean_of_all


def around(values: NDArray, reach: int) -> NDArray:
    """The sums of the values, (H, W), in the square of 2 reach + 1 pixels about each, without its own.

    It is not the sum of all less the pixel's own: beside a sun that would lose what is dark."""
    beside = np.zeros_like(values)
    for step in range(1, reach + 1):
        beside[:, step:] += values[:, :-step]
        beside[:, :-step] += values[:, step:]
    rows = beside + values
    for step in range(1, reach + 1):
        beside[step:] += rows[:-step]
        beside[:-step] += rows[step:]
    return beside


def allocate(deviation: NDArray, given: NDArray, most: NDArray, total: float, step: int) -> NDArray[np.int64]:
    """The number of samples that each pixel gets now, (H, W), multiples of `step`.

    With those that are `given` they are in proportion to `deviation`, between `given` and `most`, and `total` of all
    pixels together, or as near to it as `most` allows. What is left of a step goes to the next pixel.
    """
    steps = (_in_proportion(deviation, given, np.maximum(given, most), total) - given) / step
    whole = np.floor(steps.cumsum() + 1e-3).reshape(steps.shape)  # the sums of equal numbers are not quite equal
    return (np.diff(whole.ravel(), prepend=0.0).reshape(steps.shape) * step).astype(np.int64)


def _in_proportion(deviation: NDArray, given: NDArray, most: NDArray, total: float) -> NDArray:
    """What `allocate` shares out: clip(scale deviation, given, most), with the scale for which the sum is `total`.

    The sum is linear in the scale between those at which a pixel reaches a bound, so that steps of Newton find the
    scale; one that leads out of what it is known to lie between is replaced by bisection."""
    if total <= given.sum():
        return given
    if total >= most.sum():
        return most
    low, high = 0.0, float((most[deviation > 0] / deviation[deviation > 0]).max())
    scale = total / deviation.sum()
    for _ in range(_MOST_STEPS):
        wanted = scale * deviation
        samples = np.clip(wanted, given, most)
        excess = float(samples.sum()) - total
        if abs(excess) <= _CLOSE * total:
            break
        low, high = (low, scale) if excess > 0 else (scale, high)
        slope = float(deviation[samples == wanted].sum())
        scale = scale - excess / slope if slope > 0 else high
        if not low < scale < high:
            scale = (low + high) / 2
    return samples
