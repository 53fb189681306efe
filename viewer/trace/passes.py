"""The passes that shade a wave, with what their programs are told."""

from __future__ import annotations

from collections.abc import Callable, Mapping

import moderngl

from ..gpu.context import Context
from ..raster.display import fullscreen
from ..raster.programs import Programs, set_uniform
from .plan import TracePlan
from .wave import UNITS, Wave

_ADDED = ("finish", "layers")
"""Passes that add to a wave's sums; the others write its next state, each slot by one of them."""


class Passes:
    """`bind` binds the scene's textures and sets its uniforms in a program; `uniforms` are those of the picture."""

    def __init__(self, context: Context, programs: Programs, plan: TracePlan,
                 bind: Callable[[moderngl.Program], None], uniforms: Mapping[str, object]) -> None:
        self.context = context
        self._gl = context.gl
        self._bind = bind
        self._uniforms = {**uniforms, **UNITS}
        self._programs = {name: programs.get("display/fullscreen.vert", program.fragment, dict(program.switches))
                          for name, program in plan.programs.items()}

    def begin(self, wave: Wave) -> None:
        """Every slot's first camera ray; what the slots held before is forgotten."""
        wave.bind()
        wave.next.use()
        self._gl.enable_only(moderngl.NOTHING)
        self._draw("generate", begins=True)
        wave.turn()

    def shade(self, wave: Wave, query: moderngl.Query) -> None:
        """What comes of the wave's hits: the next state. `query` counts the samples that are finished."""
        wave.bind()
        self._gl.enable_only(moderngl.BLEND)
        self._gl.blend_func = moderngl.ONE, moderngl.ONE
        wave.sums.framebuffer.use()
        with query:
            self._draw("finish")
        if wave.layers is not None:
            wave.layers.framebuffer.use()
            self._draw("layers")
        wave.next.use()
        self._gl.enable_only(moderngl.NOTHING)
        for name in self._programs:
            if name not in _ADDED:
                self._draw(name)
        wave.turn()

    def _draw(self, name: str, begins: bool = False) -> None:
        program = self._programs[name]
        self._bind(program)
        for uniform, value in self._uniforms.items():
            set_uniform(program, uniform, value)
        set_uniform(program, "u_begin", begins)
        fullscreen(self._gl, program).render(vertices=3)
