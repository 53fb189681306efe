"""What photons have brought to the pixels of a picture."""

from __future__ import annotations

import moderngl
import numpy as np

from ...gpu.over_picture import draw_over
from ...gpu.programs import Programs
from ..defines import shader_defines
from .wavefront import SUMS, Sums


class PhotonSums:
    """Sums over photons, of a picture of `size` (width, height): of rgb and of its squares, row 0 at the bottom."""

    def __init__(self, gl: moderngl.Context, programs: Programs, size: tuple[int, int]) -> None:
        self._gl, self._programs, self.size = gl, programs, size
        self._sums = Sums(gl, size, SUMS)
        self.count = 0
        """Number of photons whose light is in the sums."""
        self.parts: tuple[PhotonSums, ...] = ()
        """Others, to one of which each addition goes, too: that with the fewest photons."""

    @property
    def textures(self) -> dict[str, moderngl.Texture]:
        """By the names of their samplers: (rgb, splats), and (rgb squared, splats that were not finite)."""
        return dict(zip(("u_photon_sum", "u_photon_squares"), self._sums.textures, strict=True))

    def add(self, splats: Sums, count: int) -> None:
        """Add the splats of `count` photons."""
        program = self._programs.get("display/fullscreen.vert", "trace/film/add.frag", shader_defines())
        sources = dict(zip(("u_sum", "u_squares"), splats.textures, strict=True))
        draw_over(self._gl, program, self._sums.framebuffer, sources, moderngl.BLEND)
        self.count += count
        if self.parts:
            min(self.parts, key=lambda part: part.count).add(splats, count)

    @property
    def bad(self) -> int:
        """Number of splats that were not finite and so were left out."""
        width, height = self.size
        squares = self._sums.framebuffer.read(components=4, attachment=1, dtype="f4")
        return round(float(np.frombuffer(squares, np.float32).reshape(height, width, 4)[..., 3].sum()))

    def release(self) -> None:
        self._sums.release()
