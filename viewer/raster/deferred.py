"""Opaque surfaces of a multisampled target, shaded over the screen and not triangle by triangle.

A pixel in which several triangles meet is shaded for each of them by OpenGL's multisampling. A software rasteriser also
shades every block of pixels that a triangle touches as a whole, so that small triangles cost it many times their area.
Here all triangles are drawn first, with the number of the visible one in each sample. Then one or two surfaces are
chosen in each pixel (shaders/raster/choose.frag), and what each object shows is shaded at once
(shaders/raster/deferred.glsl). `Target.resolve` lays it behind what other passes draw into the samples.

Burns and Hunt 2013, "The Visibility Buffer: A Cache-Friendly Approach to Deferred Shading".
"""

from __future__ import annotations

import ctypes
from collections.abc import Callable, Mapping

import moderngl

from ..base.reusable import Reusable
from ..gpu.context import Context
from ..gpu.fullscreen import fullscreen
from ..gpu.programs import Programs, matrix_uniform, set_uniform
from ..plan.deferral import TRIANGLE_BITS
from ..plan.model import Draw, Plan
from ..scene.frame import Frame
from .depth import Depth
from .gbuffer import nearest_texture
from .geometry import MeshBuffers
from .numbered_triangles import NumberedTriangles
from .pixel_boxes import Box, around, pixel_box, pixel_rows, union
from .surface_programs import FULLSCREEN, TRIANGLES
from .surfaces import Surfaces
from .target import Target
from .units import UNIT_CHOSEN, UNIT_GEOMETRY, UNIT_RADIANCE

_OBJECTS = 1 << 20
"""Objects are stored as depths: (number + 1) / _OBJECTS is exact."""
_NOTHING = 0.5
"""The depth where no surface is the second one: neither an object's nor the background's."""
_ALL_SAMPLES = 0xF << 28
"""Of a pixel's first surface, where this is the background (shaders/raster/chosen.glsl)."""
_COLOR, _DEPTH = 0x1800, 0x1801  # of glClearBuffer
_SRC1_COLOR = 0x88F9


class DeferredSurfaces:
    """The pass that draws the surfaces that `Draw.is_deferred` names."""

    def __init__(self, context: Context, programs: Programs, depth: Depth, surfaces: Surfaces) -> None:
        self._context, self._programs, self._depth, self._surfaces = context, programs, depth, surfaces
        self._layers: Reusable[Layers] = Reusable()
        self._triangles: Reusable[NumberedTriangles] = Reusable()

    def draw(self, frame: Frame, plan: Plan, target: Target, uniforms: dict[str, object],
             draw_behind: Callable[[], None]) -> Layers:
        """Clear `target` where something is drawn, draw them into its depth, within `Depth.test()`, and return their
        radiance in pixels. With `Plan.is_over_layers` what lies behind all surfaces belongs to the layers:
        `draw_behind` draws it into the framebuffer in use."""
        draws = [draw for draw in plan.draws if draw.is_deferred]
        layers = self._layers.get(lambda held: held.target is target,
                                  lambda: Layers(self._context, self._depth, target))
        layers.has_behind = plan.is_over_layers and plan.has_behind
        triangles = self._triangles.get(lambda held: held.fits(frame.scene, draws),
                                        lambda: NumberedTriangles(self._context, frame.scene, draws))
        part = target.part or (0, 0, *frame.size)
        boxes = {draw.instance: pixel_box(frame, draw.instance, part) for draw in draws if frame.visible[draw.instance]}
        others = [instance for draw in plan.draws if not draw.is_deferred
                  for instance in draw.instances or (draw.instance,) if frame.visible[instance]]
        over = union([pixel_box(frame, instance, part) for instance in others]) if plan.is_over_layers else part
        box = union(list(boxes.values()))
        layers.clear(self._programs, union([box, over]), pixel_rows(frame, triangles.corners, box), over)
        self._surfaces.draw_triangles(
            frame, plan, uniforms, lambda draw, mesh: {"u_first_triangle": triangles.first[draw.instance]})
        self._choose(frame, layers, triangles)
        for number in range(2):
            self._shade(number, frame, plan, layers, triangles, boxes, uniforms)
            if layers.has_behind:
                layers.shaded[number].scissor = layers.box if number else target.part
                draw_behind()
        self._context.gl.clear_samplers()
        return layers

    def _choose(self, frame: Frame, layers: Layers, triangles: NumberedTriangles) -> None:
        gl, camera = self._context.gl, frame.camera
        across = 0.0 if camera.height is None else camera.height / frame.unit / frame.size[1]
        origin = frame.ray_origin.copy()
        origin[:, 2] -= frame.position(frame.scene.center)  # planes are about the centre
        values = {"u_triangle_samples": UNIT_RADIANCE, "u_chosen": UNIT_CHOSEN,
                  "u_ray": matrix_uniform(frame.ray), "u_ray_origin": matrix_uniform(origin),
                  "u_pixel": (across, frame.pixel_angle)}
        layers.numbers.color_attachments[0].use(UNIT_RADIANCE)
        gl.enable_only(moderngl.DEPTH_TEST)
        switches = {"TRIANGLE_BITS": TRIANGLE_BITS, "OBJECTS": float(_OBJECTS), "FAR": self._depth.far,
                    "SAMPLES": layers.samples}
        with self._depth.all():
            for fragment, defines, framebuffer, nothing in (
                    ("raster/choose.frag", switches | {"BACKGROUND": int(layers.has_behind)},
                     layers.choosing, self._depth.far),
                    ("raster/choose_second.frag", switches | {"NOTHING": _NOTHING}, layers.second, _NOTHING)):
                program = self._programs.get(FULLSCREEN, fragment, defines)
                layers.use_cleared(framebuffer, nothing)
                for name, value in values.items():
                    set_uniform(program, name, value)
                triangles.planes.bind(program, "u_planes", UNIT_GEOMETRY)
                layers.draw_rows(framebuffer, program)
                layers.choosing.color_attachments[0].use(UNIT_CHOSEN)

    def _shade(self, number: int, frame: Frame, plan: Plan, layers: Layers, triangles: NumberedTriangles,
               boxes: Mapping[int, Box], uniforms: dict[str, object]) -> None:
        """Shade the first (`number` 0) or the second surface of each pixel."""
        framebuffer = layers.shaded[number]
        values = uniforms | {
            "u_layer": number, "u_chosen": UNIT_CHOSEN,
            "u_pixel_ray": matrix_uniform(frame.ray @ frame.to_ndc),
            "u_pixel_origin": matrix_uniform(frame.ray_origin @ frame.to_ndc)}

        def of_draw(draw: Draw, mesh: MeshBuffers) -> dict[str, object]:
            return {"u_first_triangle": triangles.first[draw.instance],
                    "u_triangles": frame.scene.meshes[draw.mesh].triangle_count}

        def show(draw: Draw, mesh: MeshBuffers, program: moderngl.Program) -> None:
            mesh.triangles_and_vertices.bind(program, "u_geometry", UNIT_GEOMETRY)
            framebuffer.scissor = boxes[draw.instance]
            with self._depth.only_at((triangles.objects[draw.instance] + 1) / _OBJECTS):
                fullscreen(self._context.gl, program).render(vertices=3)

        framebuffer.use()
        self._surfaces.draw_deferred(frame, plan, values, of_draw, show)

    def release(self) -> None:
        self._layers.release()
        self._triangles.release()


class Layers:
    """The triangles of the samples of a target, the surfaces chosen in its pixels, and the radiance of these.

    The first surfaces are shaded in their place in the picture, and only pixels with a second one, or where something
    may be drawn over them, are resolved.
    """

    def __init__(self, context: Context, depth: Depth, target: Target) -> None:
        self._gl, self._depth, self.target = context.gl, depth, target
        self.samples = target.samples
        self._clear_integers, self._clear_floats = (
            context.function(f"glClearBuffer{kind}", ctypes.c_int, ctypes.c_int, ctypes.c_void_p)
            for kind in ("uiv", "fv"))
        gl, size, dtype = context.gl, target.drawn_size, "f2" if target.half else "f4"
        self.numbers = gl.framebuffer([gl.texture(size, 1, samples=target.samples, dtype="u4")], target.depth)
        chosen = gl.texture(size, 2, dtype="u4")
        chosen.filter = moderngl.NEAREST, moderngl.NEAREST
        self._depths = depth.renderbuffer(size), depth.renderbuffer(size)
        self.choosing = gl.framebuffer([chosen], self._depths[0])
        self.second = gl.framebuffer((), self._depths[1])
        self.shaded = [gl.framebuffer([target.radiance], self._depths[0]),
                       gl.framebuffer([nearest_texture(gl, size, dtype)], self._depths[1])]
        self._mixed = gl.framebuffer([target.radiance], self._depths[1])
        for framebuffer in (*self.shaded, self._mixed):
            framebuffer.depth_mask = False
        self.box = 0, 0, 0, 0
        """The rectangle of pixels (x, y, width, height) outside of which there are no samples."""
        self.rows: list[Box] = []
        """Rectangles in it, outside of which there are no deferred surfaces."""
        self.over = 0, 0, 0, 0
        """The one in it outside of which nothing is drawn over them."""
        self.has_behind = False
        """Whether what lies behind all surfaces is the first or the second surface of pixels."""

    def clear(self, programs: Programs, box: Box, rows: list[Box], over: Box) -> None:
        """Clear the samples and the target, for a frame of this `box`, `rows` and `over`, and leave `numbers` in use.
        Mesa's software rasteriser fills a tile of pixels with all that is drawn into a framebuffer while it is in use.
        """
        self.box, self.rows, self.over = box, rows, over
        if not self.has_behind:
            self.target.resolved.use()
            self.target.resolved.clear()
        if over[2]:
            self.target.framebuffer.scissor = over
            self.target.framebuffer.use()
            self._clear_floats(_COLOR, 0, (ctypes.c_float * 4)())
        # With a scissor, OpenGL in software draws a rectangle for each buffer; here one triangle, 0, clears both.
        program = programs.get(FULLSCREEN, TRIANGLES.fragment, {})
        set_uniform(program, "u_first_triangle", 0)
        self.numbers.use()
        self._gl.enable_only(moderngl.DEPTH_TEST)
        with self._depth.as_far():
            self._draw_in([box] if over[2] else rows, self.numbers, program)
        self.numbers.scissor = box

    def use_cleared(self, framebuffer: moderngl.Framebuffer, depth: float) -> None:
        """Use `choosing` or `second`, cleared to this depth."""
        framebuffer.scissor = self.target.part
        framebuffer.use()
        if framebuffer is self.choosing and self.over[2]:
            self._clear_integers(_COLOR, 0, (ctypes.c_uint32 * 4)(_ALL_SAMPLES if self.has_behind else 0))
        self._clear_floats(_DEPTH, 0, (ctypes.c_float * 1)(depth))

    def draw_rows(self, framebuffer: moderngl.Framebuffer, program: moderngl.Program) -> None:
        """Draw full-screen triangles in the rows of `framebuffer`, which is in use."""
        self._draw_in(self.rows, framebuffer, program)

    def _draw_in(self, parts: list[Box], framebuffer: moderngl.Framebuffer, program: moderngl.Program) -> None:
        triangle = fullscreen(self._gl, program)
        for part in parts:
            framebuffer.scissor = part
            triangle.render(vertices=3)

    def resolve(self, programs: Programs, unit: int) -> None:
        """As `Behind.resolve`."""
        with self._depth.test(), self._depth.except_at(_NOTHING):
            self._mix(programs, unit, self._mixed, moderngl.DEPTH_TEST)

    def mix(self, programs: Programs, unit: int, framebuffer: moderngl.Framebuffer) -> None:
        """As `Behind.mix`."""
        self._mix(programs, unit, framebuffer, moderngl.NOTHING)

    def _mix(self, programs: Programs, unit: int, framebuffer: moderngl.Framebuffer, test: int) -> None:
        """Add the second surfaces, and what was drawn over both, to the first ones, which `framebuffer` has. With a
        depth test, pixels without a second surface are left out where nothing is drawn over them."""
        self._gl.blend_func = moderngl.ONE, _SRC1_COLOR
        for is_over, parts in ((1, [self.over] if self.over[2] else []), (0, around(self.over, self.box))):
            program = programs.get(FULLSCREEN, "raster/resolve_second.frag", {"SAMPLES": self.samples, "OVER": is_over})
            self._gl.enable_only(moderngl.BLEND | (0 if is_over else test))
            for part in parts:
                self._resolve(program, unit, framebuffer, part)
        # OpenGL draws nothing into several textures while a second source is set, and Mesa not even unblended.
        self._gl.blend_func = moderngl.ONE, moderngl.ZERO

    def _resolve(self, program: moderngl.Program, unit: int, framebuffer: moderngl.Framebuffer,
                 box: Box | None) -> None:
        framebuffer.scissor = box
        framebuffer.use()
        set_uniform(program, "u_samples", unit)
        for place, (name, source) in enumerate((("u_chosen", self.choosing), ("u_second", self.shaded[1]))):
            source.color_attachments[0].use(place)
            set_uniform(program, name, place)
        fullscreen(self._gl, program).render(vertices=3)

    def release(self) -> None:
        self._gl.screen.use()
        owners = self.numbers, self.choosing, self.shaded[1]
        colors = [color for owner in owners for color in owner.color_attachments]
        for thing in (*owners, self.second, self.shaded[0], self._mixed, *colors, *self._depths):
            thing.release()
