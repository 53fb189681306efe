"""glTF's buffers, buffer views and data URIs."""

from __future__ import annotations

import base64
import binascii
from pathlib import Path
from urllib.parse import unquote_to_bytes

from ..files import path_inside, read_file
from .element import Element


class Buffers:
    """The file's buffers. Each is read once, when something in it is first used."""

    def __init__(self, root: Element) -> None:
        self._buffers = root.array("buffers")
        self.views = root.array("bufferViews")
        self._read: dict[int, memoryview] = {}

    def view(self, index: int) -> memoryview:
        """The bytes of a buffer view. Raises InputError if it ends after its buffer."""
        view = self.views[index]
        number = view.index("buffer", len(self._buffers))
        length, offset = view.integer("byteLength", low=1), view.integer("byteOffset", 0)
        data = self._buffer(number)
        if offset + length > len(data):
            raise view.error(f"ends at byte {offset + length}, but buffers[{number}] has {len(data)}", "byteLength")
        return data[offset:offset + length]

    @property
    def size(self) -> int:
        """The number of bytes in the buffers that were read so far."""
        return sum(map(len, self._read.values()))

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
            return read_uri(buffer, "uri")[0]
        if index != 0 or buffer.document.binary is None:
            raise buffer.error("is missing, and the file has no binary chunk for it", "uri")
        return buffer.document.binary


def read_uri(element: Element, key: str) -> tuple[memoryview, Path | None]:
    """The bytes of the URI at `key`, and the path of its file; None for a data URI."""
    uri = element.string(key)
    if uri[:5].lower() == "data:":
        return memoryview(_decode_data_uri(element, key, uri)), None
    path = path_inside(element.document.path, uri, element.at(key))
    return memoryview(read_file(path, str(element.document.path), element.at(key))), path


def _decode_data_uri(element: Element, key: str, uri: str) -> bytes:
    header, comma, body = uri.partition(",")
    if not comma:
        raise element.error("the data URI contains no data", key)
    if not header.lower().endswith(";base64"):
        return unquote_to_bytes(body)
    try:
        raw = unquote_to_bytes(body) if "%" in body else body.encode("ascii")
        # Some exporters omit the padding; RFC 4648, 3.2, allows readers to accept that.
        return base64.b64decode(raw + b"=" * (-len(raw) % 4), validate=True)
    except (binascii.Error, UnicodeEncodeError, ValueError) as error:
        raise element.error("the data URI is not valid base64", key) from error
