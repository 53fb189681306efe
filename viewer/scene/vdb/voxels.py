"""The voxels of an OpenVDB grid: what is told of them, and the dense array of those that are drawn."""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np

from ..densities import bad_density, density_error, density_type, volume_of
from ..volume import Volume
from .header import Grid
from .stream import Stream
from .tree import BATCH, VOXELS, Tree, read_tree

Facts = dict[str, object]
_TOLD = ("active_voxels", "index_box", "sum", "min", "max")


def read_voxels(stream: Stream, grid: Grid, is_drawn: bool, warnings: list[str]) -> tuple[Facts, Volume | None]:
    """What `pbr-viewer info` tells of the voxels of `grid`, and its volume if it is drawn and not empty.

    Of a type or a transform that is not read, nothing is told. Raises InputError.
    """
    stream.place = f"grid '{grid.name[:80]}'"
    if grid.dtype is None or grid.index_to_world is None:
        return dict.fromkeys(_TOLD), None
    tree = read_tree(stream, grid)
    box = tree.box()
    _check(stream, grid, tree, box)
    density = _Density(stream, grid, box) if is_drawn and box is not None else None
    total, low, high = 0.0, math.inf, -math.inf
    for origins, size, values in _values(stream, grid, tree):
        total += float(values.sum(dtype=np.float64)) * size**3
        low, high = float(np.minimum(low, values.min())), float(np.maximum(high, values.max()))  # NaN stays
        if density is not None:
            density.put(origins, size, values[:, 0])
    numbers = [number if math.isfinite(number) else None for number in (total, low, high)]
    told = dict(zip(_TOLD, (tree.active_voxels, None if box is None else box.tolist(), *numbers), strict=True))
    if density is None:
        if is_drawn:
            warnings.append(f"grid '{grid.name}' has no active voxels: there is nothing to draw")
        return told, None
    if tree.background[0] != 0:
        warnings.append(f"grid '{grid.name}' has the background {tree.background[0]:g}, which fills all space; it is "
                        "not drawn")
    return told, volume_of(stream.path, stream.place, grid.name, density.array, density.index_to_world)


def about(grid: Grid) -> Facts:
    """What its header tells."""
    matrix = grid.index_to_world
    return {"name": grid.name, "type": grid.type, "index_to_world": None if matrix is None else matrix.tolist()}


def _values(stream: Stream, grid: Grid, tree: Tree) -> Iterator[tuple[np.ndarray, int, np.ndarray]]:
    """Active values, some at a time: their first voxels (N, 3), how many voxels each has along each axis, and the
    values (N, channels)."""
    for tiles in tree.tiles:
        yield tiles.origins, tiles.size, tiles.values
    for first in range(0, len(tree.origins), BATCH):
        leaf, voxel, values = tree.leaf_values(stream, grid, first)
        if len(values):
            yield tree.origins[leaf] + VOXELS[voxel], 1, values


def _check(stream: Stream, grid: Grid, tree: Tree, box: np.ndarray | None) -> None:
    """Raises InputError if the file says other numbers of the grid than it has."""
    said = grid.whole("file_voxel_count", "q")
    if said is not None and said[0] != tree.active_voxels:
        raise stream.error(f"has {tree.active_voxels} active voxels, but says that it has {said[0]}")
    low, high = grid.whole("file_bbox_min", "3i"), grid.whole("file_bbox_max", "3i")
    if box is not None and low is not None and high is not None and box.tolist() != [list(low), list(high)]:
        raise stream.error(f"its voxels are in the box {box.tolist()}, but it says in {[list(low), list(high)]}")


class _Density:
    """The dense array (nz, ny, nx) of the active voxels' box and one voxel of nothing around it."""

    def __init__(self, stream: Stream, grid: Grid, box: np.ndarray) -> None:
        self._stream = stream
        assert grid.index_to_world is not None
        self._low = box[0] - 1
        shape = (box[1] - box[0] + 3).tolist()
        held = density_type(stream.path, stream.place, shape, grid.stored == np.float16)
        self.array = np.zeros(shape[::-1], held)
        self._strides = np.array([1, shape[0], shape[0] * shape[1]])
        self.index_to_world = grid.index_to_world.copy()
        self.index_to_world[:3, 3] += grid.index_to_world[:3, :3] @ self._low

    def put(self, origins: np.ndarray, size: int, values: np.ndarray) -> None:
        held = self.array.dtype
        if (bad := bad_density(values, held)) is not None:
            raise density_error(self._stream.path, self._stream.place, origins[bad].tolist(), float(values[bad]), held)
        if size == 1:
            self.array.reshape(-1)[(origins - self._low) @ self._strides] = values
            return
        for (x, y, z), value in zip((origins - self._low).tolist(), values):
            self.array[z:z + size, y:y + size, x:x + size] = value
