"""The passes that shade a wavefront, and their programs with textures and uniforms."""

from __future__ import annotations

from collections.abc import Callable, Mapping

import moderngl
import numpy as np

from ...gpu.context import Context
from ...gpu.fullscreen import fullscreen
from ...gpu.programs import Programs, set_uniform
from ..defines import shader_defines
from ..kinds import FIBRE, KINDS
from ..layout import (
    CLASS_AIRLIGHT,
    CLASS_ENDED,
    CLASS_FIRST_COLLISION,
    CLASS_FIRST_HIT,
    CLASS_IDLE,
    CLASS_MEDIUM,
    CLASS_SHADE,
    NO_KIND,
)
from ..plan import TracePlan
from ..rays.intersect import CLASS_OF_IDLE, Answer
from .sky import Sky
from .wavefront import UNITS, Wavefront

_CLASSES = {"idle": CLASS_IDLE, "finish": CLASS_ENDED, "generate": CLASS_ENDED, "layers": CLASS_FIRST_HIT,
            "fibre layers": CLASS_SHADE + FIBRE.number, "medium layers": CLASS_FIRST_COLLISION,
            "medium": CLASS_MEDIUM, "airlight": CLASS_AIRLIGHT,
            **{kind.name: CLASS_SHADE + kind.number for kind in KINDS}}
"""The class of the paths that a pass shades."""
_SORTED_CLASSES = {"finish": NO_KIND, "generate": NO_KIND, **{kind.name: kind.number for kind in KINDS},
                   "idle": CLASS_OF_IDLE}
"""The same by `viewer.trace.rays.intersect.Answer.classes`, outside of media."""
_OVER_BLOCKS = ("begin", "zero", "begin sums")


def vertex_shader(name: str, is_sorted: bool) -> str:
    """The vertex shader of the pass `name`, of a wavefront that is sorted or not."""
    if name in ("splat", "weigh"):
        return f"trace/{name}.vert"
    if name in ("alive", "track", "sky"):
        return "display/fullscreen.vert"
    if name == "begin" and is_sorted:
        return "display/fullscreen.vert"
    return "trace/blocks.vert" if name in _OVER_BLOCKS else "trace/path_class.vert"


class Passes:
    """`use_textures` binds the textures of the scene to their units, and `set_uniforms` sets its uniforms in a program.

    `uniforms` are those of the picture. None of them changes, so that a program keeps them from pass to pass.
    """

    def __init__(self, context: Context, programs: Programs, plan: TracePlan, use_textures: Callable[[], None],
                 set_uniforms: Callable[[moderngl.Program], None], uniforms: Mapping[str, object]) -> None:
        self.context = context
        self._gl = context.gl
        self._use_textures, self._set_uniforms = use_textures, set_uniforms
        self._claim, self._key = programs.claim, object()
        self._uniforms = {**uniforms, **UNITS}
        self._layers = tuple(name for name in ("layers", "fibre layers", "medium layers") if name in plan.programs)
        self._shading = (*plan.surfaces, *plan.media)
        self._knows_classes = plan.knows_classes
        self._programs = {}
        for name, program in plan.programs.items():
            self._programs[name] = programs.get(vertex_shader(name, plan.is_sorted), program.fragment,
                                                shader_defines(dict(program.switches)))

    def draw_sky(self, sky: Sky) -> None:
        """Resolve the pixels that no geometry can touch."""
        self._use_textures()
        sky.framebuffer.use()
        self._gl.enable_only(moderngl.NOTHING)
        sky.mask.use(0)
        self._draw("sky", u_covered=0, u_points=sky.points)

    def begin(self, wavefront: Wavefront, blocks: np.ndarray) -> None:
        """Begin the first paths of blocks that have new work, and their sums, which are 0 where paths begin."""
        self._gl.enable_only(moderngl.NOTHING)
        self._use_textures()
        wavefront.bind_blocks()
        first = "begin sums" if "begin sums" in self._programs else "zero"
        for name, sums in ((first, wavefront.sums), ("zero", wavefront.layers)):
            if sums is not None:
                sums.framebuffer.use()
                wavefront.draw_blocks(self._program(name, u_grid=wavefront.grid), blocks)
        wavefront.present.use()
        if wavefront.arrangement is None:
            wavefront.draw_blocks(self._program("begin", u_grid=wavefront.grid), blocks)
        else:
            wavefront.arrangement.bind()
            row, rows = wavefront.begun_rows
            wavefront.present.scissor = 0, row, wavefront.size[0], rows
            wavefront.present.use()
            self._draw("begin")

    def shade(self, wavefront: Wavefront, answer: Answer) -> None:
        """Compute the next state of the wavefront from its hits.

        No pass reads what another pass has drawn, except the depth, so that a driver need not wait between them.
        """
        gl = self._gl
        self._bind_wavefront(wavefront)
        gl.blend_func = moderngl.ONE, moderngl.ONE
        if wavefront.layers is not None:
            wavefront.classes.scissor = 0, 0, *wavefront.size  # of all homes
            self._classify(wavefront, "classify first hits")
            wavefront.layers.framebuffer.use()
            gl.enable_only(moderngl.DEPTH_TEST | moderngl.BLEND)
            for name in self._layers:
                self._draw(name)
            gl.depth_func = "<"
        if wavefront.arrangement is not None:
            wavefront.sort(answer)
        if self._knows_classes:
            self._shade_in_order(wavefront)
            return
        self._classify(wavefront, "classify")
        finished = wavefront.sums.framebuffer if wavefront.gathered is None else wavefront.gathered.finished
        finished.use()
        gl.enable_only(moderngl.DEPTH_TEST | moderngl.BLEND)
        self._draw("finish")
        self._advance(wavefront)

    def _shade_in_order(self, wavefront: Wavefront) -> None:
        """As `shade`, where the paths of each class are known: a pass draws their texels alone. Without a test of the
        depth it need not read what it draws over, which no cache holds."""
        arrangement, gathered = wavefront.arrangement, wavefront.gathered
        assert arrangement is not None and gathered is not None
        self._gl.enable_only(moderngl.NOTHING)
        for target, names in ((gathered.finished, ("finish",)), (wavefront.next, ("generate", *self._shading, "idle"))):
            target.use()
            for name in names:
                for rectangle in arrangement.rectangles(_SORTED_CLASSES[name]):
                    target.scissor = rectangle
                    self._draw(name)
        wavefront.swap()

    def _bind_wavefront(self, wavefront: Wavefront) -> None:
        """Bind the scene and the present state, and follow its rays through volumes."""
        self._use_textures()
        wavefront.bind()
        if wavefront.tracked is not None:
            wavefront.tracked.use()
            self._gl.enable_only(moderngl.NOTHING)
            self._draw("track")
            wavefront.bind_tracked()

    def _advance(self, wavefront: Wavefront) -> None:
        """Draw the next state, by the classes that the depth holds, and make it the present one."""
        gl = self._gl
        wavefront.next.use()
        gl.enable_only(moderngl.DEPTH_TEST)
        for name in ("generate", *self._shading):
            self._draw(name)
        wavefront.next_origin.use()
        self._draw("idle")
        gl.depth_func = "<"
        wavefront.swap()

    def find_alive(self, wavefront: Wavefront) -> np.ndarray:
        """Whether any path of a block is not idle, or of a sorted wavefront was not when they were sorted last,
        (blocks,) bool. Waits for the device."""
        if wavefront.arrangement is not None:
            return wavefront.arrangement.alive
        wavefront.bind()
        wavefront.alive.use()
        self._gl.enable_only(moderngl.NOTHING)
        self._draw("alive")
        return np.frombuffer(wavefront.alive.read(components=1), np.uint8) > 0

    def _classify(self, wavefront: Wavefront, name: str) -> None:
        wavefront.classes.use()
        self._gl.enable_only(moderngl.DEPTH_TEST)
        self._gl.depth_func = "1"  # always
        self._draw(name)
        self._gl.depth_func = "=="

    def _draw(self, name: str, **uniforms: object) -> None:
        program = self._program(name, u_path_class=_CLASSES.get(name, CLASS_IDLE), **uniforms)
        fullscreen(self._gl, program).render(vertices=3)

    def _program(self, name: str, **uniforms: object) -> moderngl.Program:
        program = self._programs[name]
        if self._claim(program, self._key):
            self._set_uniforms(program)
            uniforms = {**self._uniforms, **uniforms}
        for uniform, value in uniforms.items():
            set_uniform(program, uniform, value)
        return program
