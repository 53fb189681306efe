"""What every reader of volume files holds to: how large a grid may be, and what a density is."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np

from ..errors import InputError, UsageError
from .volume import Volume

MAX_VOXELS = 1 << 28
"""The most voxels of a box. In half floats they take 512 MiB."""
MOST_FLOATS = 1 << 26
"""The most voxels of a grid that is held as it is; a larger one is held in half floats."""


def density_type(path: Path, place: str, shape: Sequence[int], is_half: bool) -> np.dtype:
    """How a grid of `shape`, in voxels along each axis, is held. Raises InputError for one that is too large."""
    count = int(np.prod(np.array(shape, object)))
    if count > MAX_VOXELS:
        size = " x ".join(f"{side:,}" for side in shape)
        raise InputError(path, place, f"a box of {size} voxels is too large: at most {MAX_VOXELS:,} can be held")
    return np.dtype(np.float16 if is_half or count > MOST_FLOATS else np.float32)


def bad_density(values: np.ndarray, held: np.dtype) -> int | None:
    """The index of the first of `values` (N,) that is no density, or that `held` cannot hold; None if there is none."""
    good = (values >= 0) & (values <= np.finfo(held).max)
    return None if good.all() else int(good.argmin())


def density_error(path: Path, place: str, voxel: Sequence[int], value: float, held: np.dtype) -> InputError:
    """For a value that `bad_density` has found, at the voxel (x, y, z)."""
    where = f"voxel ({', '.join(map(str, voxel))})"
    reason = f"too large for {held}, in which the grid is held" if value > np.finfo(held).max and np.isfinite(value) \
        else "not a finite number from 0 up, as a density is"
    return InputError(path, f"{place}: {where}" if place else where, f"{value:g} is {reason}")


def volume_of(path: Path, place: str, name: str, density: np.ndarray, index_to_world: np.ndarray) -> Volume:
    """Raises InputError for what no volume can be."""
    density.flags.writeable = False  # so that it is not copied
    try:
        return Volume(name, density, index_to_world)
    except UsageError as error:
        raise InputError(path, place, str(error)) from error
