"""glTF's buffers, buffer views and data URIs."""

from __future__ import annotations

import base64
import binascii
from pathlib import Path
from urllib.parse import unquote_to_bytes

from ..files import path_inside, read_file
from . import meshopt
from .element import Element

MIN_DECODED, MAX_EXPANSION = 1 << 26, 32
"""Compressed views may decode to MIN_DECODED bytes in all, or to MAX_EXPANSION times the buffers, whichever is more.
Constant attributes may shrink to a thousandth, meshes to a tenth."""
TYPICAL_EXPANSION = 8

MIN_CLAIM, MAX_SHARING = 1 << 24, 4
"""A file may make us allocate MIN_CLAIM elements in all, or MAX_SHARING elements per byte of its buffers, whichever is
more."""


class Buffers:
    """The file's buffers. Each is read once, and each compressed view decoded once, when it is first used."""

    def __init__(self, root: Element) -> None:
        self._buffers = root.array("buffers")
        self.views = root.array("bufferViews")
        self._read: dict[int, memoryview] = {}
        self._decoded: dict[int, memoryview] = {}
        self._compressed = self._claimed = 0

    def view(self, index: int) -> memoryview:
        """The bytes of a buffer view, decoded if it is compressed. Raises InputError if it ends after its buffer, or
        if it is broken or too large when it is decoded."""
        view = self.views[index]
        compressed = meshopt.compression(view)
        if compressed is None:
            return self._slice(view)
        # The buffer of the view itself is for readers without the extension, and may have no bytes.
        if index not in self._decoded:
            self._decoded[index] = self._decode(view, compressed)
        return self._decoded[index]

    def claim(self, place: Element, count: int, what: str = "") -> None:
        """Count `count` elements that are allocated for the file. Raises InputError at `place` if they are too many;
        `what` says in the file's terms what needs them.

        An accessor without a buffer view (all zeros) takes no bytes in the file, and any number of primitives may use
        the same bytes. So a small file could demand any amount of memory; the limit depends on the file's size.
        """
        self._claimed += count
        if self._claimed > max(MIN_CLAIM, MAX_SHARING * self.size):
            what = what or f"{self._claimed} elements in all"
            raise place.error(f"{what} are too many for {self.size} bytes of buffers")

    def compressed(self, index: int) -> memoryview:
        """The bytes of a buffer view that holds compressed elements of accessors."""
        data = self.view(index)
        self._compressed += len(data)
        return data

    def _decode(self, view: Element, compressed: Element) -> memoryview:
        data = self._slice(compressed)
        self._compressed += len(data)
        size = meshopt.decoded_size(view, compressed)
        total = size + sum(map(len, self._decoded.values()))
        if total > max(MIN_DECODED, MAX_EXPANSION * sum(map(len, self._read.values()))):
            raise compressed.error(f"{total} decoded bytes in all are too many for buffers of this size", "count")
        return meshopt.decode(compressed, data)

    def _slice(self, view: Element) -> memoryview:
        number = view.index("buffer", len(self._buffers))
        length, offset = view.integer("byteLength", low=1), view.integer("byteOffset", 0)
        data = self._buffer(number)
        if offset + length > len(data):
            raise view.error(f"ends at byte {offset + length}, but buffers[{number}] has {len(data)}", "byteLength")
        return data[offset:offset + length]

    @property
    def size(self) -> int:
        """The number of bytes in the buffers that were read so far. A compressed one counts TYPICAL_EXPANSION times."""
        stored = sum(map(len, self._read.values()))
        return stored + (TYPICAL_EXPANSION - 1) * min(self._compressed, stored)

    def _buffer(self, index: int) -> memoryview:
        if index not in self._read:
            buffer = self._buffers[index]
            length = buffer.integer("byteLength", low=1)
            data = self._load(buffer, index)
            if len(data) < length:
                raise buffer.error(f"{length} bytes are declared, but there are only {len(data)}", "byteLength")
            self._read[index] = data[:length]
        return self._read[index]

    def _load(self, buffer: Element, index: int) -> memoryview:
        if "uri" in buffer:
            return read_uri(buffer)[0]
        if index != 0 or buffer.document.binary is None:
            raise buffer.error("is missing, and the file has no binary chunk for it", "uri")
        return buffer.document.binary


def read_uri(element: Element) -> tuple[memoryview, Path | None]:
    """The bytes of the element's URI, and the path of its file; None for a data URI."""
    uri = element.string("uri")
    if uri[:5].lower() == "data:":
        return memoryview(_decode_data_uri(element, uri)), None
    path = path_inside(element.document.path, uri, element.at("uri"))
    return memoryview(read_file(path, str(element.document.path), element.at("uri"))), path


def _decode_data_uri(element: Element, uri: str) -> bytes:
    header, comma, body = uri.partition(",")
    if not comma:
        raise element.error("the data URI contains no data", "uri")
    if not header.lower().endswith(";base64"):
        return unquote_to_bytes(body)
    try:
        raw = unquote_to_bytes(body) if "%" in body else body.encode("ascii")
        # Some exporters omit the padding; RFC 4648, 3.2, allows readers to accept that.
        return base64.b64decode(raw + b"=" * (-len(raw) % 4), validate=True)
    except (binascii.Error, UnicodeEncodeError, ValueError) as error:
        raise element.error("the data URI is not valid base64", "uri") from error
