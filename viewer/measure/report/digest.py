"""What a measurement depends on, as a short name: equal names mean that it need not be made again."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Mapping
from dataclasses import fields, is_dataclass
from functools import lru_cache
from pathlib import Path
from typing import Any

import numpy as np

from ...base.resources import resource_folder
from ...scene.environment import Environment
from ...scene.scene import Scene

_SIZE = 12
_PARTS = ("scene", "bake", "gpu", "image", "material", "plan", "raster", "trace", "settings.py")
"""Of the package, beside its shaders: what makes pictures."""


def digest(*things: Any) -> str:
    """Of dataclasses, arrays, containers and plain values, by their content."""
    state = hashlib.blake2b(digest_size=_SIZE)
    for thing in things:
        _add(state, thing, {})
    return state.hexdigest()


@lru_cache(maxsize=1)
def code_digest() -> str:
    """Of all code that a picture comes from."""
    state = hashlib.blake2b(digest_size=_SIZE)
    package = Path(__file__).resolve().parents[2]
    files = [path for part in _PARTS for path in sorted([package / part, *(package / part).rglob("*.py")])]
    files += sorted(resource_folder("shaders").rglob("*"))
    for path in files:
        if path.is_file():
            state.update(path.name.encode() + path.read_bytes())
    return state.hexdigest()


def _add(state: Any, thing: Any, seen: dict[int, int]) -> None:
    """`seen` numbers what was met before, so that a texture many materials share is read once."""
    state.update(type(thing).__name__.encode())
    if isinstance(thing, np.ndarray):
        state.update(f"{thing.dtype}{thing.shape}".encode() + np.ascontiguousarray(thing).tobytes())
    elif isinstance(thing, (bytes, memoryview)):
        state.update(thing)
    elif isinstance(thing, Environment):
        _add(state, (thing.rotation, thing.intensity, thing.digest or thing.radiance), seen)
    elif is_dataclass(thing):
        if id(thing) in seen:
            state.update(str(seen[id(thing)]).encode())
            return
        seen[id(thing)] = len(seen)
        left_out = ("warnings", "facts", "name") if isinstance(thing, Scene) else ("name",)
        for field in fields(thing):
            if field.name not in left_out:
                state.update(field.name.encode())
                _add(state, getattr(thing, field.name), seen)
    elif isinstance(thing, Mapping):
        for key in sorted(thing):
            _add(state, (key, thing[key]), seen)
    elif isinstance(thing, (list, tuple)):
        for part in thing:
            _add(state, part, seen)
    else:
        state.update(json.dumps(thing, default=repr).encode() + b";")
