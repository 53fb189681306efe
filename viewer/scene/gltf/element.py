"""Access to glTF's JSON with checks: a value has the type that the schema demands, or an InputError names its place."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, TypeVar

from ...base.expect import existing
from ...errors import InputError

T = TypeVar("T")
_MISSING: Any = object()
MAX_WARNINGS = 32
"""The most warnings for one file; a file may have thousands of equal mistakes."""


@dataclass(eq=False)
class Document:
    """The state that all elements of one file share."""

    path: Path
    binary: memoryview | None = None
    warnings: list[str] = field(default_factory=list)
    extensions: frozenset[str] = frozenset()
    """Those that the file says it uses."""

    def warn(self, text: str) -> None:
        if text not in self.warnings and len(self.warnings) < MAX_WARNINGS:
            self.warnings.append(text)


class Element:
    """A JSON object and its place in the file, such as ``materials[2].pbrMetallicRoughness``.

    The methods read the value at `key` of the object. If the key is missing they return `default`, or raise InputError
    if no default is given.
    """

    __slots__ = ("document", "place", "value")

    def __init__(self, document: Document, value: Any, place: str = "") -> None:
        self.document, self.place = document, place
        self.value: dict = self._typed(value, dict, "an object", place)

    def at(self, key: str) -> str:
        return f"{self.place}.{key}" if self.place else key

    def error(self, problem: str, key: str = "") -> InputError:
        return InputError(self.document.path, self.at(key) if key else self.place, problem)

    def warn(self, problem: str, key: str = "") -> None:
        self.document.warn(f"{self.at(key) if key else self.place}: {problem}")

    def __contains__(self, key: str) -> bool:
        return key in self.value

    def _typed(self, value: Any, types: type | tuple[type, ...], what: str, place: str) -> Any:
        # In Python a bool is an int; in JSON it is not.
        if not isinstance(value, types) or (isinstance(value, bool) and types is not bool):
            raise InputError(self.document.path, place, f"must be {what}, not {_json_type(value)}")
        return value

    def _get(self, key: str, types: type | tuple[type, ...], what: str, default: Any) -> Any:
        value = self.value.get(key, _MISSING)
        if value is not _MISSING:
            return self._typed(value, types, what, self.at(key))
        if default is _MISSING:
            raise self.error("is missing", key)
        return default

    def string(self, key: str, default: Any = _MISSING) -> str:
        return self._get(key, str, "a string", default)

    def boolean(self, key: str, default: bool) -> bool:
        return self._get(key, bool, "true or false", default)

    def integer(self, key: str, default: Any = _MISSING, low: int = 0) -> int:
        value = self._get(key, (int, float), "an integer", default)
        if value is not default:
            value = self._whole(value, key)
        if value is not default and value < low:
            raise self.error(f"must be at least {low}, not {value}", key)
        return value

    def index(self, key: str, count: int, default: Any = _MISSING) -> int:
        """An index into an array of `count` elements."""
        value = self.integer(key, default)
        if value is not default and value >= count:
            raise self.error(f"index {value}, but {existing(count)}", key)
        return value

    def indices(self, key: str, count: int) -> list[int]:
        """An array of indices into an array of `count` elements; empty if it is missing."""
        values = [self._whole(self._typed(value, (int, float), "an integer", f"{self.at(key)}[{k}]"), f"{key}[{k}]")
                  for k, value in enumerate(self._get(key, list, "an array", []))]
        for k, value in enumerate(values):
            if not 0 <= value < count:
                raise self.error(f"index {value}, but {existing(count)}", f"{key}[{k}]")
        return values

    def number(self, key: str, default: Any = _MISSING, low: float = -math.inf, high: float = math.inf) -> float:
        """A finite number. A number outside low..high is clamped, with a warning."""
        value = self._get(key, (int, float), "a number", default)
        return value if value is default else self._clamped(value, key, low, high)

    def vector(self, key: str, size: int, default: Any = _MISSING, low: float = -math.inf,
               high: float = math.inf) -> Any:
        """A tuple of `size` finite numbers. Numbers outside low..high are clamped, with a warning."""
        values = self._get(key, list, f"an array of {size} numbers", default)
        if values is default:
            return values
        if len(values) != size:
            raise self.error(f"must have {size} numbers, not {len(values)}", key)
        return tuple(self._clamped(self._typed(v, (int, float), "a number", f"{self.at(key)}[{k}]"), key, low, high)
                     for k, v in enumerate(values))

    def numbers(self, key: str) -> list[float] | None:
        """An array of any length of finite numbers; None if it is missing."""
        values = self._get(key, list, "an array of numbers", None)
        return None if values is None else list(self.vector(key, len(values)))

    def choice(self, key: str, choices: dict[Any, T], default: Any) -> T:
        """The value mapped by `choices`. An unknown value is replaced by `default`, with a warning."""
        value = self.string(key, default) if isinstance(default, str) else self.integer(key, default, -(1 << 53))
        if value not in choices:
            self.warn(f"{value!r} is unknown; {default!r} is used", key)
            value = default
        return choices[value]

    def object(self, key: str) -> Element:
        """The object at `key`; an empty one if it is missing."""
        return Element(self.document, self.value.get(key, {}), self.at(key))

    def array(self, key: str) -> list[Element]:
        """The array of objects at `key`; empty if it is missing."""
        place = self.at(key)
        return [Element(self.document, value, f"{place}[{k}]")
                for k, value in enumerate(self._get(key, list, "an array", []))]

    def extension(self, name: str) -> Element | None:
        extensions = self.object("extensions")
        return extensions.object(name) if name in extensions else None

    def _whole(self, value: float, key: str) -> int:
        """`value`, which may be written as 1.0, as an integer that JSON's readers agree about (RFC 8259, 6)."""
        if not -(1 << 53) < value < 1 << 53:
            raise self.error("must be an integer below 2^53", key)
        if value != int(value):
            raise self.error(f"must be an integer, not {value}", key)
        return int(value)

    def _clamped(self, value: float, key: str, low: float, high: float) -> float:
        try:
            value = float(value)
        except OverflowError:
            value = math.inf
        if not math.isfinite(value):
            raise self.error("must be a finite number", key)
        if low <= value <= high:
            return value
        self.warn(f"{value:g} is out of range; {min(max(value, low), high):g} is used", key)
        return min(max(value, low), high)


def _json_type(value: Any) -> str:
    names = {dict: "an object", list: "an array", str: "a string", bool: "true or false", type(None): "null"}
    return names.get(type(value), "a number")
