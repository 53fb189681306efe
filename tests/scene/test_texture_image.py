import io
import struct
import zlib

import numpy as np
import pytest
from PIL import Image

from viewer.errors import InputError
from viewer.scene.texture_image import MAX_SIDE, open_texture_image


def encoded(image: Image.Image, kind: str = "PNG", **options) -> bytes:
    out = io.BytesIO()
    image.save(out, kind, **options)
    return out.getvalue()


def png_chunk(kind: bytes, data: bytes) -> bytes:
    return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))


def png(width: int, height: int, bits: int, color_type: int, rows: bytes) -> bytes:
    header = struct.pack(">IIBBBBB", width, height, bits, color_type, 0, 0, 0)
    return b"\x89PNG\r\n\x1a\n" + png_chunk(b"IHDR", header) + png_chunk(b"IDAT", zlib.compress(rows)) \
        + png_chunk(b"IEND", b"")


@pytest.mark.parametrize("mode, kind, expected", [
    ("L", "PNG", [50]), ("LA", "PNG", [50, 60]), ("RGB", "PNG", [10, 20, 30]), ("RGBA", "PNG", [10, 20, 30, 40]),
    ("1", "PNG", [255]), ("RGB", "WEBP", [10, 20, 30])])
def test_channels_stay_as_stored(mode, kind, expected):
    color = {"L": 50, "LA": (50, 60), "RGB": (10, 20, 30), "RGBA": (10, 20, 30, 40), "1": 1}[mode]
    options = {"lossless": True} if kind == "WEBP" else {}
    image = open_texture_image(encoded(Image.new(mode, (3, 2), color), kind, **options), "x")
    pixels = image.decode()
    assert (image.width, image.height, image.format) == (3, 2, kind)
    assert pixels.shape == (2, 3, len(expected)) and pixels.dtype == np.uint8
    assert pixels[1, 2].tolist() == expected


@pytest.mark.parametrize("mode, options, has_alpha", [
    ("L", {}, False), ("LA", {}, True), ("RGB", {}, False), ("RGBA", {}, True),
    ("RGB", {"transparency": (1, 2, 3)}, True),
    ("P", {}, False), ("P", {"transparency": 0}, True)])
def test_alpha_is_known_before_decoding(mode, options, has_alpha):
    image = open_texture_image(encoded(Image.new(mode, (2, 2)), **options), "x")
    assert image.has_alpha == has_alpha
    assert (image.decode().shape[2] in (2, 4)) == has_alpha


def test_palette_and_cmyk_become_colour():
    palette = Image.new("RGB", (2, 2), (200, 100, 50)).convert("P")
    assert open_texture_image(encoded(palette), "x").decode().shape == (2, 2, 3)
    assert open_texture_image(encoded(palette, transparency=0), "x").decode().shape == (2, 2, 4)
    assert open_texture_image(encoded(Image.new("CMYK", (2, 2)), "JPEG"), "x").decode().shape == (2, 2, 3)


@pytest.mark.parametrize("count, color_type", [(1, 0), (2, 4), (3, 2), (4, 6)])
def test_16_bits_are_kept(count, color_type):
    values = np.random.default_rng(1).integers(0, 1 << 16, (4, 5, count), dtype=np.uint16)
    rows = b"".join(b"\0" + row.astype(">u2").tobytes() for row in values)
    image = open_texture_image(png(5, 4, 16, color_type, rows), "x")
    assert image.bits == 16
    np.testing.assert_array_equal(image.decode(), values)
    np.testing.assert_array_equal(image.decode("G")[..., 0], values[..., 1 if count >= 3 else 0])


def test_picked_channels():
    image = open_texture_image(encoded(Image.new("RGB", (2, 2), (10, 20, 30))), "x")
    assert image.decode("GB")[0, 0].tolist() == [20, 30]
    assert image.decode("A")[0, 0].tolist() == [255]
    assert open_texture_image(encoded(Image.new("LA", (2, 2), (7, 8))), "x").decode("BA")[0, 0].tolist() == [7, 8]


def test_bombs_are_refused_by_their_header():
    with pytest.raises(InputError, match="bomb.png.*texels"):
        open_texture_image(png(MAX_SIDE + 1, 1, 8, 0, b"\0\0"), "bomb.png")
    with pytest.raises(InputError, match="bomb.png"):
        open_texture_image(png(1 << 30, 1 << 30, 8, 0, b"\0\0"), "bomb.png")


@pytest.mark.parametrize("kind", ["AVIF", "WEBP"])
@pytest.mark.parametrize("width", [4096, 16383])
def test_formats_whose_decoders_take_more_memory_have_fewer_texels(kind, width):
    """Of a few bytes 16383 x 8192 texels would take more than a gigabyte."""
    data = encoded(Image.new("RGB", (8, 8)), kind, **({"lossless": True} if kind == "WEBP" else {}))
    if kind == "AVIF":
        place = data.index(b"ispe") + 8
        data = data[:place] + struct.pack(">II", width, 8192) + data[place + 8:]
    else:
        place = data.index(b"VP8L") + 9
        (head,) = struct.unpack_from("<I", data, place)
        data = data[:place] + struct.pack("<I", head >> 28 << 28 | 8191 << 14 | width - 1) + data[place + 4:]
    if width == 4096:
        assert open_texture_image(data, "x").width == width
    else:
        with pytest.raises(InputError, match=r"x: has 16383 x 8192 texels; the limit is 16384 per side and 67108864"):
            open_texture_image(data, "x")


@pytest.mark.parametrize("bits", [8, 16])
def test_truncated_data_is_the_neutral_colour_and_a_line(bits, capfd):
    noise = np.random.default_rng(2).integers(0, 256, (8, 8 * 3 * bits // 8), dtype=np.uint8)
    data = png(8, 8, bits, 2, np.pad(noise, ((0, 0), (1, 0))).tobytes())[:150]
    image = open_texture_image(data, "wall.png", neutral=(0.0, 1.0, 0.2, 1.0))
    for channels, texel in ((None, [0, 1, 0.2, 1]), ("GB", [1, 0.2]), ("R", [0])):
        pixels = image.decode(channels)
        assert pixels.dtype == (np.uint8 if bits == 8 else np.uint16) and pixels.shape == (8, 8, len(texel))
        assert (pixels == [value * np.iinfo(pixels.dtype).max for value in texel]).all()
    [problem] = image.problems
    assert problem.startswith("wall.png: ") and "\n" not in problem
    assert capfd.readouterr().err == ""


def test_formats_gltf_lacks_are_refused():
    with pytest.raises(InputError):
        open_texture_image(encoded(Image.new("RGB", (2, 2)), "BMP"), "x")
