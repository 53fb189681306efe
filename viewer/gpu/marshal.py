"""Converts numpy values to the 32-bit words of GLSL parameters, and the words of GLSL results to numpy values."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import Any

import numpy as np

from ..errors import UsageError
from .glsl_types import Basic, Type

_DTYPES: dict[str, Any] = {"float": np.float32, "int": np.int32, "uint": np.uint32, "bool": np.uint32}


def to_words(type_: Type, value: Any, place: str) -> list[np.ndarray]:
    """One uint32 array (..., n) for each leaf of `type_`, with the leading axes of `value`; n is the leaf's number of
    words.

    Raises UsageError, which names the parameter as `place`, if `value` does not fit the type.
    """
    if isinstance(type_, Basic):
        return [_leaf_words(type_, value, place)]
    if isinstance(value, Mapping):
        names = [name for name, _ in type_.members]
        if set(value) != set(names):
            raise UsageError(f"{place}: {type_.name} has the members {', '.join(names)}, not {', '.join(value)}")
        return [words for name, member in type_.members for words in to_words(member, value[name], f"{place}.{name}")]
    array, leaves = _array(value, place), type_.leaves()
    width = sum(leaf.size for leaf in leaves)
    if array.shape[-1:] != (width,):
        raise UsageError(f"{place}: {type_.name} takes a dict, or an array whose last axis has its {width} components, "
                         f"not the shape {array.shape}")
    ends = np.cumsum([leaf.size for leaf in leaves])
    parts = np.split(array, ends[:-1], axis=-1)
    return [_leaf_words(leaf, part.reshape(part.shape[:-1] + leaf.shape), place) for leaf, part in zip(leaves, parts)]


def _array(value: Any, place: str) -> np.ndarray:
    try:
        return np.asarray(value)
    except ValueError:
        raise UsageError(f"{place}: its lists have different lengths") from None


def _leaf_words(leaf: Basic, value: Any, place: str) -> np.ndarray:
    array = _array(value, place)
    if array.dtype.kind not in "biuf":
        raise UsageError(f"{place}: {leaf.name} takes numbers, not {array.dtype}")
    if leaf.kind == "float":
        with np.errstate(over="ignore"):  # values beyond float32 become infinite, as they would on the GPU
            array = array.astype(np.float32, copy=False)
    else:
        array = _integers(leaf, array, place)
    if array.ndim == 0:
        array = np.broadcast_to(array, leaf.shape)  # as vec3(x) in GLSL
        if len(leaf.shape) == 2:
            raise UsageError(f"{place}: {leaf.name} takes arrays that end in {leaf.shape}")
    ahead = array.ndim - len(leaf.shape)
    if ahead < 0 or array.shape[ahead:] != leaf.shape:
        raise UsageError(f"{place}: {leaf.name} takes a number or arrays that end in {leaf.shape}, "
                         f"not the shape {array.shape}")
    return np.ascontiguousarray(array).view(np.uint32).reshape(array.shape[:ahead] + (leaf.size,))


def _integers(leaf: Basic, array: np.ndarray, place: str) -> np.ndarray:
    if leaf.kind == "bool":
        return (array != 0).astype(np.uint32)
    limits = np.iinfo(_DTYPES[leaf.kind])
    if array.dtype.kind == "f" or (array.size and not limits.min <= array.min() <= array.max() <= limits.max):
        raise UsageError(f"{place}: {leaf.name} takes whole numbers from {limits.min} to {limits.max}")
    return array.astype(_DTYPES[leaf.kind])


def from_words(type_: Type, leaves: Iterator[np.ndarray]) -> np.ndarray | dict[str, Any]:
    """The value of `type_` from uint32 arrays (..., n), one for each of its leaves; a struct becomes a dict."""
    if not isinstance(type_, Basic):
        return {name: from_words(member, leaves) for name, member in type_.members}
    words = next(leaves)
    values = words.view(_DTYPES[type_.kind]).reshape(words.shape[:-1] + type_.shape)
    return values.astype(bool) if type_.kind == "bool" else values


def broadcast_shape(leaves: Sequence[tuple[str, np.ndarray]]) -> tuple[int, ...]:
    """The common shape of all the leading axes, by numpy's rules."""
    try:
        return np.broadcast_shapes(*(words.shape[:-1] for _, words in leaves))
    except ValueError:
        shapes = ", ".join(f"{name} {words.shape[:-1]}" for name, words in leaves)
        raise UsageError(f"the arrays cannot be broadcast together: their shapes are {shapes}") from None
