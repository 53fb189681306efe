"""Grids in numpy's .npz: the arrays `density`, `bbox` and `axes`.

`bbox` is the box, [[lowest x, y, z], [highest x, y, z]], along the axes. `axes` names those of `density` in the order
of its indices: 'zyx', which is the default, or 'xyz'. Other arrays are not looked at. An .npz is a zip file, so all
sizes are checked before anything is unpacked.
"""

from __future__ import annotations

import io
import zipfile
import zlib
from pathlib import Path
from typing import IO

import numpy as np

from ..errors import InputError
from .densities import density_type

_CHUNK = 1 << 18
"""Values that are read at a time."""
_METHODS = (zipfile.ZIP_STORED, zipfile.ZIP_DEFLATED)


def read_npz(path: Path, data: bytes) -> tuple[np.ndarray, np.ndarray]:
    """The densities (nz, ny, nx) and the box (2, 3) float64. Raises InputError."""
    try:
        with zipfile.ZipFile(io.BytesIO(data)) as archive:
            return _read(path, archive)
    except (zipfile.BadZipFile, zlib.error, EOFError, OSError, ValueError, NotImplementedError, RuntimeError) as error:
        raise InputError(path, "", "is no .npz file, or a broken one") from error


def _read(path: Path, archive: zipfile.ZipFile) -> tuple[np.ndarray, np.ndarray]:
    box = _Member(path, archive, "bbox")
    if box.shape != (2, 3):
        raise InputError(path, "bbox", f"has the shape {box.shape}, not (2, 3)")
    corners = box.values(np.dtype(np.float64))
    density = _Member(path, archive, "density")
    if len(density.shape) != 3 or min(density.shape) < 1:
        raise InputError(path, "density", f"has the shape {density.shape}, not that of a grid of voxels")
    axes = _axes(path, archive)
    shape = density.shape[::-1] if axes == "zyx" else density.shape
    values = density.values(density_type(path, "density", shape, density.dtype == np.float16))
    return np.ascontiguousarray(values if axes == "zyx" else values.T), corners


def _axes(path: Path, archive: zipfile.ZipFile) -> str:
    if "axes.npy" not in archive.namelist():
        return "zyx"
    member = _Member(path, archive, "axes")
    name = str(member.text())
    if name not in ("zyx", "xyz"):
        raise InputError(path, "axes", f"{name[:20]!r}, not 'zyx' or 'xyz'")
    return name


class _Member:
    """An array of the archive. Its header is read, its values are not."""

    def __init__(self, path: Path, archive: zipfile.ZipFile, name: str) -> None:
        self._path, self._name = path, name
        try:
            info = archive.getinfo(f"{name}.npy")
        except KeyError as error:
            raise InputError(path, "", f"has no array '{name}'") from error
        if info.compress_type not in _METHODS:
            raise InputError(path, name, "is compressed by a method that numpy does not write")
        self._file: IO[bytes] = archive.open(info)
        if np.lib.format.read_magic(self._file) != (1, 0):  # other versions have headers of up to 4 GB
            raise InputError(path, name, "has a header that is not version 1.0 of numpy's format")
        try:
            self.shape, self._is_fortran, self.dtype = np.lib.format.read_array_header_1_0(self._file)
        except Exception as error:  # of the parser of Python, whose text the header is
            raise InputError(path, name, "has a broken header") from error

    def values(self, held: np.dtype) -> np.ndarray:
        """All values as `held`. Raises InputError if there are fewer than the header says, or no numbers."""
        if self.dtype.kind not in "iuf":
            raise InputError(self._path, self._name, f"holds {self.dtype}, not numbers")
        result = np.empty(int(np.prod(self.shape, dtype=np.int64)), held)
        with np.errstate(over="ignore"):  # what `held` cannot hold is found later
            for first in range(0, len(result), _CHUNK):
                part = result[first:first + _CHUNK]
                data = self._file.read(len(part) * self.dtype.itemsize)
                if len(data) != len(part) * self.dtype.itemsize:
                    raise InputError(self._path, self._name, f"ends before its {len(result)} values do")
                part[:] = np.frombuffer(data, self.dtype)
        if self._file.read(1):
            raise InputError(self._path, self._name, f"has more than the {len(result)} values that it names")
        return result.reshape(self.shape, order="F" if self._is_fortran else "C")

    def text(self) -> str:
        if self.shape != () or self.dtype.kind != "U" or self.dtype.itemsize > 64:
            raise InputError(self._path, self._name, f"holds {self.dtype}, not a word")
        return str(np.frombuffer(self._file.read(self.dtype.itemsize), self.dtype)[0])
