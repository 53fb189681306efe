"""Computes mip levels on the CPU with a box filter. sRGB colours are averaged in linear light."""

from __future__ import annotations

from functools import cache

import numpy as np

from .color import linear_to_srgb, srgb_to_linear

_BAND = 64  # rows per step, so that intermediate arrays stay in the processor's cache
_BAND_TEXELS = 1 << 17  # and texels
_FULL = 16383  # linear light 1 as an integer; the sum of four such values fits in 16 bits


def mip_levels(pixels: np.ndarray, srgb: bool = False, covers: bool = False) -> list[np.ndarray]:
    """`pixels`, (H, W, C) uint8, uint16 or float, and all smaller levels down to 1x1.

    Each level has half the width and height of the one before, rounded down. With `srgb` the pixels must be uint8, and
    their first three channels are decoded from sRGB, averaged in linear light and encoded again. With `covers` the last
    of two or four channels is coverage, by which the others are weighted, so that a level times its coverage is the
    mean of what the pixels show (Porter & Duff 1984): what stands below coverage 0, mostly black, is not seen.
    """
    levels, channels = [pixels], pixels.shape[2]
    full = np.iinfo(pixels.dtype).max if pixels.dtype.kind == "u" else 1
    half = _half_of_covered if covers and channels in (2, 4) and (pixels[..., -1] < full).any() else _half
    while max(levels[-1].shape[:2]) > 1:
        levels.append(half(levels[-1], srgb))
    return levels


def without_hidden(levels: list[np.ndarray]) -> list[np.ndarray]:
    """Levels whose last of two or four channels is coverage, with the colours of the next smaller level where it is 0.

    So lookups between texels do not see what is hidden. Gortler et al. 1996, "The Lumigraph", fill holes so.
    """
    if levels[0].shape[2] not in (2, 4):
        return levels
    texel = np.dtype(f"u{levels[0].dtype.itemsize * levels[0].shape[2]}")  # as one number, which is copied at once
    filled = levels[-1:]
    for level in levels[-2::-1]:
        hidden = level[..., -1] == 0
        if hidden.any():
            smaller = filled[0].copy()
            smaller[..., -1] = 0
            level = level.copy()
            texels, parents = level.view(texel)[..., 0], smaller.view(texel)[..., 0]
            rows, columns = (np.minimum(np.arange(side) // 2, most - 1)
                             for side, most in zip(texels.shape, parents.shape, strict=True))
            for top in range(0, len(texels), _BAND):
                band = slice(top, top + _BAND)
                np.copyto(texels[band], parents[rows[band]][:, columns], where=hidden[band])
        filled.insert(0, level)
    return filled


def _half(pixels: np.ndarray, srgb: bool) -> np.ndarray:
    components = pixels.shape[2]
    if pixels.dtype == np.uint8 and has_even_sides(pixels):
        return _half_of_even(pixels, srgb)
    if srgb and components == 4:
        return np.concatenate([_half(pixels[..., :3], True), _half(pixels[..., 3:], False)], axis=2)
    light = _tables()[0].take(pixels).astype(np.float32) / _FULL if srgb else pixels.astype(np.float32)
    means = means_of_four(light)
    if srgb:
        return srgb_codes(means)
    return (np.rint(means) if pixels.dtype.kind == "u" else means).astype(pixels.dtype)


def _half_of_covered(pixels: np.ndarray, srgb: bool) -> np.ndarray:
    """As `_half`; where nothing is covered, colours are averaged as they are."""
    half = _half(pixels, srgb)
    coverage = pixels[..., -1].astype(np.float32)
    covered = means_of_four(coverage[..., None])[..., 0]
    is_seen = covered > 0
    for channel in range(pixels.shape[2] - 1):
        values = pixels[..., channel]
        light = _tables()[0].take(values) if srgb else values
        shown = means_of_four((light * coverage)[..., None])[..., 0][is_seen] / covered[is_seen]
        if srgb:
            half[is_seen, channel] = _tables()[1].take((shown * 4 + 0.5).astype(np.uint16))
        else:
            half[is_seen, channel] = np.rint(shown) if pixels.dtype.kind == "u" else shown
    return half


def srgb_codes(light: np.ndarray) -> np.ndarray:
    """The uint8 codes of linear light in [0, 1], of any shape."""
    return _tables()[1].take((light * (4 * _FULL) + 0.5).astype(np.uint16))


def means_of_four(values: np.ndarray) -> np.ndarray:
    """(H, W, C) floats at half the width and height, rounded down."""
    return _means_of_columns(_means_of_columns(values).swapaxes(0, 1)).swapaxes(0, 1)


def even_bands(level: np.ndarray) -> list[slice]:
    """All rows, an even number at a time; those of odd sides, whose texels are not means of four, all at once."""
    height, width = level.shape[:2]
    step = max(_BAND_TEXELS // width // 2 * 2, 2) if has_even_sides(level) else height
    return [slice(top, min(top + step, height)) for top in range(0, height, step)]


def has_even_sides(level: np.ndarray) -> bool:
    """Whether each texel of the next level is the mean of four."""
    return level.shape[0] % 2 == level.shape[1] % 2 == 0


def _half_of_even(pixels: np.ndarray, srgb: bool) -> np.ndarray:
    """The half level of uint8 pixels with even sides, in integers. Linear light has 14 bits; four pixels sum to 16."""
    height, width, components = pixels.shape
    encode = _tables()[1]
    half = np.empty((height // 2, width // 2, components), np.uint8)
    for top in range(0, height, _BAND):
        band = pixels[top:top + _BAND]
        light = _decode_pairs().take(_by_twos(band), mode="clip").view(np.uint16).reshape(band.shape) if srgb else band
        if srgb and components == 4:
            light[..., 3] = band[..., 3]
        pairs = np.add(light[0::2], light[1::2], dtype=np.uint16)
        sums = np.empty((len(pairs), width // 2, components), np.uint16)
        for channel in range(components):  # numpy is several times slower if the last axis is short
            np.add(pairs[:, 0::2, channel], pairs[:, 1::2, channel], out=sums[..., channel])
        means = encode.take(sums, mode="clip") if srgb else _quarter(sums)
        if srgb and components == 4:
            means[..., 3] = _quarter(sums[..., 3])
        half[top // 2:top // 2 + len(means)] = means
    return half


def _by_twos(band: np.ndarray) -> np.ndarray:
    """Two codes as one number each: a lookup takes as long for two as for one. There is an even number in a row."""
    return np.ascontiguousarray(band).reshape(len(band), -1).view(np.uint16)


def _quarter(sums: np.ndarray) -> np.ndarray:
    """A quarter of `sums`, in place, with halves rounded to even.

    If halves were always rounded up, the last levels of a normal map would be off by more than one code value.
    """
    odd = sums >> 2
    odd &= 1
    sums += odd
    sums += 1
    sums >>= 2
    return sums


def _means_of_columns(pixels: np.ndarray) -> np.ndarray:
    """Half as many columns, rounded down. If their number is odd, each new column is a weighted mean of three (Guthe &
    Heckbert 2005)."""
    width = pixels.shape[1]
    half = width // 2
    if width == 1:
        return pixels
    if width % 2 == 0:
        return (pixels[:, 0::2] + pixels[:, 1::2]) / 2
    first = np.arange(half, dtype=np.float32)[:, None]
    weighted = (half - first) * pixels[:, 0:-1:2] + half * pixels[:, 1::2] + (first + 1) * pixels[:, 2::2]
    return weighted / width


@cache
def _tables() -> tuple[np.ndarray, np.ndarray]:
    """Two tables: 8-bit sRGB to 14-bit linear light, and the sum of four such values to the sRGB of their mean."""
    decode = np.rint(srgb_to_linear(np.arange(256) / 255) * _FULL).astype(np.uint16)
    encode = np.rint(linear_to_srgb(np.arange(4 * _FULL + 1) / (4 * _FULL)) * 255).astype(np.uint8)
    return decode, encode


@cache
def _decode_pairs() -> np.ndarray:
    """The first table for two codes at once: in memory, the light of each follows that of the other as the codes do."""
    light = _tables()[0].astype(np.uint32)
    return (light[:, None] << 16 | light).ravel()
