"""The two container formats of glTF 2.0: a JSON text, or a GLB with a JSON chunk and a binary chunk."""

from __future__ import annotations

import struct
from pathlib import Path

from ...errors import InputError
from ..json_text import parse_json

GLB_MAGIC = b"glTF"
_JSON_CHUNK = 0x4E4F534A
_BIN_CHUNK = 0x004E4942


def read_container(path: Path, data: bytes) -> tuple[dict, memoryview | None, str]:
    """The JSON object, the binary chunk or None, and the format's name (GLB or glTF).

    Raises InputError for any other content.
    """
    if data[:4] == GLB_MAGIC:
        text, binary = _split_glb(path, memoryview(data))
        # Padding should be spaces, but writers exist that pad with NUL.
        return _parse_json(path, bytes(text).rstrip(b"\0")), binary, "GLB"
    if path.suffix.lower() == ".glb" and data.lstrip()[:1] != b"{":
        raise InputError(path, "header", "not a GLB file: it does not begin with 'glTF'")
    return _parse_json(path, data), None, "glTF"


def _split_glb(path: Path, data: memoryview) -> tuple[memoryview, memoryview | None]:
    if len(data) < 12:
        raise InputError(path, "header", "the file ends inside the 12-byte header")
    _, version, length = struct.unpack_from("<4sII", data)
    if version != 2:
        raise InputError(path, "header.version", f"GLB version {version}; only 2 is supported")
    if length > len(data):
        raise InputError(path, "header.length", f"{length} bytes are declared, the file has {len(data)}")
    chunks: list[tuple[int, memoryview]] = []
    offset = 12
    while offset < length:
        place = f"chunks[{len(chunks)}]"
        if offset + 8 > length:
            raise InputError(path, place, "the file ends inside a chunk header")
        size, kind = struct.unpack_from("<II", data, offset)
        if offset + 8 + size > length:
            raise InputError(path, place, f"{size} bytes are declared, {length - offset - 8} are left")
        chunks.append((kind, data[offset + 8:offset + 8 + size]))
        offset += 8 + size
    if not chunks or chunks[0][0] != _JSON_CHUNK:
        raise InputError(path, "chunks[0]", "the first chunk of a GLB must be its JSON")
    binary = chunks[1][1] if len(chunks) > 1 and chunks[1][0] == _BIN_CHUNK else None
    return chunks[0][1], binary


def _parse_json(path: Path, text: bytes) -> dict:
    root = parse_json(path, text)
    if not isinstance(root, dict):
        raise InputError(path, "", "the JSON of a glTF must be an object")
    return root
