"""An image file of a texture, which is decoded only when its pixels are needed."""

from __future__ import annotations

import io
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
from PIL import Image, features

from ..base.quiet import without_warnings
from ..errors import InputError
from . import ktx2
from .parameter import RGBA, WHITE

MAX_SIDE = 1 << 14
MAX_PIXELS = 1 << 27
_FEWER_PIXELS = {"AVIF": 1 << 26, "WEBP": 1 << 26}
"""Of formats whose decoders take 10 and 16 bytes a texel, where others take 7."""
GLTF_FORMATS = ("PNG", "JPEG", "WEBP", "AVIF", ktx2.FORMAT)
MESH_FORMATS = ("PNG", "JPEG", "WEBP", "BMP", "GIF", "TGA", "TIFF")
"""The image formats that materials of other mesh formats than glTF may use."""

Buffer = bytes | memoryview
_ROWS = 256  # copied per step


@dataclass(frozen=True, eq=False)
class TextureImage:
    """An encoded image whose header `open_texture_image` has checked; `name` is its file or place, for messages.

    `bits` is the depth of a channel, 8 or 16. `format` is Pillow's name ("PNG", "JPEG", "WEBP", ...) or "KTX2". `grey`
    is True if the image has no colour, and `has_alpha` if texels may be transparent. `neutral`, RGBA in [0, 1], is the
    colour of all texels if the data cannot be decoded.
    """

    name: str
    data: Buffer = field(repr=False)
    width: int
    height: int
    format: str
    bits: int = 8
    grey: bool = False
    has_alpha: bool = True
    neutral: RGBA = WHITE
    problems: list[str] = field(default_factory=list, init=False, repr=False, compare=False)
    """Why the data does not decode, once that was tried; empty otherwise."""

    def __post_init__(self) -> None:
        object.__setattr__(self, "data", bytes(self.data))  # plain, so that it can be copied and sent to processes

    def digest_parts(self) -> tuple[object, ...]:
        """What the pixels depend on, for `base.digest`."""
        return self.data, self.neutral

    def decode(self, channels: str | None = None) -> np.ndarray:
        """The pixels as stored, (H, W, C) uint8 or uint16, row 0 at the top. No colour space is applied.

        By default C follows the file: grey 1, grey and alpha 2, RGB 3, RGBA 4 (palettes and CMYK become RGB or RGBA).
        `channels` selects some of "RGBA", such as "GB", in that order. In a grey image R, G and B are all the grey
        channel, and in an image without alpha A is opaque. Data that cannot be
        decoded gives `neutral`, and `problems` says why.
        """
        try:
            return self._decode(channels)
        except InputError as error:
            self.problems[:] = [str(error)]
            full = 65535 if self.bits == 16 else 255
            texel = [round(self.neutral["RGBA".index(c)] * full) for c in channels or "RGBA"]
            return np.full((self.height, self.width, len(texel)), texel, np.uint16 if self.bits == 16 else np.uint8)

    def _decode(self, channels: str | None) -> np.ndarray:
        if self.bits == 16:
            with _as_input_error(self.name):
                return _pick(_decode_16_bit(self), channels)
        if self.format == ktx2.FORMAT:
            header = ktx2.Header(self.width, self.height, self.has_alpha)
            try:
                return _pick(ktx2.decode(bytes(self.data), header), channels)
            except ValueError as error:
                raise InputError(self.name, "", str(error)) from error
        with _as_input_error(self.name), Image.open(io.BytesIO(self.data), formats=(self.format,)) as image:
            image.decodermaxblock = len(self.data)  # for each block it would wait for other threads of Python
            image.load()
            plain = _plain_mode(image)
            if channels is None or channels == "RGBA"[:len(plain.getbands())]:
                return _pixels(plain)
            return _pick_bands(plain, channels)


def open_texture_image(data: Buffer, name: str, formats: tuple[str, ...] = GLTF_FORMATS,
                       neutral: RGBA = WHITE) -> TextureImage:
    """Check the header of an encoded image without decoding it. `neutral` is as in TextureImage.

    Raises InputError if the image has none of `formats`, or more than MAX_SIDE texels per side or MAX_PIXELS in all, or
    half of these as AVIF and WebP. A file of a few bytes can declare gigabytes of pixels.
    """
    if ktx2.FORMAT in formats and bytes(data[:12]) == ktx2.IDENTIFIER:
        if not ktx2.is_installed():
            raise InputError(name, "", "is a KTX2 image, which this needs: pip install opengl_basisu")
        try:
            width, height, has_alpha = ktx2.read_header(data)
        except ValueError as error:
            raise InputError(name, "", str(error)) from error
        kind, mode = ktx2.FORMAT, "RGB"
    else:
        if bytes(data[4:12]) == b"ftypavif" and not features.check("avif"):
            raise InputError(name, "", "is an AVIF image, which this Pillow cannot decode")
        pillow = [name for name in formats if name != ktx2.FORMAT]
        with _as_input_error(name), Image.open(io.BytesIO(data), formats=pillow) as image:
            width, height, kind, mode = *image.size, str(image.format), image.mode
            has_alpha = image.has_transparency_data
    most = _FEWER_PIXELS.get(kind, MAX_PIXELS)
    if min(width, height) < 1 or max(width, height) > MAX_SIDE or width * height > most:
        raise InputError(name, "", f"has {width} x {height} texels; the limit is {MAX_SIDE} per side and {most} in all")
    # Byte 24 of a PNG is the bit depth in IHDR, which always comes first.
    bits = 16 if kind == "PNG" and data[24] == 16 else 8
    return TextureImage(name, data, width, height, kind, bits, mode[0] in "1LIF" and mode != "LAB", has_alpha,
                        neutral)


def _plain_mode(image: Image.Image) -> Image.Image:
    """The image as L, LA, RGB or RGBA."""
    if "transparency" in image.info and image.mode in ("1", "L", "P", "RGB"):
        return image.convert("LA" if image.mode in ("1", "L") else "RGBA")
    if image.mode in ("L", "LA", "RGB", "RGBA"):
        return image
    return image.convert({"1": "L", "La": "LA", "PA": "RGBA", "RGBa": "RGBA"}.get(image.mode, "RGB"))


def _pixels(image: Image.Image) -> np.ndarray:
    """All bands of the image, copied a few rows at a time: for all rows Pillow would make a second copy in memory."""
    out = np.empty((image.height, image.width, len(image.getbands())), np.uint8)
    for top in range(0, image.height, _ROWS):
        rows = out[top:top + _ROWS]
        rows[:] = np.asarray(image.crop((0, top, image.width, top + len(rows)))).reshape(rows.shape)
    return out


def _pick_bands(image: Image.Image, channels: str) -> np.ndarray:
    """Some bands of the image, copied one by one so that there is never an array of all channels."""
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
    """The pixels of a 16-bit PNG, decoded by OpenImageIO, since Pillow reduces 16-bit colour to 8 bits.

    OpenImageIO's Python API reads only files, so the data is written to a temporary one.
    """
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
    """Turn any exception of an image decoder into an InputError about `name`."""
    try:
        # Pillow warns of images below MAX_PIXELS, and of broken metadata; neither matters to the user.
        with without_warnings():
            yield
    except Image.UnidentifiedImageError as error:
        raise InputError(name, "", "is not an image in a supported format, or its header is broken") from error
    except InputError:
        raise
    except Image.DecompressionBombError as error:
        raise InputError(name, "", f"has too many texels; the limit is {MAX_PIXELS}") from error
    except Exception as error:  # decoders raise OSError, SyntaxError, struct.error, EOFError, zlib.error, ...
        raise InputError(name, "", f"cannot be decoded: {error}") from error
