"""What was expensive to prepare, kept on disk by content.

An entry's key is a hash of the input's content, the parameters and the source of this folder, so nothing ever has to be
invalidated: what changes gets another key. Entries are written to a temporary file and renamed, carry a checksum, and
are dropped, the least recently used first, when all together pass LIMIT. A folder that cannot be written, a damaged
entry, another process at work: each only means that the thing is made again.

$PBR_VIEWER_CACHE names another folder, or is `off`.
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

LIMIT = 512 << 20  # bytes
_MAGIC = b"PBRV\x00\x01"
_HEADER = struct.Struct("<6sIQI")  # magic, bytes of JSON, bytes of data, CRC-32 of JSON and data
_ABANDONED = 3600.0  # seconds after which another process's temporary file is nobody's


def cache_folder() -> Path | None:
    """Where entries lie, whether or not it exists yet; None when the cache is switched off."""
    chosen = os.environ.get("PBR_VIEWER_CACHE", "")
    if chosen.lower() == "off":
        return None
    if chosen:
        return Path(chosen)
    from platformdirs import user_cache_dir

    return Path(user_cache_dir("pbr-viewer", appauthor=False))


def key(*parts: object) -> str:
    """A name for what `parts` (strings and numbers) determine together with this folder's code."""
    text = json.dumps([_code_digest(), *parts])
    return hashlib.blake2b(text.encode(), digest_size=20).hexdigest()


def load(name: str) -> dict[str, np.ndarray] | None:
    """The arrays stored under `name`, read-only; None where there is no such entry, or not a whole one."""
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


def has(name: str) -> bool:
    """Whether there is an entry `name`, whole or not."""
    path = _path(name)
    return path is not None and path.is_file()


def store(name: str, arrays: dict[str, np.ndarray]) -> None:
    """Keep arrays under `name`. Failing to is no error."""
    path = _path(name)
    if path is None:
        return
    temporary = path.with_name(f".{path.name}.{os.getpid()}-{os.urandom(4).hex()}")
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        temporary.write_bytes(_pack(arrays))
        os.replace(temporary, path)
    except OSError:
        with suppress(OSError):
            temporary.unlink()
        return
    _trim(path.parent)


def cache_size() -> int:
    """Bytes all entries take."""
    folder, size = cache_folder(), 0
    for path in _entries(folder) if folder else []:
        with suppress(OSError):  # another process may have removed it
            size += path.stat().st_size
    return size


def clear_cache() -> int:
    """Remove every entry; the bytes freed."""
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
    """Down to LIMIT, the least recently used first; temporary files that nobody will finish go too."""
    found = []
    for path in _entries(folder):
        with suppress(OSError):
            status = path.stat()
            if path.name.startswith("."):
                if time.time() - status.st_mtime > _ABANDONED:
                    _remove(path)
            else:
                found.append((status.st_mtime, status.st_size, path))
    excess = sum(size for _, size, _ in found) - LIMIT
    for _, size, path in sorted(found, key=lambda entry: entry[0]):
        if excess <= 0:
            break
        excess -= size
        _remove(path)


def _pack(arrays: dict[str, np.ndarray]) -> bytes:
    arrays = {name: np.ascontiguousarray(array) for name, array in arrays.items()}
    index = [[name, array.dtype.str, array.shape] for name, array in arrays.items()]
    head = json.dumps(index).encode()
    data = b"".join(array.tobytes() for array in arrays.values())
    return _HEADER.pack(_MAGIC, len(head), len(data), zlib.crc32(data, zlib.crc32(head))) + head + data


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
    """Of the sources that make the entries: a change to any of them makes all old entries unreachable."""
    here = Path(__file__).resolve().parent
    return files_digest([*sorted(here.glob("*.py")), here.parent / "scene" / "equirect.py"])
