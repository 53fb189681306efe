"""viewer/measure/compare/difference.py: exact numbers on pictures small enough to work out by hand."""

from __future__ import annotations

import json

import flip_evaluator as flip
import numpy as np
import pytest

from viewer.errors import InputError
from viewer.image.image import Image
from viewer.measure.compare.difference import compare, compare_files, not_finite


@pytest.fixture
def pair() -> tuple[Image, Image]:
    rng = np.random.default_rng(3)
    pixels = rng.integers(40, 200, (24, 32, 3)).astype(np.uint8)
    return Image.from_srgb(pixels), Image.from_srgb(pixels + rng.integers(0, 30, pixels.shape).astype(np.uint8))


@pytest.mark.parametrize("kind", ["ldr", "hdr"])
def test_a_picture_does_not_differ_from_itself(pair, kind):
    difference = compare(pair[0], pair[0], kind)
    assert (difference.flip, difference.rmse, difference.max) == (0, 0, 0) and not difference.map.any()


@pytest.mark.parametrize("kind", ["ldr", "hdr"])
def test_flip_is_the_evaluator_s_own(pair, kind):
    arrays = [image.over(1) if kind == "ldr" else image.linear[..., :3].copy() for image in pair]
    expected, mean, _ = flip.evaluate(*arrays, kind.upper(), applyMagma=False)
    difference = compare(*pair, kind)
    assert np.array_equal(difference.map, expected[..., 0])
    assert difference.flip == pytest.approx(mean, abs=1e-6) and difference.flip > 0.01


def test_rmse_and_max_of_one_changed_pixel():
    pixels = np.full((4, 5, 3), 100, np.uint8)
    changed = pixels.copy()
    changed[1, 2] = 151, 100, 49
    difference = compare(Image.from_srgb(pixels), Image.from_srgb(changed))
    assert difference.max == pytest.approx(0.2, abs=1e-6)
    assert difference.rmse == pytest.approx((2 * 0.2**2 / 60) ** 0.5, abs=1e-6)


def test_radiance_is_compared_as_radiance():
    dark, bright = (Image.from_linear(np.full((4, 4, 3), value, np.float32)) for value in (2.0, 5.0))
    difference = compare(dark, bright, "hdr")
    assert difference.rmse == difference.max == 3.0 and difference.flip > 0.05
    assert compare(dark, bright).max == 0  # both are white on a screen


@pytest.mark.parametrize("kind", ["ldr", "hdr"])
def test_transparency_is_seen_over_white_and_counts_in_max(kind):
    clear = np.zeros((4, 4, 4), np.uint8)
    white = np.full((4, 4, 4), 255, np.uint8)
    difference = compare(Image.from_srgb(clear), Image.from_srgb(white), kind)
    assert (difference.flip, difference.rmse, difference.max) == (0, 0, 1)


@pytest.mark.parametrize("lit", [0, 1, 7])
def test_a_mostly_black_reference_has_a_finite_hdr_flip(lit):
    pixels = np.zeros((8, 8, 3), np.float32)
    pixels[0, :lit] = 3.0
    difference = compare(Image.from_linear(pixels), Image.from_linear(pixels + 0.1), "hdr")
    assert 0.05 < difference.flip < 1 and np.isfinite(difference.map).all()


def test_the_map_is_magma(pair, tmp_path):
    black, white = (Image.from_srgb(np.full((8, 8, 3), value, np.uint8)) for value in (0, 255))
    compare(black, white).save_map(tmp_path / "map.png")
    expected = flip.evaluate(black.over(1), white.over(1), "LDR", applyMagma=True)[0]
    assert np.abs(Image.open(tmp_path / "map.png").srgb[..., :3] / 255 - expected).max() < 0.03
    assert (compare(black, black).map_image().srgb[..., :3] <= 1).all()


def test_files_decide_what_is_compared(pair, tmp_path):
    for image, name in zip(pair, "ab"):
        image.save(tmp_path / f"{name}.png")
        image.save(tmp_path / f"{name}.exr")
    shown = compare_files(tmp_path / "a.png", tmp_path / "b.png")
    mixed = compare_files(tmp_path / "a.exr", tmp_path / "b.png")
    linear = compare_files(tmp_path / "a.exr", tmp_path / "b.exr")
    assert (shown.kind, mixed.kind, linear.kind) == ("ldr", "ldr", "hdr")
    assert shown.rmse == pytest.approx(mixed.rmse, abs=1e-6) and linear.rmse == compare(*pair, "hdr").rmse
    assert json.loads(json.dumps(shown.to_json())) == {
        "a": str(tmp_path / "a.png"), "b": str(tmp_path / "b.png"), "size": [32, 24],
        "flip": shown.flip, "rmse": shown.rmse, "max": shown.max, "kind": "displayed values"}
    assert linear.to_json()["kind"] == "linear light"


def test_errors_are_one_line(pair, tmp_path):
    small = Image.from_srgb(np.zeros((2, 3, 3), np.uint8))
    with pytest.raises(InputError, match="^b: is 3x2, a is 32x24$"):
        compare(pair[0], small)
    broken = Image.from_linear(np.full((2, 3, 3), [0, np.nan, 0], np.float32))
    with pytest.raises(InputError, match="^b: 6 pixels NaN or infinite, the first at x=0, y=0$"):
        compare(small, broken, "hdr")
    with pytest.raises(InputError, match="no such file"):
        compare_files(tmp_path / "a.png", tmp_path / "b.png")


def test_not_finite_names_the_first_pixel():
    pixels = np.zeros((3, 4, 4), np.float32)
    assert not_finite(pixels) == ""
    pixels[1, 2, 3] = np.inf
    assert not_finite(pixels) == "1 pixel NaN or infinite, the first at x=2, y=1"
