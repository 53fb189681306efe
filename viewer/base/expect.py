"""Checks the types of arguments where they enter the package, with errors of one line."""

from __future__ import annotations

import math
from numbers import Real
from os import PathLike

from ..errors import UsageError


def expect(value: object, kind: type | tuple[type, ...], name: str, wanted: str) -> None:
    """Raises UsageError if `value`, the argument called `name`, is not of type `kind`; `wanted` names it in words.

    True and False are no numbers here, although bool is a subclass of int.
    """
    if not isinstance(value, kind) or isinstance(value, bool):
        raise UsageError(f"{name} is of type {type(value).__name__}, not {wanted}")


def expect_path(value: object, name: str) -> None:
    """Raises UsageError if `value` is not a path, that is, neither text nor `os.PathLike`."""
    expect(value, (str, PathLike), name, "a path")


def expect_number(value: object, name: str) -> None:
    """Raises UsageError if `value` is not a real number, or is NaN. Infinity is a number."""
    expect(value, Real, name, "a number")
    if math.isnan(value):  # type: ignore[arg-type]
        raise UsageError(f"{name} is {value}, not a number")


def existing(count: int) -> str:
    """Which numbers of `count` things exist, counted from 0, for a message about one that does not."""
    return "there are none" if count == 0 else "only 0 exists" if count == 1 else f"only 0 to {count - 1} exist"
