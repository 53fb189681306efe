"""The best picture that two halves of the samples and pictures with less noise give together.

A pixel that is filtered more has less noise and more bias, and which is better differs from place to place. Neither has
to be known. Let A and B be means of independent samples, whose expectation T is the truth, and let b and c be two
pictures made of A (b' and c' of B in the same way). The b + a (c - b) with the least squared error has

    a = E[(c - b) (T - b)] / E[(c - b)^2]

B stands for T, since its noise has nothing to do with that of b and c, and A for what is made of B. So a is measured
in each neighbourhood by products, without a model of the noise or of the bias. (Rousselle et al. 2012 choose filters by
two such halves; the weight is that of a Wiener filter.) Pictures of all samples have less noise than those of a half,
which is allowed for: covariances fall with the samples, and (b - b') (c - c') tells them.

What a neighbourhood tells has noise, too. Where steps are mostly noise, a is therefore taken for a little smaller.

From the picture with the most bias to the samples themselves, one after the other is mixed in in this way. With more
samples, a of the last step becomes 1 wherever the others are wrong: the picture becomes that of the samples.

Bright samples are rarer than dark ones, and where they are a is smaller, so that a little light is lost. What both
halves have lost comes back at the end: what only one has is noise.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ...image.neighbours import EPSILON, box, luminance, smooth, surroundings

RADIUS = 1
"""Of the squares in which samples are fitted, in pixels."""
_REACH = 3
"""a is measured by means over (2 _REACH + 1)^2 pixels."""
_DOUBT = 0.35
"""Standard deviations by which a gain is taken for less, so that noise is not followed; times the share of noise in
what a step would change, for without noise nothing is to be doubted."""
_SLOPE = 2.0
"""Most that a fit multiplies a guide by."""
_RIDGE = 1e-3
"""Of the squared level, added to the variance of the guide: less than this is no texture."""
_SPIKE, _FAINT = 10.0, 0.02
"""Fits leave out what of a pixel is more than so many times as bright as those around it, and as this radiance."""
_SPREAD = 1, 2, 4
"""Steps of the splines that spread lost light: 14 pixels to each side."""
_BLACK = 1e-6
"""Radiance below which light is not given back."""

Halves = tuple[np.ndarray, np.ndarray]
"""The same picture of each half of the samples, (H, W, 3) float32."""


def combined(samples: Halves, guides: Sequence[Halves], share: np.ndarray | float = 0.5,
             gets_light: np.ndarray | bool = True) -> np.ndarray:
    """The picture of both halves, (H, W, 3) float32, by `samples`, which have no bias, and by `guides` with less noise,
    from the most bias to the least.

    Each picture of a pair is made of its own half of the samples alone, or of none. `share` is that of the first half
    in the number of samples, a number or (H, W, 1), and `gets_light` says where lost light may come back. All values
    are finite, and those of guides not negative.
    """
    fit = _fitted(_calm(samples[0]), guides[0][0]), _fitted(_calm(samples[1]), guides[0][1])
    scale = _scale(share * samples[0] + (1 - share) * samples[1])
    best = guides[0]
    for other in (*guides[1:], fit, samples):
        best = _mixed(best, other, samples, share, scale)
    picture = np.maximum(share * best[0] + (1 - share) * best[1], 0)
    return picture * np.maximum(1 + np.where(gets_light, _lost(picture, best, samples), 0), 0)


def _lost(picture: np.ndarray, best: Halves, samples: Halves) -> np.ndarray:
    """The light that both of `best` have less than the samples, as a part of `picture`.

    What a pixel has lost is spread over those around it in proportion to their light, so that what is dark stays dark;
    but for single bright pixels.
    """
    around = np.maximum(_spread(picture), _BLACK)
    first, second = (_spread((_calm(half) - np.minimum(mixed, _most(half))) / around)
                     for half, mixed in zip(samples, best, strict=True))
    return np.where(first * second > 0, np.sign(first) * np.minimum(np.abs(first), np.abs(second)), 0)


def _spread(picture: np.ndarray) -> np.ndarray:
    for step in _SPREAD:
        picture = smooth(picture, step)
    return picture


def _mixed(base: Halves, other: Halves, truth: Halves, share: np.ndarray | float, scale: np.ndarray) -> Halves:
    """b + a (c - b) with the least error that the halves tell, each for its neighbourhood."""
    first, second = other[0] - base[0], other[1] - base[1]
    both = share * (1 - share)
    gain = (share * first * (truth[1] - base[0]) + (1 - share) * second * (truth[0] - base[1])
            + both * (first - second) * (base[0] - base[1]))
    noise = both * (first - second) ** 2
    each, size, noise = ((scale * error).mean(axis=-1, keepdims=True, dtype=np.float64)
                         for error in (gain, share * first**2 + (1 - share) * second**2, noise))
    gains, size, noise = _around(each), np.maximum(_around(size), 1e-12), _around(noise)
    deviation = np.sqrt(np.maximum(_around(each**2) - gains**2, 0)) / (2 * _REACH + 1)
    doubt = _DOUBT * np.minimum(2 * noise / size, 1) * deviation
    a = smooth(np.clip((gains - doubt) / np.maximum(size - noise, 1e-12), 0, 1).astype(np.float32), 1)
    return base[0] + a * first, base[1] + a * second


def _fitted(picture: np.ndarray, guide: np.ndarray) -> np.ndarray:
    """`picture` as s guide + t, with the s and t that fit best in squares around each pixel (the guided filter of He et
    al. 2010), for each channel.

    So edges and texture come from the guide, and noise is that of a mean over the square. Where the guide is constant s
    is 1. Dark pixels count by their relative error.
    """
    weight = 1 / (luminance(guide) + np.sqrt(EPSILON)) ** 2
    total = box(weight, RADIUS)

    def mean(values: np.ndarray) -> np.ndarray:
        return box(weight * values, RADIUS) / total

    apart = picture - guide
    level, offset = mean(guide), mean(apart)
    spread = np.maximum(mean(guide**2) - level**2, 0) + _RIDGE * (level**2 + EPSILON)
    slope = np.clip((mean(guide * apart) - level * offset) / spread, -1, _SLOPE - 1)
    return np.maximum(guide + box(slope, RADIUS) * guide + box(offset - slope * level, RADIUS), 0)


def _calm(picture: np.ndarray) -> np.ndarray:
    """Without what makes a pixel far brighter than those around it: a fit would spread it."""
    return np.minimum(picture, _most(picture))


def _most(picture: np.ndarray) -> np.ndarray:
    return _SPIKE * np.maximum(surroundings(picture), _FAINT)


def _scale(picture: np.ndarray) -> np.ndarray:
    """What squared errors are multiplied by. A bright pixel does not decide for the dark ones beside it, nor does a
    single one count little because it is bright."""
    bright = luminance(picture)
    return 1 / (np.minimum(bright, smooth(smooth(bright, 1), 2)) ** 2 + EPSILON)


def _around(errors: np.ndarray) -> np.ndarray:
    """Means over the neighbourhoods in which a is measured."""
    return box(smooth(errors, 1), _REACH)
