"""How far the normals of a normal map spread within a texel of its smaller mip levels, which their mean does not tell.

A pixel that covers many texels sees all their normals: a rough surface, though each texel may be a mirror. Olano and
Baker 2010, "LEAN mapping", give such a surface a distribution whose covariance is that of the texels' slopes; with
alpha^2 = 2 sigma^2 (Walter et al. 2007) it is added to alpha^2. One number is kept of it, 2 sqrt(det): what an
isotropic lobe gains that is as dense along the normal as the lobe with all of the covariance. Grooves, whose
determinant is 0, would need a lobe that is stretched.
"""

from __future__ import annotations

from itertools import pairwise

import numpy as np

from .mip_levels import means_of_four

_BAND = 64  # rows per step, so that intermediate arrays stay in the processor's cache


def with_spread(levels: list[np.ndarray]) -> list[np.ndarray]:
    """The mip levels of a normal map, (H, W, 3) uint8 or uint16, with a fourth channel: 1 - spread.

    spread = sqrt(2 sqrt(det(covariance of x and y))), with x and y in [-1, 1]. It is 0 in the first level, and at most
    1 for unit normals. A texture without the channel reads as 1, no spread.
    """
    full = np.iinfo(levels[0].dtype).max
    with_alpha = [_joined(levels[0], full)]
    covariance: list[np.ndarray] = []
    for larger, smaller in pairwise(levels):
        among = [part * np.float32(4 / full**2) for part in _covariance(larger)]
        covariance = [means_of_four(part) + rest for part, rest in zip(covariance, among, strict=True)
                      ] if covariance else among
        xx, yy, xy = (part[..., 0] for part in covariance)
        spread = np.sqrt(2 * np.sqrt(np.maximum(xx * yy - xy * xy, 0)))
        with_alpha.append(_joined(smaller, np.rint((1 - np.minimum(spread, 1)) * full)))
    return with_alpha


def _covariance(level: np.ndarray) -> list[np.ndarray]:
    """The covariances xx, yy and xy of the texels that each texel of the next level stands for, (H, W, 1) each."""
    height, width = level.shape[:2]
    if height % 2 or width % 2:
        x, y = (level[..., k:k + 1].astype(np.float32) for k in (0, 1))
        mean_x, mean_y = means_of_four(x), means_of_four(y)
        return [means_of_four(x * x) - mean_x * mean_x, means_of_four(y * y) - mean_y * mean_y,
                means_of_four(x * y) - mean_x * mean_y]
    bands = []
    for top in range(0, height, _BAND):
        (a, b, c), (d, e, f) = (_differences(level[top:top + _BAND, :, k].astype(np.float32)) for k in (0, 1))
        bands.append((a * a + b * b + c * c, d * d + e * e + f * f, a * d + b * e + c * f))
    return [np.concatenate(parts)[..., None] for parts in zip(*bands, strict=True)]


def _differences(plane: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Of each four texels of (H, W): three numbers, the sum of whose squares is the variance (Haar's wavelets)."""
    sums, differences = plane[0::2] + plane[1::2], plane[0::2] - plane[1::2]
    sums *= np.float32(0.25)
    differences *= np.float32(0.25)
    left, right = differences[:, 0::2], differences[:, 1::2]
    return sums[:, 0::2] - sums[:, 1::2], left + right, left - right


def _joined(level: np.ndarray, alpha: np.ndarray | int) -> np.ndarray:
    joined = np.empty((*level.shape[:2], 4), level.dtype)
    for k in range(3):  # numpy is several times slower if the last axis is short
        joined[..., k] = level[..., k]
    joined[..., 3] = alpha
    return joined
