"""Traces rays through our own BVH in a fragment shader, one pixel for each path of a wavefront."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

import moderngl

from ...errors import ViewerError
from ...gpu.context import Context
from ...gpu.fullscreen import fullscreen
from ...gpu.program import compile_program
from ...gpu.programs import set_uniform
from ...gpu.row_texture import row_texture
from ..defines import shader_defines, surface_defines
from .bvh import CURVES_LEAF, INSTANCE_TEXELS, NODE_TEXELS, TRIANGLE_TEXELS, Bvh, build_bvh
from .bvh4 import LEAF_SHIFT
from .intersect import SHADOW_REACH, Answer, Surfaces, WavefrontTextures

if TYPE_CHECKING:
    from ..scene.geometry import TraceGeometry

_STATE = ("origin", "direction", "shadow_origin", "shadow_vector", "medium")
_BVH_UNIT = len(_STATE)
_VERTEX = "display/fullscreen.vert"


class BvhIntersector:
    """An `Intersector`, see viewer/trace/rays/intersect.py. It reports the rays of the trace before, so as not to wait.

    Raises ViewerError for a scene whose tree no texture holds.
    """

    name = "bvh"
    tells_classes = False

    def __init__(self, context: Context, geometry: TraceGeometry, surfaces: Surfaces | None) -> None:
        self._context, self._gl = context, context.gl
        self._built = bvh = build_bvh(geometry)
        self._media = geometry.nesting if geometry.scatters else None
        if (bvh.has_see_through or geometry.scatters) and surfaces is None:
            raise ValueError("see-through triangles and media need their surfaces")
        self._has_panes = surfaces is not None and any(instance.is_pane for instance in geometry.instances)
        self._has_along = self._media is not None or self._has_panes
        self._surfaces = surfaces if bvh.has_see_through or self._has_along else None
        self._bvh = self._texture(bvh)
        self._defines = self._all_defines(bvh)
        self._program = self._compile()
        self._counter = compile_program(context, vertex=_VERTEX, fragment="trace/count_rays.frag",
                                        defines=shader_defines())
        for unit, name in enumerate(_STATE):
            set_uniform(self._counter, f"u_{name}", unit)
        self._query = context.gl.query(samples=True)
        self._is_counting = False

    def move(self, geometry: TraceGeometry) -> None:
        """Refit the trees. The program is compiled again only if it needs a larger stack, or instances."""
        self._built = build_bvh(geometry, self._built)
        self._media = geometry.nesting if geometry.scatters else None
        self._bvh.release()
        self._bvh = self._texture(self._built)
        defines = self._all_defines(self._built)
        if defines["STACK"] <= self._defines["STACK"]:
            defines["STACK"] = self._defines["STACK"]
        if defines != self._defines:
            fullscreen(self._gl, self._program).release()
            self._program.release()
            self._defines = defines
            self._program = self._compile()

    def _texture(self, bvh: Bvh) -> moderngl.Texture:
        too_many = ViewerError("the scene has too many triangles for a texture of this OpenGL")
        return row_texture(self._gl, bvh.texels, too_many)

    def _all_defines(self, bvh: Bvh) -> dict[str, float]:
        return {
            **(shader_defines() if self._surfaces is None else surface_defines(self._surfaces.switches)),
            "BVH_WIDTH": self._bvh.width,
            "NODE_TEXELS": NODE_TEXELS, "TRIANGLE_TEXELS": TRIANGLE_TEXELS, "BVH_INSTANCE_TEXELS": INSTANCE_TEXELS,
            "LEAF_SHIFT": LEAF_SHIFT,
            "STACK": bvh.stack,
            "HAS_INSTANCES": bvh.has_instances,
            "HAS_SEE_THROUGH": bvh.has_see_through,
            "HAS_CURVES": bvh.has_curves,
            "CURVES_SHIFT": CURVES_LEAF >> LEAF_SHIFT & 7,
            "HAS_SCATTERING": self._media is not None,
            "HAS_PANES": self._has_panes,
            "SHADOW_REACH": SHADOW_REACH,
        }

    def _compile(self) -> moderngl.Program:
        kind = "_transmittance" if self._has_along else "_see_through" * self._built.has_see_through
        fragment = f"trace/intersect{kind}.frag"
        # `precise` belongs to GLSL 4.00; before that it takes an extension, which drivers have in part or not at all.
        program = compile_program(self._context, vertex=_VERTEX, fragment=fragment, defines=self._defines,
                                  version=400 if self._gl.version_code >= 400 else 330)
        for unit, name in enumerate((*_STATE, "bvh")):
            set_uniform(program, f"u_{name}", unit)
        return program

    def fetch(self, wavefront: WavefrontTextures) -> WavefrontTextures:
        return wavefront

    def begin(self, wavefront: WavefrontTextures) -> Callable[[], Answer]:
        answer = self.trace(wavefront)
        return lambda: answer

    def trace(self, wavefront: WavefrontTextures) -> Answer:
        rays = self._query.samples if self._is_counting else None
        for unit, name in enumerate(_STATE[:4 if self._media is None else 5]):
            getattr(wavefront, name).use(unit)
        self._bvh.use(_BVH_UNIT)
        set_uniform(self._program, "u_root", self._built.root)
        set_uniform(self._program, "u_bvh_triangles", self._built.triangles)
        set_uniform(self._program, "u_bvh_instances", self._built.instances)
        set_uniform(self._program, "u_bvh_curves", self._built.curves)
        set_uniform(self._program, "u_bvh_points", self._built.points)
        set_uniform(self._program, "u_sees_backs", wavefront.sees_backs)
        if self._surfaces is not None:
            self._surfaces.bind(self._program)
        if self._media is not None:
            for name, value in self._media.uniforms.items():
                set_uniform(self._program, name, value)
        target = self._gl.framebuffer([wavefront.hit])
        both = target if not self._has_along else self._gl.framebuffer([wavefront.hit, wavefront.along])
        both.use()
        self._gl.enable_only(moderngl.NOTHING)
        fullscreen(self._gl, self._program).render(vertices=3)
        if both is not target:
            both.release()
        target.color_mask = False, False, False, False
        target.use()
        with self._query:
            for shadow in (False, True):
                set_uniform(self._counter, "u_shadow", shadow)
                fullscreen(self._gl, self._counter).render(vertices=3)
        target.release()
        self._is_counting = True
        return Answer(None, rays)

    def store(self, wavefront: WavefrontTextures, answer: Answer) -> None:
        """Nothing to do: `trace` has written the hits."""

    def release(self) -> None:
        for program in (self._program, self._counter):
            fullscreen(self._gl, program).release()
            program.release()
        self._bvh.release()
