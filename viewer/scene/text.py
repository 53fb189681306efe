"""The text of model files: whatever its encoding and line ends, and tables of numbers in it."""

from __future__ import annotations

import re
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import NoReturn

import numpy as np

from ..base.quiet import without_warnings
from ..errors import InputError

_BLANK = 32
"""Bytes up to this one separate words: space, tab, line ends and other control characters."""


def plain_text(data: bytes) -> bytes:
    """The text with lines that end in LF and words that tabs no longer separate, in an encoding that contains ASCII.

    UTF-16, known by its byte order mark, becomes UTF-8. All other encodings stay: numbers and keywords are ASCII.
    """
    if data.startswith((b"\xff\xfe", b"\xfe\xff")):
        data = data.decode("utf-16", "replace").encode()
    data = data.removeprefix(b"\xef\xbb\xbf")
    if b"\r" in data:
        data = data.replace(b"\r\n", b"\n").replace(b"\r", b"\n")
    return data.replace(b"\t", b" ")


def decoded(text: bytes) -> str:
    """The text as UTF-8 or, where it is not, as Latin-1, which fails for nothing."""
    try:
        return text.decode("utf-8")
    except UnicodeDecodeError:
        return text.decode("latin-1")


def without_comments(text: bytes) -> bytes:
    """The text without what stands between # and the end of its line."""
    return re.sub(rb"#[^\n]*", b"", text) if b"#" in text else text


def line_of_row(text: bytes, first: int = 1) -> Callable[[int], str]:
    """Names a row of `number_rows(text)` by its line in the file, in which the text begins with line `first`."""
    def place(row: int) -> str:
        lines = [line for line, words in enumerate(text.split(b"\n"), first) if words.strip()]
        return f"line {lines[row]}"

    return place


@dataclass(frozen=True)
class NumberRows:
    """Lines of numbers: row r is values[starts[r]:starts[r + 1]], and stands in line lines[r], counted from 0."""

    values: np.ndarray
    starts: np.ndarray
    lines: np.ndarray

    @property
    def counts(self) -> np.ndarray:
        """How many numbers each row has."""
        return np.diff(self.starts)

    def __len__(self) -> int:
        return len(self.starts) - 1

    def columns(self, first: int, count: int) -> np.ndarray:
        """`count` columns from `first` on, (rows, count). Every row must have them."""
        return self.values[self.starts[:-1, None] + np.arange(first, first + count)]


def number_rows(path: Path, text: bytes, place: Callable[[int], str], dtype: type = np.float64) -> NumberRows:
    """The numbers of `text`, a row per line that is not blank. `place` names a row, for errors.

    Raises InputError about the first word that is not a number.
    """
    characters = np.frombuffer(b"\n" + text + b"\n", np.uint8)
    is_word = characters > _BLANK
    words = np.flatnonzero(is_word[1:] & ~is_word[:-1])
    starts = np.searchsorted(words, np.flatnonzero(characters == 10))
    lines = np.flatnonzero(starts[1:] > starts[:-1])
    starts = starts[np.append(0, lines + 1)]
    try:
        with without_warnings():  # older versions of numpy warn where newer ones raise ValueError
            values: np.ndarray = np.fromstring(text, dtype, sep=" ") if len(words) else np.zeros(0, dtype)
    except ValueError:
        values = np.zeros(0, dtype)
    if len(values) != len(words):
        _raise_not_a_number(path, text, place, dtype)
    return NumberRows(values, starts, lines)


def _raise_not_a_number(path: Path, text: bytes, place: Callable[[int], str], dtype: type) -> NoReturn:
    kind, pattern = ("an integer", rb"[-+]?\d+") if np.issubdtype(dtype, np.integer) else (
        "a number", rb"(?i:[-+]?(\d+\.?\d*(e[-+]?\d+)?|\.\d+(e[-+]?\d+)?|nan|inf(inity)?))")
    is_number = re.compile(pattern).fullmatch
    row = 0
    for line in text.split(b"\n"):
        words = line.split()
        bad = next((word for word in words if not is_number(word)), None)
        if bad is not None:
            raise InputError(path, place(row), f"{decoded(bad[:40])!r} is not {kind}")
        row += bool(words)
    raise InputError(path, "", "numbers that cannot be read")
