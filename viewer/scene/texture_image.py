"""An image file a texture refers to, decoded only when its pixels are asked for."""

from __future__ import annotations

import io
import tempfile
import warnings
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
from PIL import Image

from ..errors import InputError

MAX_SIDE = 1 << 14
MAX_PIXELS = 1 << 27
GLTF_FORMATS = ("PNG", "JPEG", "WEBP")
MESH_FORMATS = (*GLTF_FORMATS, "BMP", "GIF", "TGA", "TIFF")
"""What materials of the older mesh formats may name as well."""

Buffer = bytes | memoryview
_ROWS = 256  # copied at once


@dataclass(frozen=True, eq=False)
class TextureImage:
    """Encoded bytes whose header was checked by `open_texture_image`; `name` says where they came from.

    `bits` is the depth of a channel, 8 or 16; `format` is Pillow's name ("PNG", "JPEG", "WEBP", ...); `grey` is true
    where there is no colour, `has_alpha` where any texel may be transparent.
    """

    name: str
    data: Buffer = field(repr=False)
    width: int
    height: int
    format: str
    bits: int = 8
    grey: bool = False
    has_alpha: bool = True

    def decode(self, channels: str | None = None) -> np.ndarray:
        """The pixels, (H, W, C) uint8 or uint16, row 0 the top, as stored: no colour space is applied.

        C is what the file has: grey 1, grey and alpha 2, RGB 3, RGBA 4 (palettes and CMYK become RGB or RGBA).
        `channels`, some of "RGBA" such as "GB", gives just those, in that order: grey stands for each of R, G and B,
        and alpha is full where there is none. Raises InputError for data that does not decode.
        """
        if self.bits == 16:
            with _as_input_error(self.name):
                return _pick(_decode_16_bit(self), channels)
        with _as_input_error(self.name), Image.open(io.BytesIO(self.data), formats=(self.format,)) as image:
            image.load()
            plain = _plain_mode(image)
            if channels is None or channels == "RGBA"[:len(plain.getbands())]:
                return _pixels(plain)
            return _pick_bands(plain, channels)


def open_texture_image(data: Buffer, name: str, formats: tuple[str, ...] = GLTF_FORMATS) -> TextureImage:
    """Check the header of an encoded image without decoding it.

    Raises InputError for what is none of `formats`, and for more than MAX_SIDE texels a side or MAX_PIXELS in all:
    a few kilobytes can claim gigabytes of pixels.
    """
    with _as_input_error(name), Image.open(io.BytesIO(data), formats=formats) as image:
        width, height, kind, mode = *image.size, str(image.format), image.mode
        has_alpha = image.has_transparency_data
    if min(width, height) < 1 or max(width, height) > MAX_SIDE or width * height > MAX_PIXELS:
        raise InputError(name, "", f"{width} x {height} texels; at most {MAX_SIDE} a side and {MAX_PIXELS} in all")
    # Byte 24 of a PNG is the bit depth in IHDR, which always comes first.
    bits = 16 if kind == "PNG" and data[24] == 16 else 8
    return TextureImage(name, data, width, height, kind, bits, mode[0] in "1LIF" and mode != "LAB", has_alpha)


def _plain_mode(image: Image.Image) -> Image.Image:
    """The image as L, LA, RGB or RGBA."""
    if "transparency" in image.info and image.mode in ("1", "L", "P", "RGB"):
        return image.convert("LA" if image.mode in ("1", "L") else "RGBA")
    if image.mode in ("L", "LA", "RGB", "RGBA"):
        return image
    return image.convert({"1": "L", "La": "LA", "PA": "RGBA", "RGBa": "RGBA"}.get(image.mode, "RGB"))


def _pixels(image: Image.Image) -> np.ndarray:
    """All bands; a few rows at a time, because Pillow would make a second copy of the whole on the way."""
    out = np.empty((image.height, image.width, len(image.getbands())), np.uint8)
    for top in range(0, image.height, _ROWS):
        rows = out[top:top + _ROWS]
        rows[:] = np.asarray(image.crop((0, top, image.width, top + len(rows)))).reshape(rows.shape)
    return out


def _pick_bands(image: Image.Image, channels: str) -> np.ndarray:
    """Single bands, without ever holding all of the image's channels as an array."""
    bands = image.getbands()
    out = np.empty((image.height, image.width, len(channels)), np.uint8)
    for k, channel in enumerate(channels):
        if channel == "A" and "A" not in bands:
            out[..., k] = 255
        else:
            out[..., k] = np.asarray(image.getchannel(channel if channel in bands else "L"))
    return out


def _pick(pixels: np.ndarray, channels: str | None) -> np.ndarray:
    if channels is None:
        return pixels
    count = pixels.shape[2]
    full = np.iinfo(pixels.dtype).max
    alpha = pixels[..., -1] if count in (2, 4) else full
    out = np.empty((*pixels.shape[:2], len(channels)), pixels.dtype)
    for k, channel in enumerate(channels):
        out[..., k] = alpha if channel == "A" else pixels[..., "RGB".index(channel) if count >= 3 else 0]
    return out


def _decode_16_bit(image: TextureImage) -> np.ndarray:
    """Through OpenImageIO, for Pillow reduces 16-bit colour to 8 bits; its Python API reads from files alone."""
    import OpenImageIO as oiio

    with Image.open(io.BytesIO(image.data), formats=("PNG",)) as png:
        png.verify()  # a broken chunk would make libpng write to stderr
    config = oiio.ImageSpec()
    config.attribute("oiio:UnassociatedAlpha", 1)
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder, "texture.png")
        path.write_bytes(image.data)
        source = oiio.ImageInput.open(str(path), config)
        if source is None:
            raise ValueError(oiio.geterror())
        pixels = source.read_image(0, 0, 0, source.spec().nchannels, oiio.UINT16)
        problem = source.geterror()
        source.close()
    if pixels is None or problem:
        raise ValueError(problem or "no pixels")
    return pixels


@contextmanager
def _as_input_error(name: str) -> Iterator[None]:
    """Turn whatever an image decoder raises into an InputError about `name`."""
    try:
        with warnings.catch_warnings():
            # Pillow's own limit is below ours, and its complaints about metadata are not for the user.
            warnings.simplefilter("ignore")
            yield
    except Image.UnidentifiedImageError as error:
        raise InputError(name, "", "not an image in a supported format, or its header is broken") from error
    except InputError:
        raise
    except Image.DecompressionBombError as error:
        raise InputError(name, "", f"more texels than can be held; at most {MAX_PIXELS}") from error
    except Exception as error:  # decoders raise OSError, SyntaxError, struct.error, EOFError, zlib.error, ...
        raise InputError(name, "", f"cannot be decoded: {error}") from error
