"""Texture images in memory."""

from __future__ import annotations

import io
import struct
import zlib

import numpy as np
from PIL import Image

from viewer.scene.texture_image import TextureImage, open_texture_image

_MODES = {1: "L", 2: "LA", 3: "RGB", 4: "RGBA"}
_COLOR_TYPES = {1: 0, 2: 4, 3: 2, 4: 6}


def image_of(pixels: np.ndarray, name: str = "image") -> TextureImage:
    """A PNG of (H, W, 1 to 4) uint8 or uint16."""
    height, width, count = pixels.shape
    if pixels.dtype == np.uint8:
        out = io.BytesIO()
        Image.fromarray(pixels[..., 0] if count == 1 else pixels, _MODES[count]).save(out, "PNG", compress_level=1)
        return open_texture_image(out.getvalue(), name)
    rows = b"".join(b"\0" + row.astype(">u2").tobytes() for row in pixels)
    header = struct.pack(">IIBBBBB", width, height, 16, _COLOR_TYPES[count], 0, 0, 0)
    chunks = (b"IHDR", header), (b"IDAT", zlib.compress(rows)), (b"IEND", b"")
    data = b"".join(struct.pack(">I", len(body)) + kind + body + struct.pack(">I", zlib.crc32(kind + body))
                    for kind, body in chunks)
    return open_texture_image(b"\x89PNG\r\n\x1a\n" + data, name)


def noise(width: int, height: int, count: int = 4, seed: int = 0, dtype: type = np.uint8) -> np.ndarray:
    return np.random.default_rng(seed).integers(0, np.iinfo(dtype).max + 1, (height, width, count), dtype=dtype)
