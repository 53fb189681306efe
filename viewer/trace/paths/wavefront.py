"""A wavefront: many paths that advance together. Each path is one texel of several textures."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import moderngl
import numpy as np
from numpy.typing import NDArray

from ...gpu.context import Context
from ...gpu.float_depth import float_depth_renderbuffer
from ...gpu.float_target import float_target
from ..layout import LEFT_BITS, TILE
from ..rays.intersect import Answer
from .arrangement import UNITS as ARRANGED
from .arrangement import Arrangement
from .gathered import Gathered

STATE = ("origin", "direction", "shadow_vector", "throughput", "radiance", "shadow_origin", "medium")
"""The textures of a state, in the order of their units and attachments. shaders/trace/state.glsl describes them. There
is no medium if nothing transmits light, and no shadow_origin if, besides, each path's rays begin at one place."""
SUMS, LAYERS = 2, 3
"""Number of textures to which the passes finish and layers add."""
UNIT_HIT, UNIT_BLOCKS = len(STATE), len(STATE) + 1
UNIT_ALONG, UNIT_FLIGHT = 19, 20  # beyond those of viewer/trace/paths/surface_rays.py
UNIT_CHOSEN = 27  # beyond those of viewer/trace/paths/arrangement.py
UNITS = {f"u_{name}": unit for unit, name in enumerate(STATE)} | {
    "u_hit": UNIT_HIT, "u_blocks": UNIT_BLOCKS, "u_along": UNIT_ALONG, "u_flight": UNIT_FLIGHT,
    "u_chosen": UNIT_CHOSEN} | ARRANGED
"""Uniforms of shaders/trace/state.glsl and the texture units of `Wavefront.bind`."""


SECOND = 1 << 23
"""Number of the first sample of the second part of a film."""


MOST_SAMPLES = (1 << LEFT_BITS) - 1
"""Of a work item."""


class Work(NamedTuple):
    """A work item: `samples` samples, at most MOST_SAMPLES, from number `first` on, of each pixel of a tile, or only of
    its `pixels`, (TILE, TILE), row 0 at the bottom."""

    tile_x: int
    tile_y: int
    first: int
    samples: int
    pixels: NDArray[np.bool_] | None = None


class Sums:
    """Float textures that collect sums by blending. They are 0 with `is_zero`, else a pass begins them."""

    def __init__(self, gl: moderngl.Context, size: tuple[int, int], count: int,
                 depth: moderngl.Texture | moderngl.Renderbuffer | None = None, is_zero: bool = True) -> None:
        self.textures = [float_target(gl, size) for _ in range(count)]
        self.framebuffer = gl.framebuffer(self.textures, depth)
        if is_zero:
            self.framebuffer.clear()
        self.framebuffer.depth_mask = False

    def release(self) -> None:
        self.framebuffer.release()
        for texture in self.textures:
            texture.release()


class Wavefront:
    """`columns` x `rows` blocks of TILE x TILE paths, with the first `textures` of those in `STATE`. If it is sorted,
    there can be `more_homes` times as many blocks, of which those have few paths whose work is for few pixels of its
    tile, or of whose tile few are `covered` (`viewer.trace.paths.sky.Sky`).

    There are two states. The textures of the present one are attributes, by their names in `STATE`; `shadow_origin` is
    `origin` without one of its own. Passes read them and write `next`, and `swap` makes that the present one. An
    intersector writes `hit` and, with `has_along`, `along` (viewer/trace/rays/intersect.py). `classes` has the class of
    each path as a depth value, and `alive` says for each block, in one texel, whether any of its paths is not idle.
    With `is_sorted` an `arrangement` says where the paths lie; else each lies in the texel of its block and pixel. With
    `knows_classes` it tells their classes, too.
    `work`, (blocks, 4) int32, has the work items of the blocks, as in `Work`. `is_busy`, (blocks,), says which of them
    may not be done yet. With `chooses`, `chosen`, (blocks, TILE, TILE), says which pixels the work of a block is for.
    """

    origin: moderngl.Texture
    direction: moderngl.Texture
    shadow_origin: moderngl.Texture
    shadow_vector: moderngl.Texture
    throughput: moderngl.Texture
    radiance: moderngl.Texture
    medium: moderngl.Texture

    def __init__(self, context: Context, columns: int, rows: int, textures: int, has_layers: bool,
                 has_along: bool = False, has_grids: bool = False, sees_backs: bool = False,
                 is_sorted: bool = False, chooses: bool = False, more_homes: int = 1,
                 covered: NDArray[np.bool_] | None = None, knows_classes: bool = False) -> None:
        gl = self._gl = context.gl
        self.grid = columns, rows * more_homes
        self.sees_backs = sees_backs
        self.size = columns * TILE, rows * TILE
        homes = columns * TILE, rows * TILE * more_homes
        self.arrangement = Arrangement(gl, self.grid, self.size[1], has_layers) if is_sorted else None
        depth = float_depth_renderbuffer(context, self.size)
        self.classes = gl.framebuffer(depth_attachment=depth)
        self._states = [[float_target(gl, self.size) for _ in range(textures)] for _ in range(2)]
        self._targets = [gl.framebuffer(textures, depth) for textures in self._states]
        self._origins = [gl.framebuffer(textures[:1], depth) for textures in self._states]
        for target in (*self._targets, *self._origins):
            target.depth_mask = False
        self._present = 0
        if not is_sorted:  # which draws all that is read
            for target in self._targets:
                target.clear()
        self.hit = gl.texture(self.size, 4, dtype="u4")
        self.along = float_target(gl, self.size) if has_along else None
        self._along_volumes = [float_target(gl, self.size) for _ in range(2)] if has_grids else []
        self.tracked = gl.framebuffer(self._along_volumes) if has_grids else None
        self._work_items = gl.texture(self.grid, 4, dtype="i4")
        for texture in (self.hit, self._work_items):
            texture.filter = moderngl.NEAREST, moderngl.NEAREST
        blocks = columns * rows * more_homes
        self._block_numbers = gl.buffer(reserve=4 * blocks)
        self._arrays: dict[moderngl.Program, moderngl.VertexArray] = {}
        self.alive = gl.framebuffer([gl.texture(self.grid, 1)])
        self.sums = Sums(gl, homes, SUMS, None if is_sorted else depth, is_zero=False)
        self.layers = Sums(gl, self.size, LAYERS, depth) if has_layers else None
        self.gathered: Gathered | None = None
        if self.arrangement is not None:
            self.gathered = Gathered(gl, self.arrangement, self.size, SUMS, None if knows_classes else depth)
        self._knows_classes = knows_classes
        self.begun_rows = 0, 0
        """The first row, and the number of rows, of a sorted wavefront that have the paths of work assigned last."""
        self._covered = covered
        self.work = np.zeros((blocks, 4), np.int32)
        self.is_busy = np.zeros(blocks, bool)
        self.chosen = np.ones((blocks, TILE, TILE), bool) if chooses else None
        self._chosen = gl.texture(homes, 1, alignment=1) if chooses else None
        if self._chosen is not None:
            self._chosen.filter = moderngl.NEAREST, moderngl.NEAREST

    def __getattr__(self, name: str) -> moderngl.Texture:
        if name not in STATE:
            raise AttributeError(name)
        state = self._states[self._present]
        return state[STATE.index(name) if STATE.index(name) < len(state) else STATE.index("origin")]

    @property
    def present(self) -> moderngl.Framebuffer:
        """The framebuffer of the present state."""
        return self._targets[self._present]

    @property
    def next(self) -> moderngl.Framebuffer:
        """The framebuffer of the next state, which is present after `swap`."""
        return self._targets[1 - self._present]

    @property
    def next_origin(self) -> moderngl.Framebuffer:
        """The framebuffer of only the origins of the next state, which hold the status."""
        return self._origins[1 - self._present]

    def sort(self, answer: Answer) -> None:
        """Arrange the next state by the classes of the paths, and draw of it at most the rows whose paths are not
        idle."""
        assert self.arrangement is not None and self.gathered is not None
        self.arrangement.sort(answer.classes)
        self.gathered.begin()
        if self._knows_classes:
            return
        area = 0, 0, self.size[0], self.arrangement.next_rows
        for target in (self.classes, self.next, self.next_origin, self.gathered.finished):
            target.scissor = area

    def swap(self) -> None:
        """Make the next state the present one."""
        self._present = 1 - self._present
        if self.arrangement is not None:
            self.arrangement.advance()

    @property
    def room(self) -> int:
        """How many paths can begin, in blocks that have no work."""
        free = int(np.count_nonzero(~self.is_busy)) * TILE**2
        return free if self.arrangement is None else min(free, self.arrangement.room)

    @property
    def rows(self) -> int:
        """The number of rows whose paths may not be idle: all after them are."""
        return self.size[1] if self.arrangement is None else self.arrangement.rows

    def read(self, name: str, texels: NDArray[np.float32]) -> None:
        """Read these rows of a texture of the present state into the first of `texels`, (N, 4). Waits for the
        device."""
        if self.rows:
            self.present.read_into(texels, viewport=(0, 0, self.size[0], self.rows), components=4,
                                   attachment=STATE.index(name), dtype="f4")

    def settle(self) -> None:
        """Find in memory which blocks are done, and what they have brought, while the threads shade and trace."""
        if self.gathered is not None:
            self.gathered.add()
        if self.arrangement is not None:
            self.arrangement.find_alive()

    def assign(self, blocks: np.ndarray, work: Sequence[Work]) -> None:
        """Give a work item to each of the blocks with these numbers."""
        self.work[blocks] = np.asarray([item[:4] for item in work], np.int32).reshape(-1, 4)
        self.is_busy[blocks] = True
        self._work_items.write(self.work)
        if self.chosen is not None and self._chosen is not None:
            for block, item in zip(blocks.tolist(), work, strict=True):
                self.chosen[block] = True if item.pixels is None else item.pixels
            columns, rows = self.grid
            texels = self.chosen.reshape(rows, columns, TILE, TILE).swapaxes(1, 2)
            self._chosen.write((texels * np.uint8(255)).tobytes())
        if self.arrangement is not None:
            self.begun_rows = self.arrangement.begin(blocks, self.traced(work))

    def traced(self, work: Sequence[Work]) -> NDArray[np.bool_]:
        """For which pixels work items have paths that take a place, (items, TILE^2)."""
        traced = np.ones((len(work), TILE, TILE), bool)
        if self._covered is not None:
            traced = self._covered[[item.tile_y for item in work], [item.tile_x for item in work]]
        for own, item in zip(traced, work, strict=True):
            if item.pixels is not None and self.arrangement is not None:
                own &= item.pixels
        return traced.reshape(len(work), TILE**2)

    def bind(self) -> None:
        """Bind the present state, the hits and the work items to the units in `UNITS`."""
        self.origin.use(UNITS["u_shadow_origin"])
        for unit, texture in enumerate(self._states[self._present]):
            texture.use(unit)
        self.hit.use(UNIT_HIT)
        if self.along is not None:
            self.along.use(UNIT_ALONG)
        if self.arrangement is not None:
            self.arrangement.bind()
        self.bind_blocks()

    def bind_tracked(self) -> None:
        """Bind what the pass through volumes has drawn, in place of what the intersector found along the rays."""
        for unit, texture in zip((UNIT_ALONG, UNIT_FLIGHT), self._along_volumes):
            texture.use(unit)

    def bind_blocks(self) -> None:
        """Bind only the work items of the blocks, and which pixels they are for."""
        self._work_items.use(UNIT_BLOCKS)
        if self._chosen is not None:
            self._chosen.use(UNIT_CHOSEN)

    def draw_blocks(self, program: moderngl.Program, blocks: np.ndarray) -> None:
        """Draw a square for each block, with a program whose vertex shader takes `a_block`."""
        if program not in self._arrays:
            self._arrays[program] = self._gl.vertex_array(program, [(self._block_numbers, "1i4/i", "a_block")])
        self._block_numbers.write(np.ascontiguousarray(blocks, np.int32))
        self._arrays[program].render(moderngl.TRIANGLE_STRIP, vertices=4, instances=len(blocks))

    def release(self) -> None:
        for thing in (*self._targets, *self._origins, *self._states[0], *self._states[1], self.classes.depth_attachment,
                      self.classes, self.hit, self.along, self.tracked, *self._along_volumes,
                      self._work_items, self._chosen, *self._arrays.values(), self._block_numbers, self.arrangement,
                      self.gathered, *self.alive.color_attachments, self.alive, self.sums, self.layers):
            if thing is not None:
                thing.release()
