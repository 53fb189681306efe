"""Which models `render` is given: files, folders, patterns, and lists on standard input."""

from __future__ import annotations

import os
import re
import sys
from collections.abc import Iterator, Sequence
from glob import glob
from pathlib import Path

from ..errors import InputError
from ..scene.model_files import MODEL_ENDINGS, models_in

_PATTERN = re.compile(r"[*?]|\[.+\]")


def find_models(given: Sequence[str]) -> list[str]:
    """The models that the arguments name, each once, in their order.

    A folder stands for the models in it and in its folders; a pattern with `*`, `?`, `[...]` or `**`, which no shell
    has replaced, for what it matches; `-` for the names on standard input, one a line or each ended by a zero byte.
    Raises InputError for a folder without models, a pattern that matches nothing, and an empty list. Whether a file is
    there is left to whoever loads it, so that a missing one does not keep the others from being rendered.
    """
    found: dict[str, str] = {}
    for argument in given:
        for model in _listed() if argument == "-" else _named(argument):
            found.setdefault(os.path.abspath(model), model)
    return list(found.values())


def _named(argument: str) -> Iterator[str]:
    if os.path.isdir(argument):
        models = models_in(Path(argument))
        if not models:
            endings = ", ".join(sorted(MODEL_ENDINGS))
            raise InputError(argument, "", f"there is no model in this folder: no file whose name ends in {endings}")
        yield from map(str, models)
    elif _PATTERN.search(argument) and not os.path.lexists(argument):
        matches = sorted(glob(argument, recursive=True))
        if not matches:
            raise InputError(argument, "", "no file matches this pattern")
        for match in matches:
            if not os.path.isdir(match):
                yield match
            elif "**" not in argument:  # which matches the files inside of folders, too
                yield from map(str, models_in(Path(match)))
    else:
        yield argument


def _listed() -> Iterator[str]:
    try:
        text = os.fsdecode(sys.stdin.buffer.read())
    except OSError as error:
        raise InputError("-", "", f"standard input cannot be read: {error.strerror or error}") from error
    names = text.split("\0") if "\0" in text else [line.removesuffix("\r") for line in text.split("\n")]
    names = [name for name in names if name.strip()]
    if not names:
        raise InputError("-", "", "standard input names no model; it is a list of files, one a line")
    for name in names:
        yield from (map(str, models_in(Path(name))) if os.path.isdir(name) else (name,))
