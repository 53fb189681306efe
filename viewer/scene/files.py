"""Reads files. A model may refer only to regular files inside its own folder."""

from __future__ import annotations

import re
import stat
from collections.abc import Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from os import PathLike
from pathlib import Path
from urllib.parse import unquote

from ..errors import InputError

_SCHEME = re.compile(r"[A-Za-z][A-Za-z0-9+.\-]*:")
"""The scheme of a URI (http:, file:), or a Windows drive letter."""


def read_file(path: str | PathLike[str], name: str = "", place: str = "") -> bytes:
    """All bytes of a regular file.

    Raises InputError if it cannot be read. The error names the file `name` and the place in it that refers to `path`,
    or `path` itself if there is no `name`.
    """
    path = Path(path)
    _note(path)
    try:
        mode = path.stat().st_mode
        if stat.S_ISDIR(mode):
            raise InputError(name or path, place, _problem("is a folder, not a file", path, name))
        if not stat.S_ISREG(mode):
            raise InputError(name or path, place, _problem("is not a regular file", path, name))
        return path.read_bytes()
    except FileNotFoundError as error:
        raise InputError(name or path, place, _problem("no such file", path, name)) from error
    except (OSError, ValueError) as error:
        reason = getattr(error, "strerror", None) or str(error)
        raise InputError(name or path, place, _problem(f"cannot be read: {reason}", path, name)) from error


class OutsideError(InputError):
    """A model names a file that is not in its own folder."""


def path_inside(model: Path, uri: str, place: str) -> Path:
    """The file that a relative URI in `model` refers to. Raises InputError; OutsideError for a file outside the folder.

    The check uses the percent-decoded path with all symbolic links resolved, so `..` cannot be disguised.
    """
    folder = model.parent.resolve()
    for text in dict.fromkeys((unquote(uri), uri)):
        if not text or "\0" in text:
            raise InputError(model, place, f"not a file name: {uri[:80]!r}")
        if _SCHEME.match(text) or text.startswith(("/", "\\")):
            problem = f"{text[:80]!r} is not relative; only files in the model's folder are read"
            raise OutsideError(model, place, problem)
        if "\\" in text:
            raise InputError(model, place, f"{text[:80]!r} contains backslashes; a URI separates folders by /")
        try:
            path = (folder / text).resolve()
        except (OSError, RuntimeError, ValueError) as error:
            raise InputError(model, place, f"{text[:80]!r} cannot be resolved") from error
        _note(path)
        if not path.is_relative_to(folder):
            raise OutsideError(model, place, f"{text[:80]!r} lies outside the model's folder")
        if path == model.resolve():
            raise InputError(model, place, "names the model file itself")
        if _exists(path):
            return path
    raise InputError(model, place, f"no such file: {unquote(uri)[:80]!r}")


Stamp = tuple[int, int]
"""The time and size of a file, which change when it is written; zeros if it does not exist."""
_noted: ContextVar[dict[Path, Stamp] | None] = ContextVar("noted", default=None)


@contextmanager
def noting_files() -> Iterator[dict[Path, Stamp]]:
    """Note the files that this thread reads, or looks for, within the block: the model and what it refers to. Each has
    the stamp from before it was read."""
    found: dict[Path, Stamp] = {}
    token = _noted.set(found)
    try:
        yield found
    finally:
        _noted.reset(token)


def _note(path: Path) -> None:
    found = _noted.get()
    if found is not None and path.absolute() not in found:
        found[path.absolute()] = stamp_of(path)


def stamp_of(file: Path) -> Stamp:
    try:
        status = file.stat()
    except (OSError, ValueError):
        return 0, 0
    return status.st_mtime_ns, status.st_size


def _exists(path: Path) -> bool:
    try:
        return path.exists()
    except OSError:  # for example a name that is too long, or a folder without permission
        return False


def _problem(problem: str, path: Path, name: str) -> str:
    return f"{path.name[:80]!r} {problem}" if name else problem
