"""Decides, by a shader on a list of hits, which shadow rays pass the see-through triangles that they hit."""

from __future__ import annotations

import moderngl
import numpy as np
from numpy.typing import NDArray

from ...gpu.context import Context
from ...gpu.fullscreen import fullscreen
from ...gpu.program import compile_program
from ...gpu.programs import set_uniform
from ..defines import shader_defines
from .intersect import Surfaces

MAX_LAYERS = 64
"""A shadow ray that has passed this many see-through triangles counts as occluded."""

HITS_UNIT = 15
"""The texture unit of the list. The units below are for the textures of the surfaces."""

_WIDTH = 256


class SeeThrough:
    """The program and the texture for the list of hits."""

    def __init__(self, context: Context, surfaces: Surfaces) -> None:
        self._gl = context.gl
        self._surfaces = surfaces
        self._program = compile_program(
            context, vertex="display/fullscreen.vert", fragment="trace/see_through.frag",
            defines=shader_defines(surfaces.switches),
        )
        self._resize(1)

    def _resize(self, rows: int) -> None:
        self._rows = rows
        self._hits = self._gl.texture((2 * _WIDTH, rows), 4, dtype="u4")
        self._hits.filter = moderngl.NEAREST, moderngl.NEAREST
        self._answers = self._gl.texture((_WIDTH, rows), 1)
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
        answers = self._target.read(viewport=(0, 0, _WIDTH, rows), components=1)
        return np.frombuffer(answers, np.uint8)[:count] > 0
