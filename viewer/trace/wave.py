"""A wave: many paths that go on together, a texel of some textures each."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import moderngl
import numpy as np

TILE = 16
"""Slots of a block, and pixels of a tile, along each side."""
STATE = ("origin", "direction", "shadow_origin", "shadow_vector", "throughput", "radiance", "medium")
"""The textures of a state, in the order of their units and attachments; shaders/trace/state.glsl tells what is in them."""
UNIT_HIT, UNIT_BLOCKS = len(STATE), len(STATE) + 1
MAX_SAMPLES = 1023
"""Of one work item: what a slot's counter holds."""


class Work(NamedTuple):
    """So many samples, from number `first` on, of each pixel of a tile."""

    tile_x: int
    tile_y: int
    first: int
    samples: int


class Sums:
    """Two textures of floats that are added to."""

    def __init__(self, gl: moderngl.Context, size: tuple[int, int]) -> None:
        self.textures = [float_target(gl, size) for _ in range(2)]
        self.framebuffer = gl.framebuffer(self.textures)
        self.clear()

    def clear(self) -> None:
        self.framebuffer.clear()

    def release(self) -> None:
        for thing in (self.framebuffer, *self.textures):
            thing.release()


class Wave:
    """`columns` x `rows` blocks of TILE x TILE slots.

    The textures of the present state are attributes by their names in `STATE`; passes read them and write `next`, and
    `turn` makes that the present one. `hit` is where an intersector puts its answer.
    """

    origin: moderngl.Texture
    direction: moderngl.Texture
    shadow_origin: moderngl.Texture
    shadow_vector: moderngl.Texture
    throughput: moderngl.Texture
    radiance: moderngl.Texture
    medium: moderngl.Texture

    def __init__(self, gl: moderngl.Context, columns: int, rows: int, has_layers: bool) -> None:
        self.columns, self.rows = columns, rows
        self.size = columns * TILE, rows * TILE
        self._states = [[float_target(gl, self.size) for _ in STATE] for _ in range(2)]
        self._framebuffers = [gl.framebuffer(textures) for textures in self._states]
        self._present = 0
        self.hit = gl.texture(self.size, 4, dtype="u4")
        self.blocks = gl.texture((columns, rows), 4, dtype="i4")
        for texture in (self.hit, self.blocks):
            texture.filter = moderngl.NEAREST, moderngl.NEAREST
        self.sums = Sums(gl, self.size)
        self.layers = Sums(gl, self.size) if has_layers else None
        self.work: Sequence[Work] = ()

    def __getattr__(self, name: str) -> moderngl.Texture:
        if name not in STATE:
            raise AttributeError(name)
        return self._states[self._present][STATE.index(name)]

    @property
    def next(self) -> moderngl.Framebuffer:
        return self._framebuffers[1 - self._present]

    def turn(self) -> None:
        self._present = 1 - self._present

    def begin(self, work: Sequence[Work]) -> None:
        """Hand the blocks their work, at most one item each; those left over will idle."""
        table = np.zeros((self.columns * self.rows, 4), np.int32)
        table[: len(work)] = np.asarray(work, np.int32).reshape(-1, 4)
        self.blocks.write(table)
        self.work = work
        self.sums.clear()
        if self.layers is not None:
            self.layers.clear()

    def bind(self) -> None:
        """The present state, the hits and the blocks, to the units that `UNITS` names."""
        for unit, texture in enumerate((*self._states[self._present], self.hit, self.blocks)):
            texture.use(unit)

    def release(self) -> None:
        for thing in (*self._framebuffers, *self._states[0], *self._states[1], self.hit, self.blocks, self.sums,
                      self.layers):
            if thing is not None:
                thing.release()


UNITS = {f"u_{name}": unit for unit, name in enumerate(STATE)} | {"u_hit": UNIT_HIT, "u_blocks": UNIT_BLOCKS}
"""Uniforms of shaders/trace/state.glsl and the texture units of `Wave.bind`."""


def float_target(gl: moderngl.Context, size: tuple[int, int]) -> moderngl.Texture:
    """RGBA32F to be drawn into and read texel by texel."""
    texture = gl.texture(size, 4, dtype="f4")
    texture.filter = moderngl.NEAREST, moderngl.NEAREST
    return texture
