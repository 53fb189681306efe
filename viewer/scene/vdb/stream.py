"""The bytes of an OpenVDB file, read in order. Numbers are little-endian."""

from __future__ import annotations

import struct
from pathlib import Path

import numpy as np

from ...errors import InputError


class Stream:
    """`at` is the next byte to read. `place` is the grid that errors name, "" for the whole file."""

    def __init__(self, path: Path, data: bytes) -> None:
        self.path, self.data, self.at, self.place = path, data, 0, ""

    def error(self, problem: str) -> InputError:
        return InputError(self.path, self.place, problem)

    def skip(self, count: int) -> int:
        """Go on by `count` bytes, and return where they begin. Raises InputError if the file ends before."""
        start = self.at
        if not 0 <= count <= len(self.data) - start:
            raise self.error(f"the file ends before its content does: at byte {start} there should be {count} more")
        self.at = start + count
        return start

    def take(self, count: int) -> bytes:
        start = self.skip(count)
        return self.data[start:self.at]

    def numbers(self, form: str) -> tuple[int, ...]:
        """Those of a format of the module `struct`, without a byte order."""
        size = struct.calcsize("<" + form)
        return struct.unpack_from("<" + form, self.data, self.skip(size))

    def number(self, form: str) -> int:
        return self.numbers(form)[0]

    def string(self) -> str:
        return self.take(self.number("I")).decode("utf-8", "replace")

    def array(self, dtype: np.dtype | str, *shape: int) -> np.ndarray:
        """A view, read-only as `data` is."""
        dtype, count = np.dtype(dtype), int(np.prod(shape, dtype=np.int64))
        return np.frombuffer(self.data, dtype, count, self.skip(count * dtype.itemsize)).reshape(shape)
