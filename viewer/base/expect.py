"""Checks the types of arguments where they enter the package, with errors of one line."""

from __future__ import annotations

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
