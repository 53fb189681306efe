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

from ...image.neighbours import EPSILON, box

REACH = 3
"""The pixels around are those of a square of 2 REACH + 1 pixels."""
DEFENSIVE = 1.0
"""How often the mean deviation is added to that of each pixel: those around may not know of its noise."""
MOST_GROWTH = 16
"""Factor by which a round increases the samples of a pixel at most."""
_LARGEST = 1e30


def deviation_around(total: NDArray, squares: NDArray) -> NDArray[np.float64]:
    """The relative standard deviation of one sample, (H, W), as the pixels around each tell it, from the sums of a film
    (`viewer.trace.paths.film.Film.read_sums`), and the mean of the picture.

    It is the mean deviation over (mean^2 + 0.01)^(1/2), averaged over the channels. The mean deviation and not the root
    of the mean variance: one lucky sample counts less in it. Pixels without two samples tell nothing; where there are
    no others around, it is twice the mean. Where no pixel has others, as in a picture of one, it is 1.
    """
    known = total[..., 3:] >= 2
    count = np.where(known, total[..., 3:], 2).astype(np.float64)
    mean = np.where(known, total[..., :3] / count, 0.0)
    variance = np.where(known, (squares[..., :3] / count - mean**2) * (count / (count - 1)), 0.0)
    deviation = np.sqrt(np.clip(np.nan_to_num(variance), 0.0, _LARGEST))
    share = np.maximum(around(known, REACH), 1e-30)
    relative = (around(deviation, REACH) / share / np.sqrt((around(mean, REACH) / share)**2 + EPSILON)).mean(axis=-1)
    is_told = share[..., 0] > 1e-30
    if not is_told.any():
        return np.ones(is_told.shape)
    mean_of_all = relative.sum() / np.count_nonzero(is_told)
    return np.where(is_told, relative, 2 * mean_of_all) + DEFENSIVE * mean_of_all


def around(values: NDArray, reach: int) -> NDArray[np.float64]:
    """The mean of the values, (H, W) or (H, W, C), in the square of 2 reach + 1 pixels about each, without its own; 0
    in a picture of one pixel."""
    values = values.astype(np.float64)
    sides = (np.arange(side) for side in values.shape[:2])
    rows, columns = (np.minimum(k + reach, len(k) - 1) - np.maximum(k - reach, 0) + 1 for k in sides)
    count = np.outer(rows, columns).reshape(*values.shape[:2], *[1] * (values.ndim - 2))
    return np.maximum(box(values, reach) * count - values, 0.0) / np.maximum(count - 1, 1)


def allocate(deviation: NDArray, given: NDArray, most: NDArray, total: float, step: int) -> NDArray[np.int64]:
    """The number of samples that each pixel gets now, (H, W), multiples of `step`.

    With those that are `given` they are in proportion to `deviation`, between `given` and `most`, and `total` of all
    pixels together, or as near to it as `most` allows. What is left of a step goes to the next pixel.
    """
    most = np.maximum(given, most)
    low, high = 0.0, float((most[deviation > 0] / deviation[deviation > 0]).max(initial=0.0))
    for _ in range(60):
        middle = (low + high) / 2
        too_many = np.clip(middle * deviation, given, most).sum() > total
        low, high = (low, middle) if too_many else (middle, high)
    steps = (np.clip(low * deviation, given, most) - given) / step
    whole = np.floor(steps.cumsum() + 1e-3).reshape(steps.shape)  # the sums of equal numbers are not quite equal
    return (np.diff(whole.ravel(), prepend=0.0).reshape(steps.shape) * step).astype(np.int64)
