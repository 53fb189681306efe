"""Short digests of everything that a result depends on: if two digests are equal, the result can be reused."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Iterable, Mapping
from dataclasses import fields, is_dataclass
from functools import lru_cache
from pathlib import Path
from typing import Any

import numpy as np

from .resources import resource_folder

_SIZE = 12
_PARTS = ("scene", "bake", "gpu", "image", "material", "plan", "raster", "trace", "settings.py")
"""The parts of the package, beside the shaders, that pictures depend on."""


def digest(*things: Any) -> str:
    """The digest of the content of dataclasses, arrays, containers and plain values.

    The `name` of a dataclass is not included. A class whose fields do not describe its content defines
    `digest_parts()`, which returns the values to include instead.
    """
    state = hashlib.blake2b(digest_size=_SIZE)
    for thing in things:
        _add(state, thing, {})
    return state.hexdigest()


def files_digest(paths: Iterable[Path]) -> str:
    """The digest of the names and the content of files."""
    state = hashlib.blake2b(digest_size=_SIZE)
    for path in paths:
        state.update(path.name.encode() + path.read_bytes())
    return state.hexdigest()


@lru_cache(maxsize=1)
def code_digest() -> str:
    """The digest of all code that pictures depend on."""
    package = Path(__file__).resolve().parents[1]
    files = [path for part in _PARTS for path in sorted([package / part, *(package / part).rglob("*.py")])]
    files += sorted(resource_folder("shaders").rglob("*"))
    return files_digest(path for path in files if path.is_file())


def _add(state: Any, thing: Any, seen: dict[int, int]) -> None:
    """Add `thing` to the hash. `seen` numbers the dataclasses added before, so that a shared texture is read once."""
    state.update(type(thing).__name__.encode())
    if isinstance(thing, np.ndarray):
        state.update(f"{thing.dtype}{thing.shape}".encode() + np.ascontiguousarray(thing).tobytes())
    elif isinstance(thing, (bytes, memoryview)):
        state.update(thing)
    elif is_dataclass(thing):
        if id(thing) in seen:
            state.update(str(seen[id(thing)]).encode())
            return
        seen[id(thing)] = len(seen)
        if hasattr(thing, "digest_parts"):
            _add(state, thing.digest_parts(), seen)
        else:
            _add(state, {field.name: getattr(thing, field.name) for field in fields(thing) if field.name != "name"},
                 seen)
    elif isinstance(thing, Mapping):
        for key in sorted(thing):
            _add(state, (key, thing[key]), seen)
    elif isinstance(thing, (list, tuple)):
        for part in thing:
            _add(state, part, seen)
    else:
        state.update(json.dumps(thing, default=repr).encode() + b";")
