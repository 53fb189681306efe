"""What the paths of a sorted wavefront have brought to their homes since their blocks began."""

from __future__ import annotations

import moderngl
import numpy as np
from numpy.typing import NDArray

from ...gpu.float_target import float_target
from ..texels import put_texels
from .arrangement import Arrangement


class Gathered:
    """The pass `finish` draws into `finished` what each path that has ended adds to the sums of its home, where it
    goes in the next state, and 0 where none has ended. `take` adds that up in memory, and `textures` has the sums of
    blocks that were `show`n."""

    def __init__(self, gl: moderngl.Context, arrangement: Arrangement, size: tuple[int, int],
                 count: int, depth: moderngl.Renderbuffer) -> None:
        self._arrangement, self._size = arrangement, size
        self.textures = [float_target(gl, size) for _ in range(count)]
        self._drawn = [float_target(gl, size) for _ in range(count)]
        self.finished = gl.framebuffer(self._drawn, depth)
        self.finished.depth_mask = False
        self._sums = np.zeros((count, size[0] * size[1], 4), np.float32)
        self._rows = 0, 0

    def begin(self) -> None:
        """Clear `finished`, where the next state has paths that have ended. What was drawn before has been taken."""
        assert not self._rows[1]
        row, rows = self._rows = self._arrangement.ended_rows
        if rows:
            self.finished.clear(viewport=(0, row, self._size[0], rows))

    def take(self) -> None:
        """Add up what was drawn last. Waits for the device."""
        row, rows = self._rows
        if not rows:
            return
        homes = self._arrangement.homes(row, rows)
        texels = np.empty((len(homes), 4), np.float32)
        area = 0, row, self._size[0], rows
        for k, sums in enumerate(self._sums):
            self.finished.read_into(texels, viewport=area, components=4, attachment=k, dtype="f4")
            added = sums.take(homes, axis=0)
            added += texels
            put_texels(sums, homes, added)
        self._rows = 0, 0

    def show(self, blocks: NDArray[np.intp]) -> None:
        """Write the sums to `textures`, and begin anew for these blocks."""
        homes, width = self._arrangement.homes_of[blocks], self._size[0]
        first, last = int(homes.min()) // width, int(homes.max()) // width + 1
        for texture, sums in zip(self.textures, self._sums, strict=True):
            texture.write(sums[first * width:last * width], viewport=(0, first, width, last - first))
        self._sums[:, homes] = 0

    def release(self) -> None:
        self.finished.release()
        for texture in (*self._drawn, *self.textures):
            texture.release()
