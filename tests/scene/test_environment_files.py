from __future__ import annotations

import json
import weakref
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from needs import CORPUS, needs

from viewer.errors import InputError
from viewer.scene.chromaticities import to_rec_709
from viewer.scene.environment_files import MAX_WIDTH, load_environment
from viewer.scene.equirect import sphere_integral


def write(path: Path, pixels: np.ndarray, kind: str = "float", **attributes) -> Path:
    import OpenImageIO as oiio

    spec = oiio.ImageSpec(pixels.shape[1], pixels.shape[0], pixels.shape[2], kind)
    for name, value in attributes.items():
        setattr(spec, name, value)
    output = oiio.ImageOutput.create(str(path))
    assert output.open(str(path), spec), output.geterror()
    if attributes.get("tile_width"):
        assert output.write_tiles(spec.x, spec.x + pixels.shape[1], spec.y, spec.y + pixels.shape[0], 0, 1, pixels)
    else:
        assert output.write_image(pixels)
    output.close()
    return path


def random_map(height: int = 8, width: int = 16, channels: int = 3) -> np.ndarray:
    return np.random.default_rng(3).random((height, width, channels)).astype(np.float32)


def test_radiance_hdr(tmp_path):
    pixels = random_map()
    environment = load_environment(write(tmp_path / "a.hdr", pixels))
    assert environment.name == "a"
    assert environment.radiance.dtype == np.float32
    assert np.abs(environment.radiance - pixels).max() < 1 / 128  # a shared exponent keeps 8 bits


@pytest.mark.parametrize("tiled", [False, True])
def test_exr(tmp_path, tiled):
    pixels = random_map(48, 96)
    tiles = {"tile_width": 16, "tile_height": 16} if tiled else {}
    assert np.array_equal(load_environment(write(tmp_path / "a.exr", pixels, **tiles)).radiance, pixels)


def test_exr_without_or_with_more_channels_than_colours(tmp_path):
    grey, rgba = random_map(channels=1), random_map(channels=4)
    assert np.array_equal(load_environment(write(tmp_path / "grey.exr", grey)).radiance, np.repeat(grey, 3, axis=2))
    assert np.array_equal(load_environment(write(tmp_path / "rgba.exr", rgba)).radiance, rgba[:, :, :3])
    layers = write(tmp_path / "z.exr", random_map(channels=4), channelnames=("Z", "R", "G", "B"))
    assert np.array_equal(load_environment(layers).radiance, random_map(channels=4)[:, :, 1:])


def test_png_is_decoded_from_srgb(tmp_path):
    pixels = np.full((2, 4, 3), 188 / 255, np.float32)
    assert load_environment(write(tmp_path / "a.png", pixels, "uint8")).radiance == pytest.approx(0.5029, abs=1e-3)


def test_a_map_that_is_too_wide_is_reduced_without_loss_of_light(tmp_path):
    pixels = random_map(64, MAX_WIDTH + 4)
    pixels[3, 7] = 5000
    radiance = load_environment(write(tmp_path / "wide.exr", pixels)).radiance
    assert radiance.shape == (32, MAX_WIDTH // 2 + 2, 3)
    assert sphere_integral(radiance) == pytest.approx(sphere_integral(pixels), rel=1e-5)


def test_values_that_are_no_radiance(tmp_path):
    pixels = random_map()
    pixels[1, 2], pixels[3, 4] = -1, np.inf
    radiance = load_environment(write(tmp_path / "mended.exr", pixels)).radiance
    assert radiance[1, 2].max() == 0
    assert radiance[3, 4].min() == 65504
    pixels[5, 6, 1] = np.nan
    with pytest.raises(InputError, match=r"nan\.exr: row 5, column 6: the value is not a number"):
        load_environment(write(tmp_path / "nan.exr", pixels)).radiance  # noqa: B018
    pixels[5, 6, 1] = 1e20
    with pytest.raises(InputError, match=r"row 5, column 6: radiance 1e\+20"):
        load_environment(write(tmp_path / "huge.exr", pixels)).radiance  # noqa: B018


def test_pixels_are_decoded_once_and_only_when_asked_for(tmp_path):
    path = write(tmp_path / "a.exr", random_map())
    environment = load_environment(path)
    turned = replace(environment, rotation=1.0)
    radiance = environment.radiance
    path.unlink()
    assert turned.radiance is radiance


def test_the_digest_is_of_the_content(tmp_path):
    one, same = write(tmp_path / "a.exr", random_map()), tmp_path / "b.exr"
    same.write_bytes(one.read_bytes())
    other = write(tmp_path / "c.exr", random_map() + 1)
    digests = [load_environment(path).digest for path in (one, same, other)]
    assert digests[0] == digests[1] != digests[2]
    assert digests[0]


@pytest.mark.parametrize("spec", [None, "none"])
def test_no_environment(spec):
    assert load_environment(spec) is None


def test_what_is_no_environment_is_one_line(tmp_path):
    (tmp_path / "folder.hdr").mkdir()
    (tmp_path / "notes.txt").write_text("hello")
    png = write(tmp_path / "a.png", random_map(), "uint8")
    png.rename(tmp_path / "png.hdr")
    for name, text in {"absent.hdr": "no such file", "folder.hdr": "is a folder", "notes.txt": ".txt files cannot be",
                       "stduio": "studio, sky, furnace", "png.hdr": "is a png file"}.items():
        with pytest.raises(InputError, match=text) as error:
            load_environment(tmp_path / name).radiance  # noqa: B018
        assert "\n" not in str(error.value)


@pytest.mark.parametrize("tiled", [False, True])
@pytest.mark.parametrize("x, y", [(8, 0), (0, 3), (-4, -2), (40, 0), (-3, 5)])
def test_the_display_window_of_an_exr_is_the_map(tmp_path, x, y, tiled):
    pixels = random_map(16, 32) + 1
    tiles = {"tile_width": 16, "tile_height": 16} if tiled else {}
    window = {"x": x, "y": y, "full_x": 0, "full_y": 0, "full_width": 24, "full_height": 12}
    expected = np.zeros((12, 24, 3), np.float32)
    for row in range(12):
        for column in range(24):
            if 0 <= row - y < 16 and 0 <= column - x < 32:
                expected[row, column] = pixels[row - y, column - x]
    path = write(tmp_path / "a.exr", pixels, **tiles, **window)
    assert np.array_equal(load_environment(path).radiance, expected)


def test_a_display_window_that_is_too_large(tmp_path):
    window = {"full_width": 60000, "full_height": 30000}
    with pytest.raises(InputError, match=r"a\.exr: 60000 x 30000 texels are more than"):
        load_environment(write(tmp_path / "a.exr", random_map(), **window)).radiance  # noqa: B018


AP1 = (0.713, 0.293, 0.165, 0.83, 0.128, 0.044, 0.32168, 0.33767)
"""The primaries of ACEScg and the white of ACES, S-2014-004."""


@pytest.mark.parametrize("color, expected", [
    ((0.2, 0.5, 0.2), (0.0135, 0.5422, 0.1613)), ((0, 1, 0), (0, 1.1408, 0)), ((1, 1, 1), (1, 1, 1))])
def test_chromaticities_of_an_exr_are_converted(tmp_path, color, expected):
    import OpenImageIO as oiio

    spec = oiio.ImageSpec(16, 8, 3, "float")
    spec.attribute("chromaticities", oiio.TypeDesc("float[8]"), AP1)
    output = oiio.ImageOutput.create("a.exr")
    assert output.open(str(tmp_path / "a.exr"), spec)
    assert output.write_image(np.full((8, 16, 3), color, np.float32))
    output.close()
    environment = load_environment(tmp_path / "a.exr")
    assert not environment.warnings
    radiance = environment.radiance
    np.testing.assert_allclose(radiance, np.broadcast_to(expected, (8, 16, 3)), atol=2e-4)


def test_primaries_may_be_imaginary():
    """ACES 2065-1 to Rec. 709 (S-2014-004 annex; the matrix of the ACES configuration of OpenColorIO)."""
    matrix = to_rec_709((0.7347, 0.2653, 0, 1, 0.0001, -0.077, 0.32168, 0.33767))
    expected = [[2.5217, -1.1341, -0.3876], [-0.2765, 1.3727, -0.0962], [-0.0154, -0.1530, 1.1684]]
    np.testing.assert_allclose(matrix, expected, atol=1e-3)


def hdr(path: Path, body: bytes, width: int = 16, height: int = 8, kind: str = "rgbe", header: str = "") -> Path:
    path.write_bytes(f"#?RADIANCE\nFORMAT=32-bit_rle_{kind}\n{header}\n-Y {height} +X {width}\n".encode() + body)
    return path


def coded(rgbe: np.ndarray) -> bytes:
    """Rows of (H, W, 4) uint8 in the second run-length code, by literals alone; W < 128."""
    width = rgbe.shape[1]
    return b"".join(bytes([2, 2, 0, width]) + b"".join(bytes([width]) + row[:, k].tobytes() for k in range(4))
                    for row in rgbe)


GREEN = np.full((8, 16, 4), (64, 128, 32, 129), np.uint8)


@pytest.mark.parametrize("encode", [np.ndarray.tobytes, coded])
@pytest.mark.parametrize("numbers, matrix", [
    ("0.64 0.33 0.30 0.60 0.15 0.06 0.3127 0.329", np.eye(3)), ("nonsense", np.eye(3)),
    # Rec. 2020 to Rec. 709, ITU-R BT.2087-0.
    ("0.708 0.292 0.170 0.797 0.131 0.046 0.3127 0.329",
     [[1.6605, -0.5876, -0.0728], [-0.1246, 1.1329, -0.0083], [-0.0182, -0.1006, 1.1187]])])
def test_primaries_of_a_radiance_file_are_converted(tmp_path, encode, numbers, matrix):
    path = hdr(tmp_path / "a.hdr", encode(GREEN), header=f"PRIMARIES={numbers}\n")
    radiance = load_environment(path).radiance
    expected = np.maximum(np.array(matrix) @ (0.5, 1, 0.25), 0)
    np.testing.assert_allclose(radiance, np.broadcast_to(expected, radiance.shape), atol=1e-3)


@pytest.mark.parametrize("numbers, is_warned", [
    ("0 0 0 0 0 0 0 0", False),  # written by tools that knew none
    ("0.3 0.3 0.3 0.3 0.3 0.3 0.3 0.3", True), ("0.6 0.3 0.3 0 0.1 0.1 0.3 0.3", True), ("nan 0 0 0 0 0 0 0", True),
    ("1e300 1e-300 0.3 0.6 0.15 0.06 0.3 0.3", True), ("0.6 0.3 0.3 0.6 0.1 1e-300 0.3 0.3", True)])
def test_primaries_that_are_no_colours_are_ignored(tmp_path, numbers, is_warned):
    environment = load_environment(hdr(tmp_path / "a.hdr", GREEN.tobytes(), header=f"PRIMARIES={numbers}\n"))
    assert (environment.radiance == (0.5, 1, 0.25)).all()
    assert len(environment.warnings) == is_warned and all("primaries are ignored" in w for w in environment.warnings)


@pytest.mark.parametrize("encode", [np.ndarray.tobytes, coded])
def test_xyze(tmp_path, encode):
    white = np.full((8, 16, 4), (122, 128, 139, 129), np.uint8)  # D65 is X 0.9505, Y 1, Z 1.0891
    radiance = load_environment(hdr(tmp_path / "a.hdr", encode(white), kind="xyze")).radiance
    assert radiance == pytest.approx(1, abs=0.015)


@pytest.mark.parametrize("width", [4, 16, 400])
def test_the_first_run_length_code(tmp_path, width):
    rows = np.full((8, width, 4), 130, np.uint8)
    rows[..., :3] = np.arange(8)[:, None, None] * 20 + (10, 20, 30)
    rest = width - 1
    runs = bytes([1, 1, 1, rest & 255]) + (bytes([1, 1, 1, rest >> 8]) if rest > 255 else b"")
    body = b"".join(row[0].tobytes() + runs for row in rows)
    flat = load_environment(hdr(tmp_path / "flat.hdr", rows.tobytes(), width)).radiance
    assert np.array_equal(load_environment(hdr(tmp_path / "runs.hdr", body, width)).radiance, flat)
    assert flat[3, 0] == pytest.approx(np.array((70, 80, 90)) * 2.0 ** (130 - 136))


@pytest.mark.parametrize("body", [GREEN.tobytes()[:-4], GREEN[0, 0].tobytes() + bytes([1, 1, 1, 126]), b"", b"xyz"])
def test_pixels_that_are_too_few(tmp_path, body):
    with pytest.raises(InputError, match=r"a\.hdr: ends too early: \d+ pixels of 16 x 8"):
        load_environment(hdr(tmp_path / "a.hdr", body)).radiance  # noqa: B018


def test_a_run_that_claims_billions_is_bounded(tmp_path):
    body = GREEN[0, 0].tobytes() + bytes([1, 1, 1, 255]) * 9
    radiance = load_environment(hdr(tmp_path / "a.hdr", body)).radiance
    assert radiance.shape == (8, 16, 3) and (radiance == radiance[0, 0]).all()


def test_flat_pixels_that_look_coded(tmp_path):
    rows = GREEN.copy()
    rows[0, 0] = 2, 2, 0, 16
    radiance = load_environment(hdr(tmp_path / "a.hdr", rows.tobytes())).radiance
    assert (radiance[0, 1:] == (0.5, 1, 0.25)).all() and radiance[0, 0].max() < 1e-30


@pytest.mark.parametrize("suffix, kind", [("hdr", "float"), ("exr", "float"), ("png", "uint8")])
def test_a_map_that_is_no_equirectangular_one_is_warned_about(tmp_path, suffix, kind):
    for height, width, is_warned in ((8, 16, False), (16, 16, True), (12, 16, True), (16, 12, True)):
        path = write(tmp_path / f"{height}-{width}.{suffix}", random_map(height, width), kind)
        warnings = load_environment(path).warnings
        assert len(warnings) == is_warned
        assert not is_warned or f"{width} x {height} is not twice as wide as high" in warnings[0]


def malformed() -> list:
    index = CORPUS / "INDEX.json"
    if not index.is_file():
        return []
    entries = json.loads(index.read_text())["malformed"]
    return [pytest.param(e, id=Path(e["path"]).name) for e in entries if Path(e["path"]).name.startswith("hdr-")]


@needs("corpus")
@pytest.mark.parametrize("entry", malformed())
def test_malformed_files(entry):
    environment = None
    try:
        environment = load_environment(CORPUS / entry["path"])
        radiance = environment.radiance
    except InputError as error:
        assert entry["expect"] != "must load", error
        assert "\n" not in str(error)
    else:
        assert entry["expect"] != "error"
        assert np.isfinite(radiance).all()
        assert radiance.min() >= 0


def test_pixels_that_nobody_holds_are_let_go(tmp_path):
    environment = load_environment(write(tmp_path / "a.exr", random_map()))
    held = weakref.ref(environment.radiance)
    assert held() is None
    again = environment.radiance
    assert environment.radiance is again


@pytest.mark.parametrize("name", ["a.exr", "a.hdr", "a.png"])
def test_broken_files_are_told_in_words_of_our_own(tmp_path, name):
    whole = write(tmp_path / name, random_map(64, 128), "uint8" if name == "a.png" else "float").read_bytes()
    for cut in (0, 20, len(whole) // 2):
        (tmp_path / name).write_bytes(whole[:cut])
        with pytest.raises(InputError) as caught:
            load_environment(tmp_path / name).radiance  # noqa: B018
        assert any(words in str(caught.value) for words in ("its beginning is broken", "row ", "ends too early"))
        assert "\n" not in str(caught.value) and "ERR" not in str(caught.value)
