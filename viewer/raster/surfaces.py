"""The passes that draw meshes: opaque and masked surfaces, and blended ones, sorted from back to front."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace

import moderngl

from ..gpu.context import Context
from ..gpu.programs import Programs, matrix_uniform, set_uniform
from ..plan.model import Draw, Plan
from ..scene.decoding import Decoder
from ..scene.frame import Frame
from ..scene.material import VOLUME
from ..scene.mesh import Mesh
from ..scene.scene import Scene
from ..scene.transform import handedness, normal_matrix
from .baked_attributes import BakedAttributes
from .geometry import MeshBuffers
from .material_uniforms import MaterialUniforms
from .surface_programs import TRIANGLES, gathering_program, gbuffer_program, path_program, vertex_of
from .textures import Textures
from .walls import SIDES, Side, Wall

OfDraw = Callable[[Draw, MeshBuffers], Mapping[str, object]]
"""Further uniforms of a draw."""
Show = Callable[[Draw, MeshBuffers, moderngl.Program], object]
"""Draws in the place of a mesh."""

_SAMPLE_ALPHA_TO_COVERAGE, _SAMPLE_ALPHA_TO_ONE = 0x809E, 0x809F


class Surfaces:
    """The meshes and textures of a scene on the GPU, and the passes that draw them.

    Buffers belong to a mesh and textures to an image, by identity. If the next scene has the same meshes or images,
    their buffers and textures are kept.
    """

    def __init__(self, context: Context, programs: Programs) -> None:
        self._context, self._gl, self._programs = context, context.gl, programs
        self.scene = Scene("nothing")
        self._meshes: dict[Mesh, MeshBuffers] = {}
        self._generation = programs.generation
        self.textures = Textures(context)
        self.materials = MaterialUniforms(context.gl, self.textures)
        self.baked = BakedAttributes(context.gl, self._drop_arrays)

    def take(self, scene: Scene, ahead: Decoder | None = None) -> None:
        """Make `scene` the current scene, and release what it does not share with the one before.

        Of meshes that have only moved, as those of another pose, what has moved is uploaded. `ahead` is a decoder that
        has already started with some of its images.
        """
        before, self.scene = self.scene, scene
        self._take_meshes(before, scene)
        self.baked.forget_light()
        if ahead is not None or scene.materials is not before.materials:
            self.textures.keep(set(scene.images), ahead)

    def _take_meshes(self, before: Scene, scene: Scene) -> None:
        kept = set(scene.meshes)
        for old, new in zip(before.meshes, scene.meshes):
            if old in self._meshes and old not in kept and new not in self._meshes and old.layout == new.layout:
                self._meshes[new] = self._meshes.pop(old)
                self._meshes[new].move(new)
        for mesh in self._meshes.keys() - kept:
            self._meshes.pop(mesh).release()

    def prepare(self, plan: Plan) -> None:
        """Compile and upload everything that `plan` draws, so that the first frame takes no longer than others."""
        if self._generation != self._programs.generation:
            self._generation = self._programs.generation
            self._drop_arrays()
        self.materials.clear()
        for program in plan.programs:
            self._program(program.fragment, dict(program.switches))
        for draw in plan.draws:
            self.mesh(draw.mesh)
        self.textures.upload()

    def draw_gbuffer(self, frame: Frame, plan: Plan, frame_uniforms: dict[str, object], has_gaps: bool) -> None:
        """Draw the G-buffer of cloth with gaps, or of the other surfaces that need one: shaders/raster/gbuffer.frag."""
        draws = [replace(d, program=gbuffer_program(d.program), alpha_mode="opaque" if has_gaps else d.alpha_mode)
                 for d in plan.draws if d.is_in_gbuffer and d.has_gaps == has_gaps]
        self._draw_solid(draws, frame, plan, frame_uniforms)

    def draw_refraction_rays(self, frame: Frame, plan: Plan, frame_uniforms: dict[str, object]) -> None:
        """Draw the first rays of the paths through solid glass: shaders/raster/refraction_rays.frag."""
        solids = [draw for draw in plan.draws if draw.traces_refraction]
        rays = [replace(draw, program=path_program(draw.program, plan.has_dispersion)) for draw in solids]
        self._draw_solid(rays, frame, plan, frame_uniforms)

    def draw_gathered(self, frame: Frame, plan: Plan, frame_uniforms: dict[str, object]) -> None:
        """Draw the light that solids scatter inside, before it is spread: shaders/raster/pbr.frag, SUBSURFACE = 2."""
        draws = [replace(d, program=gathering_program(d.program)) for d in plan.draws if d.spreads_subsurface]
        self._draw_solid(draws, frame, plan, frame_uniforms)

    def draw_layers(self, frame: Frame, plan: Plan, frame_uniforms: dict[str, object], of_draw: OfDraw) -> None:
        """Draw what surfaces are, as numbers: shaders/raster/layers.frag. `plan` is one of viewer/plan/layers.py."""
        draws = [replace(draw, alpha_mode="opaque") for draw in plan.draws]
        self._draw_solid(draws, frame, plan, frame_uniforms, of_draw)

    def draw_opaque(self, frame: Frame, plan: Plan, frame_uniforms: dict[str, object]) -> None:
        """Draw the surfaces that neither blend nor transmit light."""
        draws = [d for d in plan.draws if not d.transmits and not d.is_deferred]
        self._draw_solid(draws, frame, plan, frame_uniforms)

    def draw_triangles(self, frame: Frame, plan: Plan, frame_uniforms: dict[str, object], of_draw: OfDraw) -> None:
        """Draw the numbers of the triangles of deferred surfaces: shaders/raster/triangles.frag."""
        draws = [replace(d, program=TRIANGLES, maps=(), blank_maps=()) for d in plan.draws if d.is_deferred]
        self._draw_solid(draws, frame, plan, frame_uniforms, of_draw)

    def draw_deferred(self, frame: Frame, plan: Plan, frame_uniforms: dict[str, object], of_draw: OfDraw,
                      show: Show) -> None:
        """Let `show` draw what shows deferred surfaces, with their programs and materials."""
        self._draw_solid([d for d in plan.draws if d.is_deferred], frame, plan, frame_uniforms, of_draw, show)

    def transmissive(self, kind: int, frame: Frame, plan: Plan) -> list[Draw]:
        """The THIN_WALLED or SOLID surfaces (`kind`) that may be in the picture and do not blend."""
        return self._in_order([d for d in plan.draws if d.transmits == kind], frame, plan)

    def draw_walls(self, walls: list[Wall], frame: Frame, frame_uniforms: dict[str, object]) -> None:
        """Draw transmissive surfaces, or one side of them. `frame_uniforms` refer to the picture behind them."""
        self._gl.enable_only(moderngl.DEPTH_TEST | moderngl.PROGRAM_POINT_SIZE)
        for side in SIDES:
            self._draw([wall.draw for wall in walls if wall.side == side], frame, frame_uniforms, side=side)

    def _draw_solid(self, draws: list[Draw], frame: Frame, plan: Plan, frame_uniforms: dict[str, object],
                    of_draw: OfDraw | None = None, show: Show | None = None) -> None:
        self._gl.enable_only(moderngl.DEPTH_TEST | moderngl.PROGRAM_POINT_SIZE)
        self._draw(self._in_order(draws, frame, plan), frame, frame_uniforms, of_draw=of_draw, show=show)

    def _in_order(self, draws: list[Draw], frame: Frame, plan: Plan) -> list[Draw]:
        """Those of `draws` that are seen and do not blend, with few changes of programs and materials."""
        draws = [d for d in draws if d.alpha_mode != "blend" and (plan.is_everything or _is_visible(d, frame))]
        order = {program: k for k, program in enumerate(dict.fromkeys(d.program for d in draws))}
        return sorted(draws, key=lambda d: (order[d.program], d.material))

    def draw_blended(self, frame: Frame, plan: Plan, frame_uniforms: dict[str, object]) -> None:
        """Draw the blended surfaces, farthest first.

        The order of instances at the same depth depends only on their position, mesh and material.
        """
        draws = self._back_to_front(plan, frame)
        self._gl.enable_only(moderngl.DEPTH_TEST | moderngl.BLEND | moderngl.PROGRAM_POINT_SIZE)
        self._gl.blend_func = moderngl.ONE, moderngl.ONE_MINUS_SRC_ALPHA
        self._draw(draws, frame, frame_uniforms, is_sorted=True)

    def draw_counted(self, frame: Frame, plan: Plan, frame_uniforms: dict[str, object]) -> None:
        """Draw all surfaces in the order of `plan`, those that blend from back to front, and add what they write."""
        solid = [d for d in plan.draws if d.alpha_mode != "blend" and _is_visible(d, frame)]
        self._gl.enable_only(moderngl.DEPTH_TEST | moderngl.BLEND | moderngl.PROGRAM_POINT_SIZE)
        self._draw(solid, frame, frame_uniforms)
        self._draw(self._back_to_front(plan, frame), frame, frame_uniforms, is_sorted=True)

    def _back_to_front(self, plan: Plan, frame: Frame) -> list[Draw]:
        """The draws that blend, farthest first."""
        draws = [d for d in plan.draws if d.alpha_mode == "blend" and (plan.is_everything or _is_visible(d, frame))]
        forward, centers = frame.camera.forward, self.scene.corners.mean(axis=1)
        transforms = [instance.transform.ravel() for instance in self.scene.instances]
        draws.sort(key=lambda d: (-round(float(centers[d.instance] @ forward) / frame.unit, 6),
                                  *centers[d.instance], *transforms[d.instance], d.mesh, d.material))
        return draws

    def _draw(
        self, draws: list[Draw], frame: Frame, frame_uniforms: dict[str, object], is_sorted: bool = False,
        of_draw: OfDraw | None = None, show: Show | None = None, side: Side = "all",
    ) -> None:
        bound: tuple[object, ...] = (None,)
        scene, gl = self.scene, self._gl
        for draw in draws:
            material = draw.surface
            if bound[0] is not draw.program:
                program = self._program(draw.program.fragment, dict(draw.program.switches))
                for name, value in frame_uniforms.items():
                    set_uniform(program, name, value)
                bind_blocks(program)
            wanted = (draw.program, draw.material, draw.maps, draw.blank_maps)  # a mesh may lack a map's coordinates
            if bound != wanted:
                self.materials.set(program, draw, scene.radius)
            bound = wanted
            mesh = self.mesh(draw.mesh)
            if material.double_sided and "u_light_inside" in program:
                self.materials.set_light_inside(program, draw, scene.meshes[draw.mesh])
            for name, value in of_draw(draw, mesh).items() if of_draw is not None else ():
                set_uniform(program, name, value)
            gl.cull_face = "front" if side == "back" else "back"
            cull = (not material.double_sided or side != "all") and scene.meshes[draw.mesh].topology == "triangles"
            (gl.enable if cull else gl.disable)(moderngl.CULL_FACE)
            if draw.alpha_mode == "mask":
                gl.enable_direct(_SAMPLE_ALPHA_TO_COVERAGE)
                gl.enable_direct(_SAMPLE_ALPHA_TO_ONE)
            try:
                if draw.instances:
                    self._draw_instances(program, draw, mesh, frame)
                else:
                    self._draw_instance(program, draw, mesh, frame, is_sorted, show)
            finally:
                if draw.alpha_mode == "mask":
                    gl.disable_direct(_SAMPLE_ALPHA_TO_COVERAGE)
                    gl.disable_direct(_SAMPLE_ALPHA_TO_ONE)
        gl.front_face, gl.cull_face = "ccw", "back"

    def _draw_instance(self, program: moderngl.Program, draw: Draw, mesh: MeshBuffers, frame: Frame,
                       is_sorted: bool, show: Show | None) -> None:
        transform = self.scene.instances[draw.instance].transform
        set_uniform(program, "u_model", matrix_uniform(frame.model(transform @ mesh.to_mesh)))
        set_uniform(program, "u_normal_matrix", matrix_uniform(normal_matrix(transform)))
        set_uniform(program, "u_instance", float(draw.instance + 1))
        if VOLUME.is_on(draw.surface):
            set_uniform(program, "u_thickness", draw.surface.thickness * frame.scale(transform))
        self._set_hand(program, handedness(transform))
        if show is not None:
            self._gl.disable(moderngl.CULL_FACE)
            show(draw, mesh, program)
            return
        order = mesh.back_to_front(frame.model(transform), frame.camera.forward) if is_sorted else None
        mesh.draw(program, order, self.baked.of(draw))

    def _draw_instances(self, program: moderngl.Program, draw: Draw, mesh: MeshBuffers, frame: Frame) -> None:
        for part in mesh.instances(self.scene, draw.instances):
            self._set_hand(program, part.hand)
            mesh.draw_instances(program, part, part.show(frame.camera.eye, frame.visible))

    def _set_hand(self, program: moderngl.Program, hand: float) -> None:
        set_uniform(program, "u_handedness", hand)
        self._gl.front_face = "ccw" if hand > 0 else "cw"

    def _program(self, fragment: str, switches: dict[str, int]) -> moderngl.Program:
        return self._programs.get(vertex_of(fragment, switches), fragment, switches)

    def mesh(self, index: int) -> MeshBuffers:
        """The buffers of a mesh of the current scene."""
        mesh = self.scene.meshes[index]
        if mesh not in self._meshes:
            self._meshes[mesh] = MeshBuffers(self._context, mesh)
        return self._meshes[mesh]

    def _drop_arrays(self) -> None:
        """Release the vertex arrays, for other programs, or other buffers of what belongs to an instance."""
        for mesh in self._meshes.values():
            mesh.drop_arrays()

    def release(self) -> None:
        for mesh_buffers in self._meshes.values():
            mesh_buffers.release()
        self.baked.release()
        self.materials.release()
        self.textures.release()


def _is_visible(draw: Draw, frame: Frame) -> bool:
    """Whether it may be in the picture. Of many instances each is asked when they are drawn."""
    return bool(draw.instances) or bool(frame.visible[draw.instance])


def bind_blocks(program: moderngl.Program) -> None:
    """Bind the uniform blocks of lights and of shadow maps."""
    for binding, name in enumerate(("Lights", "Shadows")):
        if name in program:
            program[name].binding = binding
