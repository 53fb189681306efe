"""The passes that find the light which solids scatter inside, and spread it over their surfaces in screen space."""

from __future__ import annotations

from collections.abc import Callable

import moderngl

from ..base.reusable import Reusable
from ..gpu.context import Context
from ..gpu.fullscreen import fullscreen
from ..gpu.programs import Programs, matrix_uniform, set_uniform
from ..scene.frame import Frame
from .depth import Depth
from .gbuffer import nearest_texture
from .units import UNIT_SUBSURFACE, UNIT_SUBSURFACE_POSITIONS

POINTS, MOVING_POINTS = 48, 18
"""How many points of the disk around each pixel are read: a third of them by the profile of each channel. The second
number is for a moving camera where the CPU renders."""


class SubsurfacePass:
    """Owns the targets of one picture size."""

    def __init__(self, context: Context, programs: Programs, depth: Depth) -> None:
        self._gl, self._programs, self._depth = context.gl, programs, depth
        self._is_software = context.is_software
        self._targets: Reusable[_Targets] = Reusable()

    def find(self, frame: Frame, draw_gathered: Callable[[], object], still: bool) -> dict[str, object]:
        """Draw the light of the solids that `draw_gathered()` draws (shaders/raster/pbr.frag, SUBSURFACE = 2), spread
        it, and return the uniforms of shaders/raster/subsurface.glsl.

        Leaves a framebuffer of its own in use.
        """
        targets = self._targets.get(lambda held: held.size == frame.size,
                                    lambda: _Targets(self._gl, self._depth, frame.size))
        targets.gathering.use()
        targets.gathering.clear(depth=self._depth.far)
        draw_gathered()
        self._gl.clear_samplers()
        points = MOVING_POINTS if self._is_software and not still else POINTS
        program = self._programs.get("display/fullscreen.vert", "raster/spread_subsurface.frag", {"POINTS": points})
        for unit, (name, texture) in enumerate(zip(("u_gathered", "u_positions", "u_profiles"), targets.found)):
            texture.use(unit)
            set_uniform(program, name, unit)
        set_uniform(program, "u_view_projection", matrix_uniform(frame.view_projection))
        pose = frame.camera.pose
        for name, axis in (("u_right", pose[:3, 0]), ("u_up", pose[:3, 1]), ("u_forward", -pose[:3, 2])):
            set_uniform(program, name, tuple(axis))
        targets.spreading.use()
        self._gl.enable_only(moderngl.DEPTH_TEST)
        with self._depth.on_surfaces():
            fullscreen(self._gl, program).render(vertices=3)
        targets.spread.use(UNIT_SUBSURFACE)
        targets.found[1].use(UNIT_SUBSURFACE_POSITIONS)
        return {"u_subsurface": UNIT_SUBSURFACE, "u_subsurface_positions": UNIT_SUBSURFACE_POSITIONS}

    def release(self) -> None:
        self._targets.release()


class _Targets:
    """The light, position and profile of each pixel, and the light when it is spread."""

    def __init__(self, gl: moderngl.Context, depth: Depth, size: tuple[int, int]) -> None:
        self.size = size
        self.found = tuple(nearest_texture(gl, size, "f4") for _ in range(3))
        self.spread = nearest_texture(gl, size, "f4")
        self._buffer = depth.renderbuffer(size)
        self.gathering = gl.framebuffer(self.found, self._buffer)
        self.spreading = gl.framebuffer([self.spread], self._buffer)
        self.spreading.depth_mask = False

    def release(self) -> None:
        for thing in (self.gathering, self.spreading, *self.found, self.spread, self._buffer):
            thing.release()
