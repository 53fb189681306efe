"""A volume: a grid of densities in a box, which a medium fills: smoke, a cloud."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property
from os import PathLike
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from ..base.expect import expect, expect_path
from ..errors import UsageError
from ..settings import Settings
from .arrays import HoldsArrays, scene_array
from .medium import Medium


@dataclass(frozen=True, eq=False, repr=False)
class Volume(HoldsArrays):
    """A grid of densities. The settings `volume-...` define how a density of 1 scatters, absorbs and emits light.

    `density` (nz, ny, nx) float32 or float16, finite and not negative. x is the fastest axis, as in a 3D texture of
    OpenGL. `index_to_world` (4, 4) float64, column vectors, takes whole indices (x, y, z) to the *centres* of voxels in
    world space, so that the box is [-1/2, n - 1/2] along each axis. Between centres the density is trilinear, from
    the outermost centres to the faces of the box it is constant, and outside the box it is 0.

    Raises UsageError for other arrays.
    """

    name: str
    density: np.ndarray
    index_to_world: np.ndarray

    def __post_init__(self) -> None:
        expect(self.name, str, "Volume.name", "text")
        density = scene_array(self.density, "Volume.density", _float_type(self.density), None, None, None)
        if not density.size:
            raise UsageError(f"Volume.density is {density.shape}: it has no voxels")
        if density.min() < 0:
            z, y, x = np.unravel_index(density.argmin(), density.shape)
            raise UsageError(f"Volume.density[{z}, {y}, {x}] is {density[z, y, x]:g}: a density is not negative")
        matrix = scene_array(self.index_to_world, "Volume.index_to_world", np.float64, 4, 4)
        if not np.array_equal(matrix[3], (0, 0, 0, 1)):
            raise UsageError(f"Volume.index_to_world: its last row is {matrix[3].tolist()}, not 0, 0, 0, 1")
        if np.linalg.matrix_rank(matrix[:3, :3]) < 3:
            raise UsageError("Volume.index_to_world: it makes the grid flat, and has no inverse")
        self._set("density", density)
        self._set("index_to_world", matrix)

    @classmethod
    def in_box(cls, density: np.ndarray, box: ArrayLike, name: str = "density") -> Volume:
        """`density` (nz, ny, nx) in an axis-aligned box, whose lowest and highest corner (2, 3) are in world space.

        Raises UsageError as the constructor does.
        """
        low, high = scene_array(box, "box", np.float64, 2, 3)
        if not (low < high).all():
            raise UsageError(f"box: {low.tolist()} to {high.tolist()} has no volume")
        density = scene_array(density, "density", _float_type(density), None, None, None)
        shape = np.array(density.shape[::-1])
        if not shape.all():
            raise UsageError(f"density is {density.shape}: it has no voxels")
        matrix = np.diag([*(high - low) / shape, 1.0])
        matrix[:3, 3] = low + matrix.diagonal()[:3] / 2
        return cls(name, density, matrix)

    def save(self, path: str | PathLike[str]) -> None:
        """Write a .vol file, which Mitsuba reads. Raises OutputError, and UsageError for what is no path, for another
        ending and for a box that is not along the axes, which the format does not have."""
        from .vol import write_vol

        expect_path(path, "path")
        if Path(path).suffix.lower() != ".vol":
            raise UsageError(f"{path}: a volume is saved as .vol")
        steps = self.index_to_world[:3, :3]
        if not (np.diag(steps) > 0).all() or not np.array_equal(steps, np.diag(np.diag(steps))):
            raise UsageError(f"{path}: the box of {self!r} is turned, and that of a .vol is along the axes")
        write_vol(path, self.density, self.corners[[0, 7]])

    def __repr__(self) -> str:
        """In one line: the densities would fill pages."""
        size = " x ".join(map(str, self.density.shape[::-1]))
        return f"<Volume {self.name!r}: {size} voxels, {self.density.dtype}, up to {self.maximum:g}>"

    @cached_property
    def maximum(self) -> float:
        """The greatest density."""
        return float(self.density.max())

    @property
    def greatest_depth(self) -> float:
        """The greatest density times the longest diagonal, rounded down to a power of the root of two: volumes
        that are about as dense have one layout."""
        diagonals = self.corners[[7, 6, 5, 3]] - self.corners[[0, 1, 2, 4]]
        depth = self.maximum * float(np.linalg.norm(diagonals, axis=1).max())
        return 2 ** (math.floor(2 * math.log2(depth)) / 2) if depth > 0 else 0.0

    @cached_property
    def corners(self) -> np.ndarray:
        """The corners of the box in world space, (8, 3) float64."""
        high = np.array([(k >> axis) & 1 for k in range(8) for axis in range(3)], np.float64).reshape(8, 3)
        indices = high * self.density.shape[::-1] - 0.5
        corners: np.ndarray = indices @ self.index_to_world[:3, :3].T + self.index_to_world[:3, 3]
        return corners

    @property
    def layout(self) -> tuple[object, ...]:
        """All that programs and the sizes of textures depend on."""
        return self.density.shape, self.density.dtype.str, self.greatest_depth


def volume_medium(settings: Settings) -> Medium:
    """What light meets in a volume where the density is 1: the medium of the settings `volume-...`.

    Extinction and emission are proportional to the density.
    """
    return Medium((settings.volume_density,) * 3, settings.volume_albedo, settings.volume_g,
                  settings.volume_droplets, settings.volume_emission)


def mean_collisions(volume: Volume, medium: Medium) -> float:
    """An upper bound on the mean number of collisions of a path that enters the box of `volume`, by light from all
    around.

    What absorbs nothing has the same radiance everywhere then, so that the collisions are those on straight lines: 4
    times the integral of the extinction over the surface of the box, however often light is scattered (Blanco and
    Fournier 2003, "An Invariance Property of Diffusive Random Walks"). An albedo a leaves at most 1 / (1 - a) of them.
    """
    edges = volume.index_to_world[:3, :3] * np.array(volume.density.shape[::-1])
    a, b, c = edges.T
    surface = 2 * sum(float(np.linalg.norm(np.cross(p, q))) for p, q in ((a, b), (b, c), (c, a)))
    mean = float(volume.density.mean(dtype=np.float64))
    straight = 4 * max(medium.sigma_t) * mean * abs(float(np.dot(a, np.cross(b, c)))) / surface
    albedo = max(medium.albedo)
    return min(straight, 1 / (1 - albedo)) if albedo < 1 else straight


def _float_type(values: Any) -> type:
    return np.float16 if getattr(values, "dtype", None) == np.float16 else np.float32
