"""How far the normals of a normal map spread within a texel of its smaller mip levels, which their mean does not tell.

A pixel that covers many texels sees all their normals: a rough surface, though each texel may be a mirror. Olano and
Baker 2010, "LEAN mapping", give such a surface a distribution whose covariance is that of the texels' slopes; with
alpha^2 = 2 sigma^2 (Walter et al. 2007) it is added to alpha^2. One number is kept of it, 2 sqrt(det): what an
isotropic lobe gains that is as dense along the normal as the lobe with all of the covariance. Grooves, whose
determinant is 0, need a lobe that is stretched, and maps that are full of them keep all of the covariance. The texels
of each level are rounded: a number between two codes has a variance of up to a quarter of a step squared, in each
direction. It is taken off, or the product of steep grooves and that were rough.
"""

from __future__ import annotations

from itertools import pairwise

import numpy as np

from .mip_levels import even_bands, has_even_sides, means_of_four

_GROOVED_LEVEL = 3  # of the levels, that which tells whether a map is full of grooves
_FEW_TEXELS = 16  # a level with fewer tells nothing


def with_spread(levels: list[np.ndarray]) -> list[np.ndarray]:
    """The mip levels of a normal map, (H, W, 3) uint8 or uint16, with a fourth channel: 1 - spread.

    spread = sqrt(2 sqrt(det(covariance of x and y, less that of rounding))), with x and y in [-1, 1]. It is 0 in the
    first level, and at most 1 for unit normals. A texture without the channel reads as 1, no spread.

    Maps full of grooves have three more channels: the elements xx, yy and xy of the symmetric square root of that
    covariance, the last as 128 / 255 + xy.
    """
    full = np.iinfo(levels[0].dtype).max
    with_alpha = [np.empty((*level.shape[:2], 4), level.dtype) for level in levels]
    for rows in even_bands(levels[0]):
        _join(with_alpha[0][rows], levels[0][rows], full)
    before: np.ndarray | None = None
    covariances: list[np.ndarray] = []
    rounded = np.float32(1 / full**2)  # the quarter, of steps of 2 / full
    for (larger, smaller), out in zip(pairwise(levels), with_alpha[1:], strict=True):
        covariance = np.empty((3, *smaller.shape[:2]), np.float32)
        for rows in even_bands(larger):
            half = slice(rows.start // 2, max(rows.stop // 2, 1))
            here = covariance[:, half]
            _among(larger[rows], np.float32(4 / full**2), here)
            np.maximum(here[:2] - rounded, 0, out=here[:2])
            if before is not None:
                here += _means(before[:, rows])
            xx, yy, xy = here
            spread = np.sqrt(2 * np.sqrt(np.maximum(xx * yy - xy * xy, 0)))
            _join(out[half], smaller[half], np.rint((1 - np.minimum(spread, 1)) * full))
        before = covariance
        covariances.append(covariance)
    if len(covariances) >= _GROOVED_LEVEL and _are_grooves(covariances[_GROOVED_LEVEL - 1]):
        covariances.insert(0, np.zeros((3, *levels[0].shape[:2]), np.float32))
        return [np.concatenate([level, _root(covariance, full).astype(level.dtype)], axis=2)
                for level, covariance in zip(with_alpha, covariances, strict=True)]
    return with_alpha


def _are_grooves(covariance: np.ndarray) -> bool:
    """Whether half of the texels widen a lobe to an alpha above 0.3 in one direction, and to a third of it across.

    A map of which the level has few texels is a mere swatch, and chance makes grooves in it.
    """
    xx, yy, xy = covariance
    mean, half = (xx + yy) / 2, np.hypot((xx - yy) / 2, xy)
    are_grooves = (2 * (mean + half) > 0.3**2) & (9 * (mean - half) < mean + half)
    return xx.size >= _FEW_TEXELS and bool(are_grooves.mean() > 0.5)


def _root(covariance: np.ndarray, full: int) -> np.ndarray:
    """The symmetric square root of (3, H, W) covariances, as (H, W, 3) codes of texels.

    By Cayley and Hamilton sqrt(C) = (C + sqrt(det C) I) / sqrt(trace C + 2 sqrt(det C)).
    """
    xx, yy, xy = covariance
    det = np.sqrt(np.maximum(xx * yy - xy * xy, 0))
    scale = full / np.sqrt(np.maximum(xx + yy + 2 * det, 1e-12))
    codes = np.stack([(xx + det) * scale, (yy + det) * scale, xy * scale + 128 * (full // 255)], axis=2)
    return np.clip(np.rint(codes), 0, full)


def _among(level: np.ndarray, scale: np.float32, out: np.ndarray) -> None:
    """The covariances xx, yy and xy of the texels that each texel of the next level stands for, times `scale`."""
    if has_even_sides(level):
        _among_four(level, out)
        out *= scale / 16
        return
    x, y = np.moveaxis(level[..., :2], 2, 0).astype(np.float32)
    xx, yy, xy, x, y = _means(np.stack([x * x, y * y, x * y, x, y]))
    out[:] = xx - x * x, yy - y * y, xy - x * y
    out *= scale


def _among_four(level: np.ndarray, out: np.ndarray) -> None:
    """16 times the covariances of each four texels: of three numbers each (Haar's wavelets), products are summed.

    numpy is several times slower if it takes every second element, so two neighbours are read as one number.
    """
    bits = 8 * level.dtype.itemsize
    pairs = np.stack([level[..., 0], level[..., 1]]).view(f"u{bits // 4}")
    low, high = (part.view(f"i{bits // 4}") for part in (pairs & np.iinfo(level.dtype).max, pairs >> bits))
    sums, differences = low + high, low - high
    haar = np.empty((3, 2, *out.shape[1:]), np.float32)
    haar[0] = sums[:, 0::2] - sums[:, 1::2]
    haar[1] = differences[:, 0::2] + differences[:, 1::2]
    haar[2] = differences[:, 0::2] - differences[:, 1::2]
    for product, i, j in zip(out, (0, 1, 0), (0, 1, 1), strict=True):
        np.multiply(haar[0, i], haar[0, j], out=product)
        product += haar[1, i] * haar[1, j]
        product += haar[2, i] * haar[2, j]


def _means(planes: np.ndarray) -> np.ndarray:
    """(K, H, W) float32 at half the height and width, rounded down."""
    if planes.shape[1] % 2 or planes.shape[2] % 2:
        return np.moveaxis(means_of_four(np.moveaxis(planes, 0, 2)), 2, 0)
    pairs = planes[..., 0::2] + planes[..., 1::2]
    return (pairs[:, 0::2] + pairs[:, 1::2]) / 4


def _join(out: np.ndarray, level: np.ndarray, alpha: np.ndarray | int) -> None:
    for k in range(3):  # numpy is several times slower if the last axis is short
        out[..., k] = level[..., k]
    out[..., 3] = alpha
