"""A cache on disk for precomputed data.

The key of an entry is a hash of the input's content, the parameters and the source code of this folder. So no entry has
to be invalidated: changed input or code has another key. An entry is written to a temporary file, which is then
renamed, and has a checksum. If all entries together exceed LIMIT, the least recently used ones are deleted. If those
of shadow maps exceed SHADOWS_LIMIT, these are deleted before the others, which take longer to compute again. If the
folder cannot be written, an entry is damaged or another process deletes it, the data is only computed again.

The environment variable PBR_VIEWER_CACHE names another folder, or is `off`.
"""

from __future__ import annotations

import hashlib
import json
import os
import struct
import time
import zlib
from contextlib import suppress
from functools import lru_cache
from pathlib import Path

import numpy as np

from ..base.digest import files_digest

LIMIT, SHADOWS_LIMIT = 512 << 20, 256 << 20  # bytes
SHADOWS = "shadows-"
"""The names of entries of shadow maps begin with it."""
_MAGIC = b"PBRV\x00\x01"
_HEADER = struct.Struct("<6sIQI")  # magic, bytes of JSON, bytes of data, CRC-32 of JSON and data
_ABANDONED = 3600.0  # age in seconds from which a temporary file of another process is deleted


def cache_folder() -> Path | None:
    """The folder of the cache, which may not exist yet; None if the cache is switched off."""
    chosen = os.environ.get("PBR_VIEWER_CACHE", "")
    if chosen.lower() == "off":
        return None
    if chosen:
        return Path(chosen)
    from platformdirs import user_cache_dir

    return Path(user_cache_dir("pbr-viewer", appauthor=False))


def key(*parts: object) -> str:
    """The key of data that is computed from `parts` (strings and numbers) by this folder's code."""
    text = json.dumps([_code_digest(), *parts])
    return hashlib.blake2b(text.encode(), digest_size=20).hexdigest()


def load(name: str) -> dict[str, np.ndarray] | None:
    """The arrays stored under `name`, read-only; None if there is no such entry or it is damaged."""
    path = _path(name)
    if path is None:
        return None
    try:
        blob = path.read_bytes()
        with suppress(OSError):
            os.utime(path)
        return _unpack(blob)
    except (OSError, ValueError, KeyError, TypeError, struct.error):
        return None


def store(name: str, arrays: dict[str, np.ndarray]) -> None:
    """Store `arrays` under `name`. If that fails, nothing happens."""
    path = _path(name)
    if path is None:
        return
    temporary = path.with_name(f".{path.name}.{os.getpid()}-{os.urandom(4).hex()}")
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        with temporary.open("wb") as file:
            file.writelines(_pack(arrays))
        os.replace(temporary, path)
    except OSError:
        with suppress(OSError):
            temporary.unlink()
        return
    _trim(path.parent)


def cache_size() -> int:
    """The size of all entries in bytes."""
    folder, size = cache_folder(), 0
    for path in _entries(folder) if folder else []:
        with suppress(OSError):  # another process may have removed it
            size += path.stat().st_size
    return size


def clear_cache() -> int:
    """Delete all entries. Returns the number of bytes freed."""
    folder = cache_folder()
    return sum(_remove(path) for path in _entries(folder)) if folder else 0


def _path(name: str) -> Path | None:
    folder = cache_folder()
    return folder / f"{name}.bake" if folder else None


def _entries(folder: Path) -> list[Path]:
    with suppress(OSError):
        return [path for path in folder.iterdir() if ".bake" in path.name]
    return []


def _remove(path: Path) -> int:
    with suppress(OSError):
        size = path.stat().st_size
        path.unlink()
        return size
    return 0


def _trim(folder: Path) -> None:
    """Delete the least recently used entries until both limits are kept, and abandoned temporary files."""
    found = []
    for path in _entries(folder):
        with suppress(OSError):
            status = path.stat()
            if path.name.startswith("."):
                if time.time() - status.st_mtime > _ABANDONED:
                    _remove(path)
            else:
                found.append((status.st_mtime, status.st_size, path))
    found.sort(key=lambda entry: entry[0])
    for prefix, limit in ((SHADOWS, SHADOWS_LIMIT), ("", LIMIT)):
        excess = sum(size for _, size, path in found if path.name.startswith(prefix)) - limit
        for entry in [entry for entry in found if entry[2].name.startswith(prefix)]:
            if excess <= 0:
                break
            excess -= entry[1]
            found.remove(entry)
            _remove(entry[2])


def _pack(arrays: dict[str, np.ndarray]) -> list[bytes | memoryview]:
    """What is written, one part after the other; the arrays, which may be large, are not copied."""
    arrays = {name: np.ascontiguousarray(array) for name, array in arrays.items()}
    index = [[name, array.dtype.str, array.shape] for name, array in arrays.items()]
    head = json.dumps(index).encode()
    data = [array.reshape(-1).view(np.uint8).data for array in arrays.values()]
    checksum = zlib.crc32(head)
    for part in data:
        checksum = zlib.crc32(part, checksum)
    return [_HEADER.pack(_MAGIC, len(head), sum(part.nbytes for part in data), checksum), head, *data]


def _unpack(blob: bytes) -> dict[str, np.ndarray]:
    magic, head_size, data_size, checksum = _HEADER.unpack_from(blob)
    body = memoryview(blob)[_HEADER.size:]
    if magic != _MAGIC or len(body) != head_size + data_size or zlib.crc32(body) != checksum:
        raise ValueError("not a whole entry")
    arrays, offset = {}, _HEADER.size + head_size
    for name, dtype, shape in json.loads(bytes(body[:head_size])):
        array = np.frombuffer(blob, np.dtype(dtype), int(np.prod(shape)), offset).reshape(shape)
        arrays[name] = array
        offset += array.nbytes
    return arrays


@lru_cache(maxsize=1)
def _code_digest() -> str:
    """A digest of the source files that compute the entries. If one changes, no old entry is found any more."""
    here = Path(__file__).resolve().parent
    return files_digest([*sorted(here.glob("*.py")), here.parent / "scene" / "equirect.py"])
