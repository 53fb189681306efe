"""Mip levels against a box filter in float64, in light where colours are sRGB."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest

from viewer.scene.color import linear_to_srgb, srgb_to_linear
from viewer.scene.mip_levels import mip_levels, without_hidden

SIZES = [(64, 64), (256, 32), (200, 136), (33, 47), (1, 5), (130, 1), (1, 1), (75, 128)]


def covering(new: int, old: int) -> np.ndarray:
    """(new, old) float64: the share of each new texel that each old one covers."""
    low, high = np.arange(new)[:, None] * old / new, (np.arange(new)[:, None] + 1) * old / new
    overlap = np.minimum(high, np.arange(old) + 1) - np.maximum(low, np.arange(old))
    return np.maximum(overlap, 0) * new / old


def box(values: np.ndarray) -> np.ndarray:
    height, width = values.shape[:2]
    rows, columns = covering(max(1, height // 2), height), covering(max(1, width // 2), width)
    return np.einsum("ih,hwc,jw->ijc", rows, values, columns, optimize=True)


def to_light(pixels: np.ndarray, srgb: bool) -> np.ndarray:
    light = pixels / 255
    if srgb:
        light[..., :3] = srgb_to_linear(light[..., :3])
    return light


def from_light(light: np.ndarray, srgb: bool) -> np.ndarray:
    light = light.copy()
    if srgb:
        light[..., :3] = linear_to_srgb(np.clip(light[..., :3], 0, 1))
    return light * 255


@pytest.mark.parametrize("size", SIZES)
@pytest.mark.parametrize("components, srgb", [(1, False), (2, False), (3, False), (4, False), (3, True), (4, True)])
def test_each_level_is_the_mean_of_the_one_before(size, components, srgb):
    pixels = np.random.default_rng(3).integers(0, 256, (*size, components), np.uint8)
    levels = mip_levels(pixels, srgb)
    assert levels[0] is pixels and levels[-1].shape == (1, 1, components)
    for larger, smaller in pairwise(levels):
        assert smaller.dtype == np.uint8
        assert smaller.shape[:2] == tuple(max(1, side // 2) for side in larger.shape[:2])
        # Half a level of rounding, and in the dark, where sRGB is steep, a little of the 14 bits of light.
        assert np.abs(smaller - from_light(box(to_light(larger, srgb)), srgb)).max() < 0.65


@pytest.mark.parametrize("srgb", [False, True])
def test_rounding_does_not_add_up(srgb):
    """Down eleven levels the mean stays within one level of the picture's: Mesa's own rises by 3.7 in linear maps."""
    pixels = np.random.default_rng(5).integers(100, 156, (2048, 64, 3), np.uint8)
    mean = from_light(to_light(pixels, srgb).mean(axis=(0, 1)), srgb)
    assert np.abs(mip_levels(pixels, srgb)[-1] - mean).max() < 1


@pytest.mark.parametrize("srgb", [False, True])
@pytest.mark.parametrize("size", [(16, 16), (15, 9)])
def test_a_constant_stays_what_it_is(size, srgb):
    for value in range(0, 256, 3):
        assert all((level == value).all() for level in mip_levels(np.full((*size, 3), value, np.uint8), srgb))


@pytest.mark.parametrize("dtype, tolerance", [(np.uint16, 0.51), (np.float16, 1e-3), (np.float32, 1e-6)])
@pytest.mark.parametrize("size", SIZES)
def test_deep_and_float_maps(size, dtype, tolerance):
    values = np.random.default_rng(7).uniform(0, 1, (*size, 3))
    pixels = (values * 65535 if dtype == np.uint16 else values).astype(dtype)
    for larger, smaller in zip(levels := mip_levels(pixels), levels[1:]):
        assert smaller.dtype == dtype
        assert np.abs(smaller - box(larger.astype(np.float64))).max() <= tolerance


def test_the_brightest_does_not_overflow():
    assert mip_levels(np.full((2, 2, 1), 65535, np.uint16))[1][0, 0, 0] == 65535
    assert mip_levels(np.full((2, 2, 1), 65504, np.float16))[1][0, 0, 0] == 65504


def test_an_edge_in_srgb_is_half_the_light():
    edge = np.zeros((2, 2, 4), np.uint8)
    edge[:, 1] = 255
    assert mip_levels(edge, srgb=True)[1].ravel().tolist() == [188, 188, 188, 128]
    assert mip_levels(edge)[1].ravel().tolist() == [128] * 4


@pytest.mark.parametrize("dtype, srgb", [(np.uint8, True), (np.uint8, False), (np.uint16, False), (np.float16, False)])
@pytest.mark.parametrize("size", [(64, 64), (33, 47), (1, 5)])
def test_colours_below_no_coverage_are_not_seen(size, dtype, srgb):
    """White cut out of black is all white in all levels, and a picture of two colours is theirs by coverage."""
    rng = np.random.default_rng(11)
    full = np.iinfo(dtype).max if dtype != np.float16 else 1
    pixels = np.zeros((*size, 4), dtype)
    pixels[rng.uniform(size=size) < 0.2] = full
    given = pixels.copy()
    levels = without_hidden(mip_levels(pixels, srgb, covers=True))
    for level in levels:
        assert (level[..., :3] == (full if pixels.any() else 0)).all()
    assert (levels[0][..., 3] == pixels[..., 3]).all() and (pixels == given).all()
    pixels = rng.uniform(0.2 * full, full, (*size, 4)).astype(dtype)
    if not srgb:
        larger, smaller = (level.astype(np.float64) for level in mip_levels(pixels, covers=True)[:2])
        shown = box(larger[..., :3] * larger[..., 3:]) / box(larger[..., 3:])
        assert np.abs(smaller[..., :3] - shown).max() <= (0.51 if full > 1 else 1e-3)
    pixels[..., 3] = full
    for covered, plain in zip(mip_levels(pixels, srgb, covers=True), mip_levels(pixels, srgb), strict=True):
        np.testing.assert_array_equal(covered, plain)
