"""KTX2 images with Basis Universal texels (ETC1S and UASTC), as KHR_texture_basisu allows them.

They are decoded to 8-bit RGB or RGBA on the CPU, and of their mip levels only the largest is read: ours are means in
linear light.
"""

from __future__ import annotations

import struct
from importlib.util import find_spec
from typing import NamedTuple

import numpy as np

from ..base.apart import ApartError, apart

FORMAT = "KTX2"
IDENTIFIER = b"\xabKTX 20\xbb\r\n\x1a\n"
_HEADER = struct.Struct("<12s9I4I2Q3Q")  # with the first of the level index
_ETC1S, _UASTC = 163, 166
_SCHEMES = {_ETC1S: (1,), _UASTC: (0, 2)}
"""By the model of a texel block, its supercompression: none, BasisLZ or Zstandard (KTX 2.0, 3.10)."""
_ALPHA_CHANNELS = {_ETC1S: (15,), _UASTC: (3, 5)}
_BLOCK = 16  # bytes for 4 x 4 texels of UASTC
_SECONDS, _SECONDS_PER_TEXEL = 5.0, 1e-6
_BYTES, _BYTES_PER_TEXEL = 1 << 28, 16


class Header(NamedTuple):
    width: int
    height: int
    has_alpha: bool


def is_installed() -> bool:
    return find_spec("opengl_basisu") is not None


def read_header(data: bytes | memoryview) -> Header:
    """Raises ValueError for what is broken or no such image; the texels are not looked at."""
    data = memoryview(data)
    if len(data) < _HEADER.size:
        raise ValueError("ends inside its header")
    (_, vulkan, _, width, height, depth, layers, faces, _, scheme, descriptor, descriptor_size, _, _, _, _,
     _, _, level_size) = _HEADER.unpack_from(data)
    if vulkan != 0:
        raise ValueError(f"is a KTX2 of Vulkan format {vulkan}; only Basis Universal (ETC1S, UASTC) is supported")
    if depth > 0 or layers > 1 or faces != 1:
        raise ValueError("is a KTX2 with more than one picture")
    if descriptor + max(descriptor_size, 44) > len(data):
        raise ValueError("ends inside its data format descriptor")
    model, samples = data[descriptor + 12], (struct.unpack_from("<H", data, descriptor + 10)[0] - 24) // 16
    if scheme not in _SCHEMES.get(model, ()):
        raise ValueError(f"is a KTX2 of color model {model} with supercompression {scheme}, which is not supported")
    if scheme != 1 and level_size != -(-width // 4) * -(-height // 4) * _BLOCK:
        raise ValueError(f"declares {level_size} bytes for {width} x {height} texels")
    first = descriptor + 31  # the kind of channel of the first sample, which takes 16 bytes like the others
    channels = [data[place] & 15 for place in range(first, min(first + 16 * samples, len(data)), 16)]
    return Header(width, height, any(channel in _ALPHA_CHANNELS[model] for channel in channels))


def decode(data: bytes, header: Header) -> np.ndarray:
    """The texels, (H, W, 3 or 4) uint8, row 0 at the top. Raises ValueError."""
    texels = header.width * header.height
    try:
        pixels = apart.call("viewer.scene.decoders:ktx2", data, _SECONDS + _SECONDS_PER_TEXEL * texels,
                            _BYTES + _BYTES_PER_TEXEL * texels, channels=4 if header.has_alpha else 3)["pixels"]
    except ApartError as error:
        raise ValueError(f"its data {error}") from error
    if pixels.shape[:2] != (header.height, header.width):
        raise ValueError(f"has {pixels.shape[1]} x {pixels.shape[0]} texels, not {header.width} x {header.height}")
    return pixels
