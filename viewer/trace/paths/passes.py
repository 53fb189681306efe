"""The passes that shade a wave, with what their programs are told."""

from __future__ import annotations

from collections.abc import Callable, Mapping

import moderngl
import numpy as np

from ...gpu.context import Context
from ...gpu.fullscreen import fullscreen
from ...gpu.programs import Programs, set_uniform
from ..kinds import FINISH, FIRST_HIT, KINDS, REST, SHADE
from ..layout import shader_defines
from ..plan import TracePlan
from .wavefront import UNITS, Wave

_DUTIES = {"rest": REST, "finish": FINISH, "generate": FINISH, "layers": FIRST_HIT,
           **{kind.name: SHADE + kind.number for kind in KINDS}}
_OVER_BLOCKS = ("begin", "zero")


class Passes:
    """`bind` binds the scene's textures and sets its uniforms in a program; `uniforms` are those of the picture."""

    def __init__(self, context: Context, programs: Programs, plan: TracePlan,
                 bind: Callable[[moderngl.Program], None], uniforms: Mapping[str, object]) -> None:
        self.context = context
        self._gl = context.gl
        self._bind = bind
        self._uniforms = {**uniforms, **UNITS}
        self._surfaces = plan.surfaces
        self._programs = {}
        for name, program in plan.programs.items():
            vertex = "trace/blocks.vert" if name in _OVER_BLOCKS else "trace/duty.vert"
            if name == "alive":
                vertex = "display/fullscreen.vert"
            self._programs[name] = programs.get(vertex, program.fragment, shader_defines(dict(program.switches)))

    def begin(self, wave: Wave, blocks: np.ndarray) -> None:
        """The first camera rays of blocks that have new work; their sums begin at 0."""
        self._gl.enable_only(moderngl.NOTHING)
        wave.bind_blocks()
        for sums in (wave.sums, wave.layers):
            if sums is not None:
                sums.framebuffer.use()
                wave.draw_blocks(self._told("zero", u_grid=wave.grid), blocks)
        wave.present.use()
        wave.draw_blocks(self._told("begin", u_grid=wave.grid), blocks)

    def shade(self, wave: Wave) -> None:
        """What comes of the wave's hits: the next state.

        No pass reads what another has drawn, so that a driver need not wait between them.
        """
        gl = self._gl
        wave.bind()
        gl.blend_func = moderngl.ONE, moderngl.ONE
        if wave.layers is not None:
            self._sort(wave, "sort first hits")
            wave.layers.framebuffer.use()
            gl.enable_only(moderngl.DEPTH_TEST | moderngl.BLEND)
            self._draw("layers")
        self._sort(wave, "sort")
        wave.sums.framebuffer.use()
        gl.enable_only(moderngl.DEPTH_TEST | moderngl.BLEND)
        self._draw("finish")
        wave.next.use()
        gl.enable_only(moderngl.DEPTH_TEST)
        for name in ("generate", *self._surfaces):
            self._draw(name)
        wave.next_origin.use()
        self._draw("rest")
        gl.depth_func = "<"
        wave.turn()

    def find_alive(self, wave: Wave) -> np.ndarray:
        """(blocks,) bool, whether something is to be done in a block. Waits for the device."""
        wave.bind()
        wave.alive.use()
        self._gl.enable_only(moderngl.NOTHING)
        self._draw("alive")
        return np.frombuffer(wave.alive.read(components=1), np.uint8) > 0

    def _sort(self, wave: Wave, name: str) -> None:
        wave.duty.use()
        self._gl.enable_only(moderngl.DEPTH_TEST)
        self._gl.depth_func = "1"  # always
        self._draw(name)
        self._gl.depth_func = "=="

    def _draw(self, name: str) -> None:
        program = self._told(name, u_duty=_DUTIES.get(name, REST))
        fullscreen(self._gl, program).render(vertices=3)

    def _told(self, name: str, **uniforms: object) -> moderngl.Program:
        program = self._programs[name]
        self._bind(program)
        for uniform, value in (self._uniforms | uniforms).items():
            set_uniform(program, uniform, value)
        return program
