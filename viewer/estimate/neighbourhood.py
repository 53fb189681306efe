"""Estimates of radiance from noisy pictures and a picture without noise, each in its neighbourhood.

Pictures are linear radiance, (H, W, 3) float32.
"""

from __future__ import annotations

import numpy as np

from ..image.neighbours import EPSILON, box, luminance, smooth

_GUIDE_REACH = 3
_SHARPNESS = 4.0
"""A neighbour whose radiance differs from that of a pixel by one part in _SHARPNESS counts 1/e."""
_DARK = 0.05
"""Below this radiance, pixels are alike."""


def pulled(base: np.ndarray, other: np.ndarray, noise: np.ndarray, level: np.ndarray) -> np.ndarray:
    """The weighted mean of `base` and `other`, of which `noise` is the variance, that has the least relative error in
    each neighbourhood; `level` says how bright it is there.

    base + a (other - base), where a = 1 - noise / energy is the Wiener filter: energy is the mean over a neighbourhood
    of (other - base)^2, which is the squared error of the base plus the noise of the other. Dark pixels count by their
    relative error, so that a bright one beside them does not decide for them.
    """
    bright = luminance(level)
    scale = 1 / (np.minimum(bright, smooth(smooth(bright, 1), 2)) ** 2 + EPSILON)
    energy = box((scale * (other - base) ** 2).mean(axis=-1, keepdims=True))
    share = box((scale * noise).mean(axis=-1, keepdims=True)) / np.maximum(energy, 1e-12)
    return base + np.clip(1 - share, 0, 1) * (other - base)


def noise_of(groups: np.ndarray) -> np.ndarray:
    """The variance of the mean of independent pictures (G, H, W, 3)."""
    return groups.var(axis=0, ddof=1) / len(groups)


def guided(picture: np.ndarray, guide: np.ndarray) -> np.ndarray:
    """`picture`, averaged over those pixels nearby in which `guide`, a picture without noise, looks the same.

    The cross-bilateral filter (Petschnigg et al. 2004; Eisemann and Durand 2004), by the logarithm of the guide.
    """
    reach, (height, width) = _GUIDE_REACH, picture.shape[:2]
    feature = _SHARPNESS * np.log(np.maximum(guide, 0) + _DARK).astype(np.float32)
    around, features = (np.pad(each, ((reach, reach), (reach, reach), (0, 0)), mode="edge")
                        for each in (picture.astype(np.float32), feature))
    total, weights = np.zeros_like(picture, np.float32), np.zeros((height, width, 1), np.float32)
    for y in range(2 * reach + 1):
        for x in range(2 * reach + 1):
            part = slice(y, y + height), slice(x, x + width)
            apart = ((y - reach) ** 2 + (x - reach) ** 2) / (reach**2 / 2)
            weight = np.exp(-np.square(features[part] - feature).sum(axis=-1, keepdims=True) - apart)
            total += weight * around[part]
            weights += weight
    return total / weights
