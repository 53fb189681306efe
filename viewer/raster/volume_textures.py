"""The grids of a scene's volumes on the GPU: parts of one 3D texture, one above the other along z."""

from __future__ import annotations

from collections.abc import Sequence

import moderngl
import numpy as np

from ..gpu.programs import matrix_uniform
from ..scene.frame import Frame
from ..scene.volume import Volume
from .units import UNIT_DENSITIES

_LEAST_LIMIT = 256
"""GL_MAX_3D_TEXTURE_SIZE is at least so much in OpenGL 3.3."""


class VolumeTextures:
    """Densities of `volumes`. A grid that is larger than this OpenGL's textures is stored at half its resolution, or
    less."""

    def __init__(self, gl: moderngl.Context, volumes: Sequence[Volume]) -> None:
        self.volumes = tuple(volumes)
        limit = gl.info.get("GL_MAX_3D_TEXTURE_SIZE", _LEAST_LIMIT)
        grids = [volume.density for volume in volumes]
        while any(max(grid.shape) > limit for grid in grids) or sum(len(grid) for grid in grids) > limit:
            largest = max(range(len(grids)), key=lambda k: grids[k].size)
            grids[largest] = _halved(grids[largest])
        self._shapes = [grid.shape for grid in grids]
        depth = sum(shape[0] for shape in self._shapes)
        height, width = (max(shape[axis] for shape in self._shapes) for axis in (1, 2))
        dtype = np.float16 if all(grid.dtype == np.float16 for grid in grids) else np.float32
        whole = np.zeros((depth, height, width), dtype)
        self._starts = np.cumsum([0, *(shape[0] for shape in self._shapes)])[:-1]
        for grid, start in zip(grids, self._starts, strict=True):
            z, y, x = grid.shape
            whole[start:start + z, :y, :x] = grid
        self.texture = gl.texture3d((width, height, depth), 1, whole, dtype=f"f{whole.itemsize}", alignment=1)
        self.texture.filter = moderngl.LINEAR, moderngl.LINEAR
        self.texture.repeat_x = self.texture.repeat_y = self.texture.repeat_z = False

    def uniforms(self, frame: Frame) -> dict[str, object]:
        """The uniforms of shaders/raster/volumes.glsl for one frame, without the extinction; binds the texture."""
        self.texture.use(UNIT_DENSITIES)
        from_eye = np.diag([frame.unit, frame.unit, frame.unit, 1.0])
        from_eye[:3, 3] = frame.camera.eye
        boxes, margins, sizes = [], [], []
        for volume, shape in zip(self.volumes, self._shapes, strict=True):
            counts = np.array(volume.density.shape[::-1], np.float64)
            to_box = np.diag([*(1 / counts), 1.0])
            to_box[:3, 3] = 0.5 / counts  # the box begins half a voxel before the first centre
            boxes.append(matrix_uniform(to_box @ np.linalg.inv(volume.index_to_world) @ from_eye))
            margins.append(0.5 / np.array(shape[::-1]))
            sizes.append(np.array(shape[::-1]) / self.texture.size)
        starts = self._starts / self.texture.size[2]
        return {"u_densities": UNIT_DENSITIES, "u_volume_box": b"".join(boxes),
                "u_volume_margin": np.float32(margins).tobytes(), "u_volume_size": np.float32(sizes).tobytes(),
                "u_volume_start": np.float32(starts).tobytes()}

    def release(self) -> None:
        self.texture.release()


def _halved(grid: np.ndarray) -> np.ndarray:
    """The means of blocks of two voxels along each axis; an odd last voxel is repeated."""
    for axis in range(3):
        if grid.shape[axis] % 2:
            grid = np.concatenate([grid, np.take(grid, [-1], axis=axis)], axis=axis)
        first, second = (np.take(grid, range(k, grid.shape[axis], 2), axis=axis) for k in (0, 1))
        grid = (0.5 * first.astype(np.float32) + 0.5 * second).astype(grid.dtype)
    return grid
