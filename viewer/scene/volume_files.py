"""Loads volume files as a Scene: OpenVDB's .vdb, numpy's .npz and Mitsuba's .vol."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from ..errors import InputError, UsageError
from .densities import bad_density, density_error
from .npz import read_npz
from .scene import MAX_EXTENT, Scene
from .vdb.load import load_vdb
from .vol import read_vol
from .volume import Volume


def load_volume_file(path: Path, data: bytes, kind: str) -> Scene:
    """Read `data`, the content of `path`, as the format `kind`, one of `load.VOLUME_FORMATS`. Raises InputError.

    The scene's facts list all grids of the file, and what is told of each.
    """
    if kind == "vdb":
        return load_vdb(path, data)
    density, box = read_npz(path, data) if kind == "npz" else read_vol(path, data)
    _check_box(path, "bbox" if kind == "npz" else "box", box)
    if (bad := bad_density(density.reshape(-1), density.dtype)) is not None:
        z, y, x = np.unravel_index(bad, density.shape)
        raise density_error(path, "density", (int(x), int(y), int(z)), float(density[z, y, x]), density.dtype)
    density.flags.writeable = False  # so that it is not copied
    try:
        volume = Volume.in_box(density, box)
    except UsageError as error:
        raise InputError(path, "", str(error)) from error
    grid = {"name": volume.name, "type": density.dtype.name, "active_voxels": density.size,
            "index_box": [[0, 0, 0], [n - 1 for n in density.shape[::-1]]],
            "sum": float(density.sum(dtype=np.float64)), "min": float(density.min()), "max": volume.maximum,
            "index_to_world": volume.index_to_world.tolist()}
    return Scene(path.stem, volumes=(volume,), facts={"format": kind.upper(), "grids": [grid]})


def _check_box(path: Path, place: str, box: np.ndarray) -> None:
    """Raises InputError for what is no box; `place` is its name in the file."""
    low, high = box.tolist()
    if not np.isfinite(box).all():
        raise InputError(path, place, f"{low} to {high}: a corner is infinite or NaN")
    if np.abs(box).max() >= MAX_EXTENT:
        raise InputError(path, place, f"{low} to {high}: has coordinates beyond {MAX_EXTENT:g}, which cannot be drawn")
    if not (box[0] < box[1]).all():
        raise InputError(path, place, f"{low} to {high} has no volume")
