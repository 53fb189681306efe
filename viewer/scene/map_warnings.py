"""What the header of an environment's file promises that cannot be kept, known without decoding the pixels."""

from __future__ import annotations

import struct
from collections.abc import Iterator, Sequence
from pathlib import Path

from .chromaticities import to_rec_709
from .radiance_hdr import read_hdr_header

_HEAD = 1 << 16  # bytes; headers are far shorter
_DISPLAY_WINDOW = b"displayWindow\0box2i\0\x10\0\0\0"  # name, type and size of an attribute in the header of an EXR
_CHROMATICITIES = b"chromaticities\0chromaticities\0\x20\0\0\0"


def map_warnings(path: Path) -> Iterator[str]:
    """Lines for the user. What does not look like an HDR, EXR or PNG file gives none: decoding it says what is wrong.

    The shape shows that a map is not equirectangular. Primaries that are no colours are ignored; all zeros, which
    writers leave where nobody knew any, are not worth a warning.
    """
    with path.open("rb") as file:
        head = file.read(_HEAD)
    size, primaries = _size_and_primaries(head)
    if size is not None and size[1] > 0 and abs(size[0] / size[1] - 2) >= 0.05:
        yield (f"{path}: {size[0]} x {size[1]} is not twice as wide as high; it is spread over the sphere as if it "
               "were: light probes and cube maps are not supported")
    if primaries is not None and any(primaries):
        try:
            to_rec_709(primaries)
        except ValueError as error:
            yield f"{path}: its primaries are ignored, Rec. 709 is used: {error}"


def _size_and_primaries(head: bytes) -> tuple[tuple[int, int] | None, Sequence[float] | None]:
    """(width, height) of the map and eight chromaticities, each None if the header does not have it."""
    header = read_hdr_header(head)
    if header is not None:
        return header.size, header.primaries
    if head.startswith(b"\x89PNG") and len(head) >= 24:
        return struct.unpack_from(">2I", head, 16), None
    if not head.startswith(b"\x76\x2f\x31\x01"):
        return None, None
    window, primaries = _attribute(head, _DISPLAY_WINDOW, "<4i"), _attribute(head, _CHROMATICITIES, "<8f")
    size = None if window is None else (window[2] - window[0] + 1, window[3] - window[1] + 1)
    return size, primaries


def _attribute(head: bytes, start: bytes, numbers: str) -> tuple | None:
    """The numbers of an attribute of an EXR that begins with `start`."""
    at = head.find(start) + len(start)
    if at < len(start) or at + struct.calcsize(numbers) > len(head):
        return None
    return struct.unpack_from(numbers, head, at)
