"""The passes that shade a wavefront of photons."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace

import moderngl
import numpy as np

from ...gpu.context import Context
from ...gpu.fullscreen import fullscreen
from ...gpu.programs import Programs
from ..plan import TracePlan
from .passes import Passes
from .wavefront import Sums, Wavefront


class PhotonPasses(Passes):
    """As `Passes`, with the programs `plan.photons`. Paths begin at lights, and their shadow rays go to the camera."""

    def __init__(self, context: Context, programs: Programs, plan: TracePlan, use_textures: Callable[[], None],
                 set_uniforms: Callable[[moderngl.Program], None], uniforms: Mapping[str, object]) -> None:
        super().__init__(context, programs, replace(plan, programs=plan.photons), use_textures, set_uniforms, uniforms)

    def begin(self, wavefront: Wavefront, blocks: np.ndarray) -> None:
        """Begin the first photons of blocks that have new work."""
        self._gl.enable_only(moderngl.NOTHING)
        self._use_textures()
        wavefront.bind_blocks()
        wavefront.present.use()
        wavefront.draw_blocks(self._program("begin", u_grid=wavefront.grid), blocks)

    def shade_onto(self, wavefront: Wavefront, splats: Sums, arriving: Sums | None) -> None:
        """Add what the camera sees of the wavefront's vertices to `splats`, and compute the next state. In the one
        pixel of `arriving` add up what photons bring to the eye on their way (trace/weigh.vert)."""
        self._bind_wavefront(wavefront)
        self._add_points("splat", wavefront, splats)
        if arriving is not None:
            self._add_points("weigh", wavefront, arriving)
        self._classify(wavefront, "classify")
        self._advance(wavefront)

    def _add_points(self, name: str, wavefront: Wavefront, target: Sums) -> None:
        """Draw a point for each path, by blending."""
        target.framebuffer.use()
        self._gl.enable_only(moderngl.BLEND)
        self._gl.blend_func = moderngl.ONE, moderngl.ONE
        points = fullscreen(self._gl, self._program(name))
        points.render(moderngl.POINTS, vertices=wavefront.size[0] * wavefront.size[1])
