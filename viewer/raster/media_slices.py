"""The textures that rays through media are marched into: a 3D texture of slices, and what goes on to the next ones."""

from __future__ import annotations

import ctypes

import moderngl
import numpy as np

from ..gpu.context import Context
from ..gpu.fullscreen import fullscreen
from ..gpu.programs import Programs, matrix_uniform, set_uniform
from ..plan.media import SLICE_COUNT, SLICES
from ..plan.model import Program
from ..scene.frame import Frame
from .gbuffer import nearest_texture
from .units import UNIT_CARRIED

_FRAMEBUFFER, _COLOR_ATTACHMENT = 0x8D40, 0x8CE0


class MediaSlices:
    """`texture` has SLICE_COUNT layers of `size` rays; each pass draws SLICES of them."""

    def __init__(self, context: Context, size: tuple[int, int]) -> None:
        self._gl, self.size = context.gl, size
        self.texture = self._gl.texture3d((*size, SLICE_COUNT), 4, dtype="f4")
        self.texture.filter = moderngl.LINEAR, moderngl.LINEAR
        self.texture.repeat_x = self.texture.repeat_y = self.texture.repeat_z = False
        self._carried = [nearest_texture(self._gl, size, "f4") for _ in range(2)]
        # moderngl attaches no layers of a 3D texture: others hold their places
        self._blanks = [nearest_texture(self._gl, size, "f1") for _ in range(SLICES)]
        self._framebuffers = [self._gl.framebuffer([*self._blanks, carried]) for carried in self._carried]
        self._attach = context.function("glFramebufferTextureLayer", *[ctypes.c_int] * 5)

    def march(self, programs: Programs, planned: Program, frame: Frame, ends: list[float],
              uniforms: dict[str, object]) -> None:
        """Fill all slices. `ends` is where each starts, and where the last one ends, in eye-relative units."""
        program = programs.get("display/fullscreen.vert", planned.fragment, dict(planned.switches))
        uniforms = uniforms | {"u_ray": matrix_uniform(frame.ray), "u_ray_origin": matrix_uniform(frame.ray_origin),
                               "u_carried": UNIT_CARRIED}
        for name, value in uniforms.items():
            set_uniform(program, name, value)
        for binding, name in enumerate(("Lights", "Shadows")):
            if name in program:
                program[name].binding = binding
        self._gl.enable_only(moderngl.NOTHING)
        for k, first in enumerate(range(0, SLICE_COUNT, SLICES)):
            self._framebuffers[k % 2].use()
            for slice_ in range(SLICES):
                self._attach(_FRAMEBUFFER, _COLOR_ATTACHMENT + slice_, self.texture.glo, 0, first + slice_)
            self._carried[1 - k % 2].use(UNIT_CARRIED)
            set_uniform(program, "u_is_first", k == 0)
            set_uniform(program, "u_ends", np.float32(ends[first:first + SLICES + 1]).tobytes())
            fullscreen(self._gl, program).render(vertices=3)

    def release(self) -> None:
        for thing in (*self._framebuffers, *self._blanks, *self._carried, self.texture):
            thing.release()
