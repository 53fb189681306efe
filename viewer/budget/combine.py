"""The best combination of a raster picture and path-traced samples, and its error, estimated from these samples.

Let P_g be independent path-traced pictures, whose expectation is the right picture T, and M_g a picture that was made
without P_g. Of M, the mean of the M_g, the squared error is M^2 - 2 M T + T^2. Its estimate in each pixel,

    e = M^2 - 2 mean of M_g P_g + mean over i != j of P_i P_j,

has the error's expectation, whatever the M_g are, since nothing is multiplied by its own noise. With d_g = P_g - M that
is the mean of d_i d_j less twice that of (M_g - M) d_g, which loses no digits. A picture of the raster is the case that
all M_g are equal; the mean of the paths is that in which each is the mean of the others.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, field

import numpy as np

from ..estimate.pairs import interval, squared_error, trimmed_mean
from ..image.estimated_error import EstimatedError, estimated_error
from ..image.neighbours import EPSILON, LARGEST, smooth, surroundings
from ..trace.denoise.combine import combined

_FEW = 8.0
"""Samples a pixel."""
_SURE = 2.0
"""Standard deviations that noise may have brightened a pixel by."""


@dataclass(frozen=True, eq=False)
class Told:
    """A picture of radiance, (H, W, 3), and its relMSE over all pixels, with the ends of the 95 % interval."""

    picture: np.ndarray = field(repr=False)
    relmse: float
    low: float
    high: float
    trimmed: float
    """The same without the pixels of the largest errors, `pairs.TRIMMED` of all."""
    samples: float

    @property
    def relative(self) -> float:
        return math.sqrt(self.relmse)

    def to_json(self, seconds: float, notes: Sequence[str] = ()) -> EstimatedError:
        return estimated_error(self.relmse, self.samples, seconds, (self.low, self.high), self.trimmed, notes=notes)


class Samples:
    """The sums of four groups of samples, (4, H, W, 3) or with alpha 4, and their numbers, (4, H, W, 1), at least 1."""

    def __init__(self, total: np.ndarray, count: np.ndarray) -> None:
        self._total, self._count = np.minimum(total[..., :3], LARGEST * count), count
        self.means = self._total / count
        self.mean = self._total.sum(axis=0) / count.sum(axis=0)
        self._shows = (total[..., 3:] != 0).any(axis=0) if total.shape[-1] > 3 else True
        """Where a sample has met anything, (H, W, 1), if alpha is known."""
        self.number = float(count.sum(axis=0).mean())
        """Of samples a pixel."""

    def without(self, groups: list[int]) -> tuple[np.ndarray, np.ndarray]:
        """The mean of the other groups' samples, and its variance, of which two groups or more tell."""
        kept = [k for k in range(len(self.means)) if k not in groups]
        count = self._count[kept].sum(axis=0)
        mean = self._total[kept].sum(axis=0) / count
        return mean, (self._count[kept] / count * (self.means[kept] - mean) ** 2).sum(axis=0) / (len(kept) - 1)

    def mixtures(self, raster: np.ndarray) -> np.ndarray:
        """(4, H, W, 3), the k-th a mixture of the raster and paths as that of `--denoise raster`, made without group k:
        each is made of one half of the groups, for the other half."""
        with ThreadPoolExecutor(2) as pool:
            return np.repeat(list(pool.map(lambda known: self._mixture(raster, *known), ((2, 3), (0, 1)))), 2, axis=0)

    def _mixture(self, raster: np.ndarray, first: int, second: int) -> np.ndarray:
        samples = self.means[first], self.means[second]
        share = self._count[first] / (self._count[first] + self._count[second])
        return combined(samples, [(raster, raster)], share, self._shows)

    def levels(self, best: np.ndarray, raster: np.ndarray) -> list[np.ndarray]:
        """What errors may be relative to, by the `best` picture there is.

        First that, smoothed: as long as it is noisy, too small values of it count too much. Then three for the
        interval: the picture itself; the mean of the paths; and the picture where single bright pixels, in which few
        samples have met something that the raster does not show, are what is around them, or what the noise allows.
        """
        soft = smooth(best, 1)
        least = best - _SURE * np.sqrt(self.without([])[1])
        return [best + (soft - best) * _FEW / (_FEW + self.number), best, self.mean,
                np.maximum(np.minimum(best, np.maximum(surroundings(best), raster)), least)]

    def told(self, pictures: np.ndarray, levels: list[np.ndarray]) -> Told:
        """The mean of `pictures`, (4, H, W, 3), the k-th of which is made without group k, and its error, relative to
        the first of `levels`; the interval holds those of all."""
        picture = pictures.mean(axis=0)
        apart, moved = self.means - picture, pictures - picture
        errors = squared_error(apart) - 2 * (moved * apart).mean(axis=0)
        estimates = [_mean_and_deviation(_weighted(errors, each)) for each in levels]
        relmse, low, high = interval(estimates, self.number)
        pairs = [_weighted(apart[k] * apart[k + 2] - moved[k] * apart[k] - moved[k + 2] * apart[k + 2], levels[0])
                 for k in range(2)]
        trimmed = min(max(trimmed_mean(*pairs), 0.0), relmse)
        return Told(picture, relmse, low, high, trimmed, self.number)


def judged(raster: np.ndarray, samples: Samples) -> dict[str, Told]:
    """The mixture of both, the raster's picture and the paths' samples, each with its error."""
    raster = np.minimum(raster, LARGEST)
    mixtures = samples.mixtures(raster)
    levels = samples.levels(mixtures.mean(axis=0), raster)
    return {"mixed": samples.told(mixtures, levels),
            "drawn": samples.told(np.broadcast_to(raster, samples.means.shape), levels),
            "traced": samples.told(np.stack([samples.without([k])[0] for k in range(len(samples.means))]), levels)}


def _weighted(errors: np.ndarray, level: np.ndarray) -> np.ndarray:
    """(H, W)."""
    return (errors / (np.maximum(level, 0) ** 2 + EPSILON)).mean(axis=-1)


def _mean_and_deviation(errors: np.ndarray) -> tuple[float, float]:
    """Of the mean of all pixels. The variance of a pixel is at most the mean of its square, and the noise of one has
    nothing to do with that of another."""
    return float(errors.mean()), float(np.sqrt((errors.astype(np.float64) ** 2).sum())) / errors.size
