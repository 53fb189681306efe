"""Arrays as a scene holds them: of one type and shape, of finite numbers, and read-only."""

from __future__ import annotations

from math import isfinite
from typing import Any

import numpy as np

from ..errors import UsageError

_FEW = 64
"""The most numbers that are looked at one by one."""


class HoldsArrays:
    """Base of frozen dataclasses whose `__post_init__` checks and converts their fields.

    It does so again in a copy and in another process, for numpy's copies of read-only arrays are writable.
    """

    def _set(self, name: str, value: object) -> None:
        object.__setattr__(self, name, value)

    def __setstate__(self, state: dict[str, object]) -> None:
        self.__dict__.update(state)
        self.__post_init__()

    def __post_init__(self) -> None:
        raise NotImplementedError


def scene_array(values: Any, name: str, dtype: type, *shape: int | None) -> np.ndarray:
    """`values` as a read-only array of `dtype` and `shape`, in which None is any length.

    An array that is read-only already is taken as it is, a writable one is copied: whoever holds it may change it, and
    what a renderer keeps is found again by identity. Raises UsageError, which begins with `name`, for other shapes, for
    what is not real numbers, is not finite, or does not fit `dtype`.
    """
    try:
        array = np.asarray(values)
    except (TypeError, ValueError):  # rows of different lengths
        array = np.array(None)
    if array.dtype.kind not in "biuf":
        raise UsageError(f"{name}: {type(values).__name__} is no array of numbers {_words(shape, dtype)}")
    if array.ndim != len(shape) or any(n is not None and n != size for n, size in zip(shape, array.shape)):
        raise UsageError(f"{name} is {_found(array)}, not {_words(shape, dtype)}")
    if np.dtype(dtype).kind == "u":
        if array.dtype.kind not in "iu" and array.size:
            raise UsageError(f"{name} is {_found(array)}, not whole numbers {_words(shape, dtype)}")
        if array.size and (array.min() < 0 or array.max() > np.iinfo(dtype).max):
            raise UsageError(f"{name} {_found(array)}: {array.min()} to {array.max()} do not fit {np.dtype(dtype)}")
    result = array
    if array.dtype != dtype or array.flags.writeable or not array.flags.c_contiguous:
        with np.errstate(over="ignore"):
            result = array.astype(dtype, order="C", copy=array.flags.writeable)
    if result.dtype.kind == "f" and not _is_finite(result):
        raise UsageError(f"{name} {_found(array)}: holds NaN or what is no finite {np.dtype(dtype)}")
    result.flags.writeable = False
    return result


def _is_finite(array: np.ndarray) -> bool:
    if array.size <= _FEW:  # such as the matrix of an instance, of which there may be a million
        return all(map(isfinite, array.ravel().tolist()))
    return bool(np.isfinite(array.min()) and np.isfinite(array.max()))


def scene_numbers(values: Any, name: str, count: int) -> tuple[float, ...]:
    """`count` finite numbers. Raises UsageError as `scene_array` does."""
    if type(values) is tuple and len(values) == count and all(type(v) is float and isfinite(v) for v in values):
        return values  # what a scene of many lights holds; an array for each would take most of its time
    return tuple(scene_array(values, name, np.float64, count).tolist())


def check_flag(value: Any, name: str) -> None:
    """Raises UsageError, which begins with `name`, for all but True and False; 0, 1 and numpy's are taken, too."""
    if not isinstance(value, (int, np.bool_)) or value not in (0, 1):
        raise UsageError(f"{name} is {value!r}, not True or False")


def rows_of(array: np.ndarray | None, source: np.ndarray) -> np.ndarray | None:
    """Row source[k] of the array as row k; None of None."""
    return None if array is None else array[source]


def _words(shape: tuple[int | None, ...], dtype: type) -> str:
    return f"({', '.join('N' if n is None else str(n) for n in shape)}{',' * (len(shape) == 1)}) {np.dtype(dtype)}"


def _found(array: np.ndarray) -> str:
    return f"{array.shape} {array.dtype}"
