"""Where the paths of a wavefront lie, so that those of one class lie side by side.

A CPU shades eight neighbouring texels at once, and takes as long for one of them as for all. Paths of different classes
lie mixed after a few bounces. So on a CPU each shading writes the next state in the order of classes, which are known
where Embree has traced the rays in memory.
"""

from __future__ import annotations

from collections.abc import Iterator

import moderngl
import numpy as np
from numpy.typing import NDArray

from ..layout import NO_KIND, TILE
from ..rays.intersect import CLASS_OF_IDLE

UNITS = {"u_source": 24, "u_home": 25, "u_place": 26}
"""Texture units, beyond that of viewer/trace/paths/sky.py."""


class Arrangement:
    """Of a wavefront of `grid` (columns, rows) blocks of TILE x TILE homes, of which as many as `height` rows of texels
    hold can have a path at once. The columns divide TILE, so that the paths of a block fill whole rows: those that
    begin are drawn by rows.

    A path keeps its home: the texel of its block and pixel, where its sums are. Its place in the present state is
    another texel. Texels are numbered row by row. `rows` is the number of rows of the present state whose paths may not
    be idle: those after them are. shaders/trace/arrangement.glsl reads the textures: `u_home` has for each texel of
    these rows the home of its path, `u_source` for each texel of the next state the place in the present one from which
    its path comes, and `u_place`, with `finds_places`, for each home the place of its path, or -1.
    """

    def __init__(self, gl: moderngl.Context, grid: tuple[int, int], height: int, finds_places: bool) -> None:
        columns, rows = grid
        assert TILE % columns == 0 and height <= rows * TILE and not (finds_places and height < rows * TILE)
        self._size = columns * TILE, height
        numbers = np.arange(columns * rows * TILE**2)
        x, y = np.arange(columns * TILE, dtype=np.int32), np.arange(rows * TILE, dtype=np.int32)[:, None]
        self._texels = (y << 16 | x).ravel()  # as the shader reads them
        self._block = (y // TILE * columns + x // TILE).ravel()  # of each home
        self.homes_of = numbers.reshape(rows, TILE, columns, TILE).swapaxes(1, 2).reshape(columns * rows, TILE**2)
        """(blocks, TILE^2), the homes of each block."""
        self._textures = {name: gl.texture(self._size, 1, dtype="i4") for name in UNITS}
        for texture in self._textures.values():
            texture.filter = moderngl.NEAREST, moderngl.NEAREST
        self._home, self._finds_places = numbers, finds_places  # of each texel, and behind them those without any
        self._next: NDArray[np.intp] = numbers[:0]
        self._used = self.rows = self.next_rows = 0
        self._is_shown = False
        self.alive = np.zeros(len(self.homes_of), bool)
        """Which blocks had paths that were not idle when they were sorted last, (blocks,)."""
        self._ends = np.zeros(CLASS_OF_IDLE + 2, np.intp)  # in the next state, of the class before each

    def homes(self, row: int, rows: int) -> NDArray[np.intp]:
        """The homes of the paths in so many rows of the present state."""
        return self._home[row * self._size[0]:(row + rows) * self._size[0]]

    def sort(self, classes: NDArray[np.uint8]) -> None:
        """Let the next state have the present paths of the first rows in the order of their `classes`
        (`viewer.trace.rays.intersect.Answer`), those of one class in their own."""
        order = np.argsort(classes, kind="stable")
        self._ends[1:] = np.bincount(classes, minlength=CLASS_OF_IDLE + 1).cumsum()
        self._write("u_source", self._texels[order])
        self._next = self._home[order]
        self._used = self._run(CLASS_OF_IDLE)[0]
        self.next_rows = self._row_after(self._used)

    def _run(self, path_class: int) -> tuple[int, int]:
        """The first texel in the next state of the paths of one of `classes`, and the one behind the last."""
        return int(self._ends[path_class]), int(self._ends[path_class + 1])

    @property
    def ended(self) -> tuple[int, int]:
        """The first texel in the next state of the paths that have ended, and the one behind the last."""
        return self._run(NO_KIND)

    def rectangles(self, path_class: int) -> Iterator[tuple[int, int, int, int]]:
        """The texels of one of `classes` in the rows of the next state: x, y, width and height of a part of a row, of
        whole rows, and of a part of a row."""
        width = self._size[0]
        first, last = (min(texel, self.next_rows * width) for texel in self._run(path_class))
        while first < last:
            y, x = divmod(first, width)
            is_whole = x == 0 and last - first >= width
            rows, columns = ((last - first) // width, width) if is_whole else (1, min(width - x, last - first))
            yield x, y, columns, rows
            first += rows * columns

    def advance(self) -> None:
        """The next state has become the present one."""
        self._home[:len(self._next)] = self._next
        self.rows = self.next_rows
        self._is_shown = False

    def _show(self) -> None:
        """Write where the homes of the present state are. To write it before the last shading is done would wait for
        that."""
        if self._is_shown:
            return
        self._is_shown = True
        homes = self.homes(0, self.rows)
        self._write("u_home", self._texels[homes])
        if self._finds_places:
            place = np.full_like(self._texels, -1)
            place[homes] = self._texels[:len(homes)]
            self._write("u_place", place)

    def _write(self, name: str, texels: NDArray[np.int32]) -> None:
        """Write the first rows of a texture."""
        if len(texels):
            self._textures[name].write(texels, viewport=(0, 0, self._size[0], len(texels) // self._size[0]))

    def find_alive(self) -> None:
        """Set `alive`. To be called after `advance`."""
        self.alive[:] = False
        self.alive[self._block[self._home[:self._used]]] = True

    @property
    def room(self) -> int:
        """How many paths can begin behind those that were not idle when they were sorted, in whole rows."""
        return (self._size[1] - self._row_after(self._used)) * self._size[0]

    def _row_after(self, texels: int) -> int:
        return -(-texels // self._size[0])

    def begin(self, blocks: NDArray[np.intp], chosen: NDArray[np.bool_]) -> tuple[int, int]:
        """Give places in whole rows to the paths of blocks that have none; returns the first row and their number. Only
        `chosen` homes, (blocks, TILE^2), have a path, and others of these blocks fill the last row."""
        count = self._row_after(int(np.count_nonzero(chosen))) * self._size[0]
        homes = self.homes_of[blocks].ravel()[np.argsort(~chosen.ravel(), kind="stable")[:count]]
        row = self._row_after(self._used)
        first, rows = row * self._size[0], count // self._size[0]
        home, begun = self._home, np.zeros(len(self._home), bool)
        begun[homes] = True
        elsewhere = np.flatnonzero(begun[home])
        elsewhere = elsewhere[(elsewhere < first) | (elsewhere >= first + count)]
        there = home[first:first + count]
        home[elsewhere] = there[~begun[there]]
        home[first:first + count] = homes
        self.rows = max(self.rows, row + rows)
        self._is_shown = False
        return row, rows

    def bind(self) -> None:
        """Bind the textures to their units."""
        self._show()
        for name, texture in self._textures.items():
            texture.use(UNITS[name])

    def release(self) -> None:
        for texture in self._textures.values():
            texture.release()
