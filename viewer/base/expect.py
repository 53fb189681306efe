"""Arguments of the wrong type, told in one line where they come in."""

from __future__ import annotations

from os import PathLike

from ..errors import UsageError


def expect(value: object, kind: type | tuple[type, ...], name: str, wanted: str) -> None:
    """Raises UsageError where `value`, the argument called `name`, is not of `kind`, which `wanted` says in words."""
    if not isinstance(value, kind):
        raise UsageError(f"{name} is of type {type(value).__name__}, not {wanted}")


def expect_path(value: object, name: str) -> None:
    """Raises UsageError where `value` is no path, that is, neither text nor `os.PathLike`."""
    expect(value, (str, PathLike), name, "a path")
