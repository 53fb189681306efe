"""What a browser sends about mouse, keys and size, checked: it may send anything."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Literal

FARTHEST = 1e5
"""The largest number of pixels that is believed."""
MOST_NOTCHES = 100.0
"""Of a wheel, at a time."""


class BadMessage(Exception):
    """Something that our page does not send."""


@dataclass(frozen=True)
class Message:
    """`kind` says which of the others are meant.

    Lengths are in pixels of the browser's page; `x` and `y` lie in the picture as it is shown there, whose size is
    `width` x `height`. Those of a "size" are pixels of the screen.
    """

    kind: Literal["size", "move", "press", "release", "cancel", "wheel", "key"]
    x: float = 0.0
    y: float = 0.0
    width: float = 1.0
    height: float = 1.0
    dx: float = 0.0
    dy: float = 0.0
    is_left: bool = True
    shift: bool = False
    key: str = ""


_NUMBERS = {"size": ("width", "height"), "move": ("x", "y", "width", "height"),
            "press": ("x", "y", "width", "height"), "release": ("x", "y", "width", "height"), "cancel": (),
            "wheel": ("x", "y", "width", "height", "dx", "dy"), "key": ()}
_FLAGS = {"press": ("is_left", "shift"), "release": ("is_left", "shift"), "wheel": ("shift",)}


def message_of(content: Any) -> Message:
    """The message that decoded JSON is. Raises BadMessage."""
    if not isinstance(content, dict) or not isinstance(content.get("kind"), str) or content["kind"] not in _NUMBERS:
        raise BadMessage("no kind of message")
    kind = content["kind"]
    values: dict[str, Any] = {name: _number(content.get(name), name) for name in _NUMBERS[kind]}
    for name in ("width", "height"):
        if values.get(name, 1.0) < 1:
            raise BadMessage(f"{name} is less than a pixel")
    for name in _FLAGS.get(kind, ()):
        if not isinstance(content.get(name), bool):
            raise BadMessage(f"{name} is neither true nor false")
        values[name] = content[name]
    if kind == "key":
        key = content.get("key")
        if not isinstance(key, str) or len(key) > 32:
            raise BadMessage("no name of a key")
        values["key"] = key
    return Message(kind, **values)


def _number(value: object, name: str) -> float:
    if isinstance(value, bool) or not isinstance(value, (int, float)):
        raise BadMessage(f"{name} is no number")
    if not abs(value) <= (MOST_NOTCHES if name in ("dx", "dy") else FARTHEST):  # NaN is no less
        raise BadMessage(f"{name} is out of range")
    return float(value)
