"""Grids of densities as the tracer's shaders read them: the voxels and their majorants in one texture, and records.

A majorant is the greatest density in a cell, a cube of voxels. Delta tracking needs it (shaders/media/tracking.glsl).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import moderngl
import numpy as np

from ...errors import InputError
from ...gpu.programs import set_uniform
from ...scene.medium import Medium
from ...scene.scene import Scene
from ...scene.volume import Volume
from ..layout import VOLUME_TEXELS

CELL_SIZE = 4
"""Voxels along each side of a cell, unless there would be too many cells."""
MAX_CELLS = 64
"""Most cells along an axis of a grid."""
UNIT_VOXELS = 21  # beyond those of viewer/trace/paths/wavefront.py
_WIDTH = 4096


def cell_size(density: np.ndarray) -> int:
    """The number of voxels along each side of a cell of a grid (nz, ny, nx)."""
    return max(CELL_SIZE, -(-max(density.shape) // MAX_CELLS))


def majorants(density: np.ndarray, size: int) -> np.ndarray:
    """The greatest density in each cell of `size` voxels a side: (cz, cy, cx), the type of the densities (nz, ny, nx).

    Densities are trilinear between the centres of voxels, so those of a cell depend on one voxel more on each side.
    """
    out = density
    for axis in range(3):
        starts = np.arange(0, out.shape[axis], size)
        before, after = np.maximum(starts - 1, 0), np.minimum(starts + size, out.shape[axis] - 1)
        inside = np.maximum.reduceat(out, starts, axis=axis)
        out = np.maximum(np.maximum(out.take(before, axis), out.take(after, axis)), inside)
    return out


@dataclass(frozen=True)
class _Place:
    """The first rows, in the texture, of a grid's voxels and of its majorants."""

    voxels: int
    majorants: int


class VolumeGrids:
    """The grids of a scene: their texture, and the records by which shaders find them in it."""

    def __init__(self, gl: moderngl.Context, scene: Scene) -> None:
        """Raises InputError for grids that no texture of this OpenGL holds."""
        self._volumes = scene.volumes
        cells = [majorants(volume.density, cell_size(volume.density)) for volume in scene.volumes]
        limit = gl.info["GL_MAX_TEXTURE_SIZE"]
        width = min(_WIDTH, limit)
        while self._rows(cells, width)[1] > limit and width < limit:
            width *= 2
        self._places, rows = self._rows(cells, width)
        if rows > limit:
            voxels = sum(volume.density.size for volume in scene.volumes)
            raise InputError(scene.name, "", f"too many voxels to trace here: {voxels}, and a texture holds "
                                             f"{width * limit}")
        # Half floats stay half floats; grids of both types share a texture of floats.
        dtype = np.result_type(*(volume.density.dtype for volume in scene.volumes))
        self.texture = gl.texture((width, rows), 1, dtype=f"f{dtype.itemsize}", alignment=1)
        self.texture.filter = moderngl.NEAREST, moderngl.NEAREST
        for volume, majorant, place in zip(scene.volumes, cells, self._places, strict=True):
            self._write(volume.density.astype(dtype, copy=False), place.voxels)
            self._write(majorant.astype(dtype, copy=False), place.majorants)

    def _rows(self, cells: Sequence[np.ndarray], width: int) -> tuple[list[_Place], int]:
        """The places of the grids in a texture of this width, and its rows. Each array begins at a row of its own."""
        places, row = [], 0
        for volume, majorant in zip(self._volumes, cells, strict=True):
            after = row + -(-volume.density.size // width)
            places.append(_Place(row, after))
            row = after - (-majorant.size // width)
        return places, row

    def _write(self, values: np.ndarray, row: int) -> None:
        width = self.texture.width
        flat = values.reshape(-1)
        whole = flat.size // width
        if whole:
            self.texture.write(flat[: whole * width], viewport=(0, row, width, whole), alignment=1)
        if flat.size > whole * width:
            rest = np.ascontiguousarray(flat[whole * width :])
            self.texture.write(rest, viewport=(0, row + whole, rest.size, 1), alignment=1)

    def records(self, scene: Scene, medium: Medium) -> np.ndarray:
        """The section `volumes` of the scene buffer, (volumes * VOLUME_TEXELS, 4) uint32.

        `medium` is that of a density of 1, with one extinction for all channels.
        """
        extinction = medium.sigma_t[0]
        emitted = [e / extinction if extinction > 0 else 0.0 for e in medium.emission]
        out = np.zeros((len(self._volumes), VOLUME_TEXELS, 4), np.uint32)
        for row, volume, place in zip(out, self._volumes, self._places, strict=True):
            size = cell_size(volume.density)
            row[:3] = _to_cells(scene, volume, size).astype(np.float32).view(np.uint32)
            shape = np.array(volume.density.shape[::-1])
            row[3] = *shape, place.voxels
            row[4] = *(-(-shape // size)), place.majorants
            row[5, 0] = size
            row[5, 1:2] = np.array([extinction * scene.radius], np.float32).view(np.uint32)
            row[6] = np.array([*medium.albedo, medium.phase], np.float32).view(np.uint32)
            row[7, :3] = np.array(emitted, np.float32).view(np.uint32)
        return out.reshape(-1, 4)

    def use_textures(self) -> None:
        """Bind the texture to its unit."""
        self.texture.use(UNIT_VOXELS)

    def set_uniforms(self, program: moderngl.Program) -> None:
        """Set the uniforms of shaders/media/grid.glsl but that of the section."""
        for name, value in {"u_voxels": UNIT_VOXELS, "u_voxel_shift": self.voxel_shift,
                            "u_volume_count": len(self._volumes)}.items():
            set_uniform(program, name, value)

    @property
    def voxel_shift(self) -> int:
        """The texture's width is 2 to the power of this."""
        return int(self.texture.width).bit_length() - 1

    @property
    def texture_bytes(self) -> int:
        """Size of the texture on the GPU."""
        return int(self.texture.width * self.texture.height * int(self.texture.dtype[1]))

    def release(self) -> None:
        self.texture.release()


def _to_cells(scene: Scene, volume: Volume, size: int) -> np.ndarray:
    """The (3, 4) matrix from tracer space to cells: the box begins at 0, and a cell has the side 1."""
    to_world = volume.index_to_world.copy()
    to_world[:3, 3] -= scene.center
    to_world[:3] /= scene.radius
    to_index = np.linalg.inv(to_world)
    to_index[:3, 3] += 0.5
    result: np.ndarray = to_index[:3] / size
    return result
