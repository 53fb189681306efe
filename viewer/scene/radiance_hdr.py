"""What OpenImageIO does not read of Radiance HDR: XYZE, PRIMARIES, and pixels that are flat or in the first run-length
code (Ward, "Real pixels", Graphics Gems II, 1991; Radiance's color.c)."""

from __future__ import annotations

import re
from dataclasses import dataclass

import numpy as np

_RESOLUTION = re.compile(rb"-Y (\d{1,9}) \+X (\d{1,9})\r?\n")
_MAX_HEADER = 1 << 16


@dataclass(frozen=True)
class HdrHeader:
    """`size` is (width, height), None where the pixels stand in another order than top down, left to right; they begin
    at byte `start`. `primaries` are eight chromaticities or None."""

    is_xyz: bool
    primaries: tuple[float, ...] | None
    size: tuple[int, int] | None
    start: int


def read_hdr_header(data: bytes) -> HdrHeader | None:
    """None for what does not begin as a Radiance file."""
    end = data.find(b"\n\n", 0, _MAX_HEADER)
    if not data.startswith(b"#?") or end < 0:
        return None
    lines = [line.strip() for line in data[:end].split(b"\n")]
    primaries = None
    for line in lines:
        if line.startswith(b"PRIMARIES="):
            try:
                numbers = tuple(float(word) for word in line[10:].split())
            except ValueError:
                continue
            primaries = numbers if len(numbers) == 8 else None
    found = _RESOLUTION.match(data, end + 2)
    size = (int(found[2]), int(found[1])) if found else None
    return HdrHeader(b"FORMAT=32-bit_rle_xyze" in lines, primaries, size, found.end() if found else end + 2)


def plain_pixels(data: bytes, header: HdrHeader) -> np.ndarray | None:
    """(height, width, 4) uint8 of a file that is flat or in the first run-length code; None for the second code.

    Raises ValueError where the pixels are too few.
    """
    if header.size is None:
        return None
    width, height = header.size
    count, body = width * height, memoryview(data)[header.start:]
    marker = bytes([2, 2, width >> 8 & 255, width & 255])
    if len(body) != 4 * count and 8 <= width < 1 << 15 and body[:4] == marker:
        return None
    pixels = np.frombuffer(body[:len(body) // 4 * 4], np.uint8).reshape(-1, 4)
    if len(pixels) != count:
        pixels = _repeated(pixels, count)
    if len(pixels) < count:
        raise ValueError(f"{len(pixels)} pixels of {width} x {height}")
    return pixels[:count].reshape(height, width, 4)


def _repeated(pixels: np.ndarray, count: int) -> np.ndarray:
    """Where the three mantissas are 1, the fourth byte says how often the pixel before comes again; it has 8 more bits
    in each code that follows another."""
    is_code = (pixels[:, :3] == 1).all(axis=1)
    if not is_code.any() or is_code[0]:
        return pixels
    number = np.arange(len(pixels))
    source = np.maximum.accumulate(np.where(is_code, 0, number))  # the pixel, or the last one before the code
    shift = np.minimum(np.maximum(number - source - 1, 0) * 8, 32)
    times = np.where(is_code, pixels[:, 3].astype(np.int64) << shift, 1)
    total = np.cumsum(np.minimum(times, count))
    enough = int(np.searchsorted(total, count)) + 1
    return pixels[np.repeat(source[:enough], np.minimum(times[:enough], count))]


def decoded(rgbe: np.ndarray) -> np.ndarray:
    """Three mantissas and their exponent, (..., 4) uint8, as (..., 3) float32; as OpenImageIO has them."""
    exponent = rgbe[..., 3:].astype(np.int32)
    values = np.ldexp(rgbe[..., :3].astype(np.float32), exponent - 136)
    return np.where(exponent == 0, np.float32(0), values)
