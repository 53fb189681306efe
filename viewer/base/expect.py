"""Checks the types of arguments where they enter the package, with errors of one line."""

from __future__ import annotations

import math
from numbers import Integral, Real
from operator import index
from os import PathLike
from typing import Any

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


def expect_index(value: Any, name: str, of: str) -> None:
    """Raises UsageError if `value` is no whole number from 0 on; `of` says what it counts."""
    if type(value) is int and value >= 0:
        return  # without a text that a million instances would format in vain
    expect(value, Integral, name, f"the number of {of}")
    if value < 0:
        raise UsageError(f"{name} is {value}, not the number of {of}, which count from 0")


def expect_number(value: Any, name: str, low: float = -math.inf, high: float = math.inf, *,
                  special: float | None = None, is_finite: bool = False) -> None:
    """Raises UsageError if `value` is not a real number from `low` to `high` or `special`, or is NaN. Infinity is a
    number unless `is_finite`."""
    expect(value, Real, name, "a number")
    try:
        is_nan = math.isnan(value)
    except OverflowError:  # of an int
        raise UsageError(f"{name} is beyond 1.8e308, the largest number that a float holds") from None
    if is_nan:
        raise UsageError(f"{name} is {value}, not a number")
    if is_finite and math.isinf(value):
        raise UsageError(f"{name} is {value}, not a finite number")
    if not low <= value <= high and value != special:
        raise UsageError(f"{name} is {value}, not {range_words(low, high, special)}")


def expect_positive(value: Any, name: str, *, is_finite: bool = True) -> None:
    """Raises UsageError if `value` is not a real number above 0."""
    expect_number(value, name, is_finite=is_finite)
    if value <= 0:
        raise UsageError(f"{name} is {value}, not above 0")


def expect_size(value: Any, name: str) -> tuple[int, int]:
    """`value` as (width, height). Raises UsageError if it is not two whole numbers above 0."""
    try:
        width, height = map(index, value)
    except (TypeError, ValueError):
        width = height = 0
    if width < 1 or height < 1:
        raise UsageError(f"{name}={value!r}: it must be (width, height), two positive whole numbers of pixels")
    return width, height


def range_words(low: float, high: float, special: float | None = None) -> str:
    """A range of numbers, of which at least one end is finite: "0 or at least 1"."""
    words = f"at least {low:g}" if high == math.inf else f"at most {high:g}" if low == -math.inf else (
        f"from {low:g} to {high:g}")
    return words if special is None else f"{special:g} or {words}"


def existing(count: int) -> str:
    """Which numbers of `count` things exist, counted from 0, for a message about one that does not."""
    return "there are none" if count == 0 else "only 0 exists" if count == 1 else f"only 0 to {count - 1} exist"
