"""Mitsuba's .vol: 48 bytes of header and the values of a grid in a box along the axes, as float32."""

from __future__ import annotations

import struct
from os import PathLike
from pathlib import Path

import numpy as np

from ..base.atomic import atomic_write
from ..errors import InputError
from .densities import density_type

SIGNATURE = b"VOL"
_VERSION, _FLOAT32 = 3, 1
_HEADER = struct.Struct("<3sB5i6f")
"""The signature, the version, the type of the values, the voxels along x, y and z, the channels, and the lowest and the
highest corner of the box. The values follow, x fastest and z slowest."""


def read_vol(path: Path, data: bytes) -> tuple[np.ndarray, np.ndarray]:
    """The values (nz, ny, nx) and the box (2, 3). Raises InputError."""
    if len(data) < _HEADER.size:
        raise InputError(path, "", f"the file ends in its header of {_HEADER.size} bytes")
    _, version, kind, nx, ny, nz, channels, *box = _HEADER.unpack_from(data)
    if (version, kind) != (_VERSION, _FLOAT32):
        raise InputError(path, "", f"has version {version} and values of type {kind}; version {_VERSION} with type "
                                   f"{_FLOAT32}, float32, is read")
    if channels != 1:
        raise InputError(path, "", f"has {channels} numbers in each voxel; a density is one")
    if min(nx, ny, nz) < 1:
        raise InputError(path, "", f"has {nx} x {ny} x {nz} voxels")
    held = density_type(path, "", (nx, ny, nz), is_half=False)
    size = 4 * nx * ny * nz
    if len(data) - _HEADER.size != size:
        raise InputError(path, "", f"{nx} x {ny} x {nz} voxels take {size} bytes, but the file has "
                                   f"{len(data) - _HEADER.size}")
    with np.errstate(over="ignore"):  # what a half float cannot hold is found later
        values = np.frombuffer(data, "<f4", offset=_HEADER.size).astype(held)
    return values.reshape(nz, ny, nx), np.array(box, np.float64).reshape(2, 3)


def write_vol(path: str | PathLike[str], density: np.ndarray, box: np.ndarray) -> None:
    """Write a grid (nz, ny, nx) in a box (2, 3), lowest and highest corner. Raises OutputError."""
    header = _HEADER.pack(SIGNATURE, _VERSION, _FLOAT32, *density.shape[::-1], 1, *box.reshape(6).tolist())
    with atomic_write(path) as temporary:
        temporary.write_bytes(header + density.astype("<f4").tobytes())
