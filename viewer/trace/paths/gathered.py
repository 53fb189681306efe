"""Sums of the light of the ended paths of a sorted wavefront, by the homes of the paths."""

from __future__ import annotations

import moderngl
import numpy as np
from numpy.typing import NDArray

from ...gpu.float_target import float_target
from ..texels import put_texels
from .arrangement import Arrangement


class Gathered:
    """The pass `finish` draws into `finished` what each path that has ended adds to the sums of its home, where it
    goes in the next state, of this `size`. `read` takes that, `add` adds it up in memory, and `textures` has the sums
    of all homes of blocks that were `show`n. Of paths that only may have ended, `depth` tells which have."""

    def __init__(self, gl: moderngl.Context, arrangement: Arrangement, size: tuple[int, int],
                 count: int, depth: moderngl.Renderbuffer | None) -> None:
        self._arrangement, self._size = arrangement, size
        homes = arrangement.homes_of.size
        self.textures = [float_target(gl, (size[0], homes // size[0])) for _ in range(count)]
        self._drawn = [float_target(gl, size) for _ in range(count)]
        self.finished = gl.framebuffer(self._drawn, depth)
        self.finished.depth_mask = False
        self._sums = np.zeros((count, homes, 4), np.float32)
        self._ended = 0, 0
        self._read: tuple[NDArray[np.intp], NDArray[np.float32]] | None = None

    def begin(self) -> None:
        """Make `finished` 0 where paths of the next state may have ended, if not all of it is drawn. What was drawn
        before has been read."""
        assert self._ended[0] == self._ended[1]
        self._ended = self._arrangement.ended
        if self.finished.depth_attachment is not None and self._ended[0] < self._ended[1]:
            self.finished.clear(viewport=self._rows)

    @property
    def _rows(self) -> tuple[int, int, int, int]:
        """The rectangle of all rows in which paths have ended."""
        width = self._size[0]
        row = self._ended[0] // width
        return 0, row, width, -(-self._ended[1] // width) - row

    def read(self) -> None:
        """Read what was drawn last. Waits for the device."""
        first, last = self._ended
        if first == last:
            return
        _, row, width, rows = self._rows
        ended = slice(first - row * width, last - row * width)
        homes = self._arrangement.homes(row, rows)[ended].copy()  # they change with the next state
        drawn = np.empty((len(self._sums), rows * width, 4), np.float32)
        for k, texels in enumerate(drawn):
            self.finished.read_into(texels, viewport=self._rows, components=4, attachment=k, dtype="f4")
        self._read, self._ended = (homes, drawn[:, ended]), (0, 0)

    def add(self) -> None:
        """Add what was read to the sums."""
        if self._read is None:
            return
        homes, drawn = self._read
        for sums, texels in zip(self._sums, drawn, strict=True):
            texels += sums.take(homes, axis=0)
            put_texels(sums, homes, texels)
        self._read = None

    def show(self, blocks: NDArray[np.intp]) -> None:
        """Write the sums to `textures`, and begin anew for these blocks."""
        homes, width = self._arrangement.homes_of[blocks], self._size[0]
        first, last = int(homes.min()) // width, int(homes.max()) // width + 1
        for texture, sums in zip(self.textures, self._sums, strict=True):
            texture.write(sums[first * width:last * width], viewport=(0, first, width, last - first))
        for sums in self._sums:
            put_texels(sums, homes.ravel(), np.zeros((1, 4), np.float32))

    def release(self) -> None:
        self.finished.release()
        for texture in (*self._drawn, *self.textures):
            texture.release()
