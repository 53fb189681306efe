"""The error of a picture of the raster, from path-traced pictures of few samples and without a reference.

Let R be the raster's picture, T the right one, and P_i independent path-traced ones, whose expectation is T. Then
(R - P_i)(R - P_j) for i != j has the expectation (R - T)^2, whatever the noise of paths is: no variance is subtracted.
The mean over all pairs is a U-statistic (Hoeffding 1948):

    u = ((sum d_i)^2 - sum d_i^2) / (G (G - 1)),   d_i = R - P_i

relMSE divides it by T^2 + 0.01, which only noisy paths tell. The estimate is the mean of w u, w = 1 / (C^2 + 0.01),
where C is the mean of the paths, filtered (`neighbourhood`); C becomes T with time. The interval holds all of

    the estimate +- 2 standard deviations (jackknife over the groups, each pixel for itself: Efron and Stein 1981),
    the same where C is the mean of the paths alone: often too small where it is noisy, so that the error is too large,
    the same where C is the mixture of R and the paths with the least error: too small where R is too dark,
    the same where C is larger by what n samples a pixel may have missed of a raster that is brighter. If none of n
      samples has met something, its share of the pixel is below 3 / n, with 95 % (rule of three: Hanley and
      Lippman-Hand 1983); the raster has seen it by one of four samples or more, so that it adds up to 12 / n of R,
    the upper end of the first two with all the samples there could be, where more of them make the error larger: bright
      samples are rare, and those there are stand in C beside pixels that they do not light, which then count too
      little. What is missing is taken to fall with the root of n, as that of heavy tails does, so that it follows from
      the mean of both halves of the groups (Richardson 1911; of estimates with less bias: Quenouille 1956).

and 0.4 / sqrt(n) of the estimate more on either side, for what C is wrong by.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field

import numpy as np

from ..image.estimated_error import EstimatedError, estimated_error
from ..image.image import Image
from ..image.magma import magma
from ..image.neighbours import LARGEST, box, smooth
from .neighbourhood import EPSILON, guided, noise_of, pulled
from .pairs import TRIMMED, interval, squared_error, trimmed_mean

_TO_THE_END = 1 / (math.sqrt(2) - 1)
"""Times what b / sqrt(n) loses from n / 2 samples to n: what is left of it then."""
_MISSED = 12.0
"""So that the interval holds the truth in 95 % of the cases of benchmarks/tell_error.py."""


@dataclass(frozen=True, eq=False)
class RasterError:
    """The error over the pixels that show the model, with the ends of the 95 % interval of relMSE."""

    relmse: float
    """The mean of (x - truth)^2 / (truth^2 + 0.01), estimated; not below 0."""
    low: float
    high: float
    trimmed: float
    """The same without the pixels of the largest errors, TRIMMED of all; not more than `relmse`."""
    brightness: float
    """Share of relMSE that one factor for the whole picture would remove."""
    samples: float
    """Path-traced ones a pixel."""
    seconds: float
    map: np.ndarray = field(repr=False)
    """The relative error in the neighbourhood of each pixel, (H, W) float32; 0 beside the model."""
    notes: tuple[str, ...] = ()
    """What of it is there on purpose, and what paths do not find."""

    @property
    def relative(self) -> float:
        return math.sqrt(self.relmse)

    def to_json(self) -> EstimatedError:
        return estimated_error(self.relmse, self.samples, self.seconds, (self.low, self.high), self.trimmed,
                               self.brightness, self.notes)

    @property
    def interval(self) -> str:
        """The interval for the user, of which no error may be a part."""
        high = percent(math.sqrt(self.high))
        return f"{percent(math.sqrt(self.low))} to {high} %" if self.low > 0 else f"at most {high} %"

    def __str__(self) -> str:
        more = "" if self.low > 0 or self.high == 0 else "; more seconds tell it better"
        shared = percent(math.sqrt(self.relmse * (1 - self.brightness)))
        rest = f"{percent(math.sqrt(self.trimmed))} % without the worst {percent(TRIMMED)} % of the pixels"
        return (f"{percent(self.relative)} % from the truth (95 % sure: {self.interval}{more}); "
                f"{shared} % with the right brightness, {rest}")

    def map_image(self) -> Image:
        """The map as a picture: `linear` is the relative error, and displayed it is black at 0 and pale at 100 %."""
        return shown_map(self.map)


def shown_map(relative: np.ndarray) -> Image:
    """As `RasterError.map_image`, of a map (H, W)."""
    grey = np.repeat(relative[..., None], 3, axis=-1).astype(np.float32)
    alpha = np.ones_like(grey[..., :1])
    displayed = np.concatenate([magma(np.minimum(relative, 1)), np.full_like(alpha, 255, np.uint8)], axis=-1)
    return Image(np.concatenate([grey, alpha], axis=-1), displayed)


def raster_error(raster: np.ndarray, groups: np.ndarray, mask: np.ndarray, samples: float, seconds: float,
                 notes: tuple[str, ...] = (), left_out: float = 0.0) -> RasterError:
    """The error of `raster`, linear radiance (H, W, 3 or 4), by independent path-traced pictures of few samples.

    These are a part of the picture's pixels where `left_out` is the share of the others. `groups` (G, H, W, 3), G of 4
    or more; errors are taken where `mask` (H, W) bool is true, which it is somewhere.
    Pixels of the raster that are not finite count as black, and radiance above LARGEST as that.
    """
    picture = raster[..., :3].astype(np.float32)
    picture = np.where(np.isfinite(picture).all(axis=-1, keepdims=True), picture, np.float32(0))
    picture, groups = np.minimum(picture, LARGEST), np.minimum(groups, LARGEST)
    weights = _weights(picture, groups, mask, samples)
    apart = (picture - groups)[:, mask].astype(np.float64)
    estimates = [_mean_and_deviation(apart, weight, left_out) for weight in weights]
    halves = [_weights(picture, groups[k::2], mask, samples / 2) for k in range(2)]
    for which, (value, deviation) in enumerate(estimates[:2]):
        fewer = np.mean([(half[which] * squared_error(apart[k::2])).mean() for k, half in enumerate(halves)])
        estimates.append((value + _TO_THE_END * max(value - float(fewer), 0.0), deviation))
    relmse, low, high = interval(estimates, samples)
    trimmed = min(max(_trimmed(apart, weights[0]), 0.0), relmse)
    share = _brightness(picture[mask].astype(np.float64), groups[:, mask].astype(np.float64), weights[0])
    errors = np.zeros(picture.shape, np.float32)
    errors[mask] = weights[0] * squared_error(apart)
    return RasterError(relmse, low, high, trimmed, share, samples, seconds, _map(errors, mask), notes)


def _weights(picture: np.ndarray, groups: np.ndarray, mask: np.ndarray, samples: float) -> list[np.ndarray]:
    """What squared errors are multiplied by where `mask` is true, (N, 3) float64, by each of the levels C."""
    mean, noise = groups.mean(axis=0), noise_of(groups)
    level = np.maximum(pulled(guided(mean, picture), mean, noise, mean), 0)
    missed = min(_MISSED / samples, 1.0) * np.maximum(picture - level, 0)
    levels = level, mean, pulled(picture, mean, noise, mean), level + missed
    return [1 / (np.maximum(each, 0)[mask].astype(np.float64) ** 2 + EPSILON) for each in levels]


def _mean_and_deviation(apart: np.ndarray, weight: np.ndarray, left_out: float) -> tuple[float, float]:
    """The mean over pixels (G, N, 3) of weight * u, and its standard deviation by a jackknife in each pixel.

    The noise of each pixel has nothing to do with that of another, so that their variances add up. Where pixels are
    left out, their mean differs from that of the others by chance, too (the finite population correction).
    """
    count = len(apart)
    total, squares = apart.sum(axis=0), (apart**2).sum(axis=0)
    whole = (weight * (total**2 - squares)).mean(axis=-1) / (count * (count - 1))
    variance = 0.0
    for one in apart:
        rest = (weight * ((total - one) ** 2 - squares + one**2)).mean(axis=-1) / ((count - 1) * (count - 2))
        variance += float(((rest - whole) ** 2).sum()) * (count - 1) / count
    variance += left_out * float(whole.var()) * len(whole)
    return float(whole.mean()), math.sqrt(variance) / len(whole)


def _trimmed(apart: np.ndarray, weight: np.ndarray) -> float:
    return trimmed_mean(*((weight * squared_error(apart[k::2])).mean(axis=-1) for k in range(2)))


def _brightness(raster: np.ndarray, groups: np.ndarray, weight: np.ndarray) -> float:
    """The share of sum w (R - T)^2 that is gone for the best s in sum w (s R - T)^2: with <a, b> = sum w a b,
    the least is <T, T> - <R, T>^2 / <R, R>. <T, T> is the mean over pairs of groups."""
    own, with_truth = (weight * raster**2).sum(), (weight * raster * groups.mean(axis=0)).sum()
    truth = (weight * squared_error(groups)).sum()
    whole, best = own - 2 * with_truth + truth, truth - with_truth**2 / max(own, 1e-12)
    return float(np.clip(1 - best / whole, 0, 1)) if whole > 0 else 0.0


def _map(errors: np.ndarray, mask: np.ndarray) -> np.ndarray:
    """The root of the mean of `errors`, (H, W, 3), around each pixel of the mask."""
    inside = mask[..., None].astype(np.float32)
    around, count = (box(smooth(values, 1)) for values in (errors.mean(axis=-1, keepdims=True), inside))
    return np.where(mask, np.sqrt(np.maximum(around / np.maximum(count, 1e-6), 0)[..., 0]), 0).astype(np.float32)


def percent(share: float) -> str:
    """Of 100, to two digits."""
    value = 100 * share
    return f"{value:.2g}" if value < 99.5 else f"{value:.0f}"
