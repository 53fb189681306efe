"""Decides, by a shader on a list of hits, which shadow rays pass surfaces, and with what part of their light."""

from __future__ import annotations

import moderngl
import numpy as np
from numpy.typing import DTypeLike, NDArray

from ...gpu.context import Context
from ...gpu.fullscreen import fullscreen
from ...gpu.program import compile_program
from ...gpu.programs import set_uniform
from ..defines import surface_defines
from .intersect import Surfaces

HITS_UNIT = 15
"""The texture unit of the list. The units below are for the textures of the surfaces."""

_WIDTH = 256


class SeeThrough:
    """The program and the texture for the list of hits."""

    def __init__(self, context: Context, surfaces: Surfaces) -> None:
        self._gl = context.gl
        self._surfaces = surfaces
        self._has_panes = bool(surfaces.switches["HAS_PANES"])
        self._program = compile_program(
            context, vertex="display/fullscreen.vert", fragment="trace/see_through.frag",
            defines=surface_defines(surfaces.switches),
        )
        self._resize(1)

    def _resize(self, rows: int) -> None:
        self._rows = rows
        self._hits = self._gl.texture((2 * _WIDTH, rows), 4, dtype="u4")
        self._hits.filter = moderngl.NEAREST, moderngl.NEAREST
        channels, dtype = (4, "f4") if self._has_panes else (1, "f1")
        self._answers = self._gl.texture((_WIDTH, rows), channels, dtype=dtype)
        self._target = self._gl.framebuffer([self._answers])

    def release(self) -> None:
        self._release_list()
        fullscreen(self._gl, self._program).release()
        self._program.release()

    def _release_list(self) -> None:
        for thing in (self._target, self._hits, self._answers):
            thing.release()

    def pass_through(self, hits: NDArray[np.uint32], vectors: NDArray[np.float32]) -> NDArray[np.bool_]:
        """Whether each shadow ray passes, (N,), for (N, 4) texels of the hit texture and (N, 3) shadow vectors."""
        return self._read(hits, vectors, 1, "f1", np.uint8)[:, 0] > 0

    def transmittance(self, hits: NDArray[np.uint32], vectors: NDArray[np.float32]) -> NDArray[np.float32]:
        """The part of their light that passes, (N, 3), for the same."""
        if self._has_panes:
            return self._read(hits, vectors, 3, "f4", np.float32)
        return np.repeat(self.pass_through(hits, vectors)[:, None], 3, axis=1).astype(np.float32)

    def _read(self, hits: NDArray[np.uint32], vectors: NDArray[np.float32], components: int, dtype: str,
              number: DTypeLike) -> NDArray:
        """What the shader says of each hit, (N, components)."""
        count = len(hits)
        rows = -(-count // _WIDTH)
        if rows > self._rows:
            self._release_list()
            self._resize(rows)
        texels = np.zeros((rows * _WIDTH, 2, 4), np.uint32)
        texels[:count, 0] = hits
        texels[:count, 1, :3] = np.ascontiguousarray(vectors).view(np.uint32)
        self._hits.write(texels, viewport=(0, 0, 2 * _WIDTH, rows))
        self._target.use()
        self._target.viewport = 0, 0, _WIDTH, rows
        self._gl.enable_only(moderngl.NOTHING)
        self._surfaces.bind(self._program)
        self._hits.use(HITS_UNIT)
        set_uniform(self._program, "u_hits", HITS_UNIT)
        fullscreen(self._gl, self._program).render(vertices=3)
        answers = self._target.read(viewport=(0, 0, _WIDTH, rows), components=components, dtype=dtype)
        return np.frombuffer(answers, number).reshape(-1, components)[:count]
