"""The passes that draw meshes: opaque and masked surfaces, and blended ones, sorted from back to front."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace
from typing import TYPE_CHECKING

import moderngl
import numpy as np

from ..gpu.context import Context
from ..gpu.programs import Programs, matrix_uniform, set_uniform
from ..material.pack import uniforms
from ..material.weave import WeaveBinding
from ..plan.model import Draw, Plan
from ..scene.decoding import Decoder
from ..scene.frame import Frame
from ..scene.material import VOLUME, Material, UVTransform
from ..scene.mesh import Mesh
from ..scene.scene import Scene
from ..scene.schema import MAPS, Value
from ..scene.transform import handedness, normal_matrix
from .geometry import MeshBuffers
from .instances import InstanceBuffers
from .subsurface_uniforms import interior_uniforms
from .surface_programs import (
    SHADOW_VERTEX,
    TRIANGLES,
    gathering_program,
    gbuffer_program,
    path_program,
    shadow_maps_of,
    shadow_program,
    vertex_of,
)
from .textures import Textures

if TYPE_CHECKING:
    from ..trace.vertex_light import VertexLight

# Texture units. The maps that a program samples have the first ones. The units from 16 on are for textures that all
# programs share. A program has at most 16 samplers, but may use any of the 48 units that OpenGL 3.3 guarantees.
(UNIT_DFG, UNIT_PREFILTERED, UNIT_IRRADIANCE, UNIT_SHADOW, UNIT_BACKGROUND, UNIT_RADIANCE, UNIT_VISIBILITY,
 UNIT_REFLECTED, UNIT_RAY_POSITIONS, UNIT_REFRACTED, UNIT_MIRRORED, UNIT_PATH_POSITIONS, UNIT_MEDIA,
 UNIT_MEDIA_LIGHT, UNIT_VOLUME_DEPTH) = range(16, 31)
(UNIT_SUBSURFACE, UNIT_SUBSURFACE_POSITIONS, UNIT_WEAVE, UNIT_CHOSEN,
 UNIT_GEOMETRY) = range(32, 37)  # moderngl makes textures with the last of 32
# Of the passes of media, which have no maps
UNIT_DENSITIES, UNIT_SKY_IN_FOG, UNIT_SKY_IN_VOLUMES, UNIT_SKY_SHADOWS = range(4)

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
        self._is_software = context.is_software
        self.scene = Scene("nothing")
        self._meshes: dict[Mesh, MeshBuffers] = {}
        self._indirect: list[moderngl.Buffer] = []
        self._interiors: dict[int, moderngl.Buffer] = {}
        self._behind: dict[int, moderngl.Buffer] = {}
        self._casters: np.ndarray | None = None
        self._uniforms: dict[int, tuple[Material, list[tuple[str, Value]]]] = {}
        self._generation = programs.generation
        self.textures = Textures(context)
        self._weave = WeaveBinding(context.gl)

    def take(self, scene: Scene, ahead: Decoder | None = None) -> None:
        """Make `scene` the current scene, and release what it does not share with the one before.

        Of meshes that have only moved, as those of another pose, what has moved is uploaded. `ahead` is a decoder that
        has already started with some of its images.
        """
        before, self.scene, self._casters = self.scene, scene, None
        self._take_meshes(before, scene)
        if self._indirect:
            self._drop_arrays()
            self._release_indirect()
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
        self._uniforms.clear()
        for program in plan.programs:
            self._program(program.fragment, dict(program.switches))
        for draw in plan.draws:
            self._mesh(draw.mesh)
        self.textures.upload()

    @property
    def has_indirect(self) -> bool:
        """Whether the vertices have indirect light."""
        return bool(self._indirect)

    def light_vertices(self, light: VertexLight, behind: Mapping[int, np.ndarray]) -> None:
        """Upload the indirect light of all vertices, and that behind the vertices of solids that scatter light."""
        if not self._indirect:
            self._indirect = [self._gl.buffer(reserve=max(values.nbytes, 16)) for values in light.per_instance]
        for buffer, values in zip(self._indirect, light.per_instance, strict=True):
            buffer.write(np.ascontiguousarray(values))
        for number, values in behind.items():
            if number not in self._behind:
                self._behind[number] = self._gl.buffer(reserve=max(values.nbytes, 16))
            self._behind[number].write(np.ascontiguousarray(values))

    def set_interiors(self, thickness: Mapping[int, np.ndarray]) -> None:
        """Upload the thickness and roundness behind the vertices of instances, (V, 2) float32 each.

        They take the place of those before.
        """
        self._drop_arrays()
        for buffer in self._interiors.values():
            buffer.release()
        self._interiors = {number: self._gl.buffer(np.ascontiguousarray(values))
                           for number, values in thickness.items()}

    def draw_gbuffer(self, frame: Frame, plan: Plan, frame_uniforms: dict[str, object]) -> None:
        """Draw the G-buffer of the surfaces that need one: shaders/raster/gbuffer.frag."""
        draws = [replace(d, program=gbuffer_program(d.program)) for d in plan.draws if d.is_in_gbuffer]
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

    def draw_opaque(self, frame: Frame, plan: Plan, frame_uniforms: dict[str, object]) -> int:
        """Draw the surfaces that neither blend nor transmit light. Returns how many instances were drawn."""
        draws = [d for d in plan.draws if not d.transmits and not d.is_deferred]
        return self._draw_solid(draws, frame, plan, frame_uniforms)

    def draw_triangles(self, frame: Frame, plan: Plan, frame_uniforms: dict[str, object], of_draw: OfDraw) -> None:
        """Draw the numbers of the triangles of deferred surfaces: shaders/raster/triangles.frag."""
        draws = [replace(d, program=TRIANGLES, maps=(), blank_maps=()) for d in plan.draws if d.is_deferred]
        self._draw_solid(draws, frame, plan, frame_uniforms, of_draw)

    def draw_deferred(self, frame: Frame, plan: Plan, frame_uniforms: dict[str, object], of_draw: OfDraw,
                      show: Show) -> None:
        """Let `show` draw what shows deferred surfaces, with their programs and materials."""
        self._draw_solid([d for d in plan.draws if d.is_deferred], frame, plan, frame_uniforms, of_draw, show)

    def draw_transmissive(self, kind: int, frame: Frame, plan: Plan, frame_uniforms: dict[str, object]) -> int:
        """Draw the THIN_WALLED or SOLID surfaces (`kind`) that do not blend. Returns how many instances were drawn.

        `frame_uniforms` refer to the picture behind them.
        """
        return self._draw_solid([d for d in plan.draws if d.transmits == kind], frame, plan, frame_uniforms)

    def _draw_solid(self, draws: list[Draw], frame: Frame, plan: Plan, frame_uniforms: dict[str, object],
                    of_draw: OfDraw | None = None, show: Show | None = None) -> int:
        draws = [d for d in draws if d.alpha_mode != "blend" and (plan.is_everything or _is_visible(d, frame))]
        order = {program: k for k, program in enumerate(dict.fromkeys(d.program for d in draws))}
        draws.sort(key=lambda d: (order[d.program], d.material))
        self._gl.enable_only(moderngl.DEPTH_TEST | moderngl.PROGRAM_POINT_SIZE)
        self._draw(draws, frame, frame_uniforms, of_draw=of_draw, show=show)
        return len(draws)

    def draw_blended(self, frame: Frame, plan: Plan, frame_uniforms: dict[str, object]) -> int:
        """Draw the blended surfaces, farthest first. Returns how many instances were drawn.

        The order of instances at the same depth depends only on their position, mesh and material.
        """
        draws = self._back_to_front(plan, frame)
        if not draws:
            return 0
        self._gl.enable_only(moderngl.DEPTH_TEST | moderngl.BLEND | moderngl.PROGRAM_POINT_SIZE)
        self._gl.blend_func = moderngl.ONE, moderngl.ONE_MINUS_SRC_ALPHA
        self._draw(draws, frame, frame_uniforms, is_sorted=True)
        return len(draws)

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

    def prepare_depth(self, draw: Draw, to_unit: np.ndarray) -> Callable[[np.ndarray, np.ndarray], None]:
        """Prepare to draw instances into shadow maps. `to_unit` takes the world to scene units about the scene's
        centre.

        What is returned draws them, until this is called again, by a matrix that takes the world to clip space, and the
        light, which has its place (4,) in scene units, or is as far as its direction (0 last).
        """
        wanted = shadow_program(draw)
        program = self._programs.get(SHADOW_VERTEX, wanted.fragment, dict(wanted.switches))
        mesh, scene = self._mesh(draw.mesh), self.scene
        if maps := shadow_maps_of(draw):
            for name, value in self._uniforms_of(draw.surface):
                set_uniform(program, name, value)
            set_uniform(program, "u_caster", self._caster(draw.instance))
            for name in maps:
                if wanted[f"{name.upper()}_MAP"]:
                    self._bind_map(program, draw, name)
        if draw.instances:
            parts = [(part, part.show(scene.center)) for part in mesh.instances(scene, draw.instances)]
            from_unit = np.linalg.inv(to_unit)

            def draw_parts(matrix: np.ndarray, light: np.ndarray) -> None:
                set_uniform(program, "u_to_light", matrix_uniform(matrix @ from_unit))
                for part, count in parts:
                    self._draw_part(program, mesh, part, count)

            return draw_parts
        transform = scene.instances[draw.instance].transform
        if draw.is_pane:
            set_uniform(program, "u_model_to_unit", matrix_uniform(to_unit @ transform @ mesh.to_mesh))

        def draw_depth(matrix: np.ndarray, light: np.ndarray) -> None:
            set_uniform(program, "u_model_to_light", matrix_uniform(matrix @ transform @ mesh.to_mesh))
            if draw.is_pane:
                set_uniform(program, "u_light", tuple(light))
            mesh.draw(program)

        return draw_depth

    def _caster(self, instance: int) -> int:
        """The number of a blended instance among all that cast shadows: by where it stands, not by its place in the
        file, since the number decides which texels of the shadow let light through."""
        if self._casters is None:
            scene = self.scene
            keys = np.concatenate([scene.corners.mean(axis=1), [i.transform.ravel() for i in scene.instances]], axis=1)
            self._casters = np.argsort(np.lexsort(keys.T[::-1]))
        return int(self._casters[instance])

    def _draw(
        self, draws: list[Draw], frame: Frame, frame_uniforms: dict[str, object], is_sorted: bool = False,
        of_draw: OfDraw | None = None, show: Show | None = None,
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
                self._set_material(program, draw)
            bound = wanted
            mesh = self._mesh(draw.mesh)
            for name, value in of_draw(draw, mesh).items() if of_draw is not None else ():
                set_uniform(program, name, value)
            cull = not material.double_sided and scene.meshes[draw.mesh].topology == "triangles"
            (gl.enable if cull else gl.disable)(moderngl.CULL_FACE)
            if draw.alpha_mode == "mask":
                gl.enable_direct(_SAMPLE_ALPHA_TO_COVERAGE)
                gl.enable_direct(_SAMPLE_ALPHA_TO_ONE)
            if draw.instances:
                self._draw_instances(program, draw, mesh, frame)
            else:
                self._draw_instance(program, draw, mesh, frame, is_sorted, show)
            if draw.alpha_mode == "mask":
                gl.disable_direct(_SAMPLE_ALPHA_TO_COVERAGE)
                gl.disable_direct(_SAMPLE_ALPHA_TO_ONE)
        gl.front_face = "ccw"

    def _draw_instance(self, program: moderngl.Program, draw: Draw, mesh: MeshBuffers, frame: Frame,
                       is_sorted: bool, show: Show | None = None) -> None:
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
        mesh.draw(program, order, self._of_instance(draw))

    def _draw_instances(self, program: moderngl.Program, draw: Draw, mesh: MeshBuffers, frame: Frame) -> None:
        for part in mesh.instances(self.scene, draw.instances):
            self._set_hand(program, part.hand)
            self._draw_part(program, mesh, part, part.show(frame.camera.eye, frame.visible))

    def _draw_part(self, program: moderngl.Program, mesh: MeshBuffers, part: InstanceBuffers, count: int) -> None:
        if count:
            mesh.draw_instances(program, part, count)
        if self._is_software and part.is_large:  # it would hold the vertices of all parts until the frame ends
            self._gl.finish()

    def _set_hand(self, program: moderngl.Program, hand: float) -> None:
        set_uniform(program, "u_handedness", hand)
        self._gl.front_face = "ccw" if hand > 0 else "cw"

    def _of_instance(self, draw: Draw) -> dict[str, moderngl.Buffer]:
        """The attributes of the draw's program that belong to one instance's vertices."""
        found = {"a_indirect": self._indirect[draw.instance]} if draw.program.get("INDIRECT") else {}
        if draw.has_subsurface:
            found["a_interior"] = self._interiors[draw.instance]
            if draw.program["INDIRECT"]:
                found["a_behind"] = self._behind[draw.instance]
        return found

    def _set_material(self, program: moderngl.Program, draw: Draw) -> None:
        material = draw.surface
        for name, value in self._uniforms_of(material):
            set_uniform(program, name, value)
        if VOLUME.is_on(material):
            set_uniform(program, "u_absorption", tuple(material.extinction * self.scene.radius))
        if draw.has_subsurface:
            for name, value in interior_uniforms(draw, self.textures, self.scene.radius):
                set_uniform(program, name, value)
        set_uniform(program, "u_shininess", material.shininess or 0.0)
        self._weave.bind(program, material.weave, UNIT_WEAVE)
        for name in (*draw.maps, *draw.blank_maps):
            self._bind_map(program, draw, name)

    def _uniforms_of(self, material: Material) -> list[tuple[str, Value]]:
        """The uniforms of a material, which are cached as long as the plan does not change."""
        cached = self._uniforms.get(id(material))
        if cached is None or cached[0] is not material:
            cached = self._uniforms[id(material)] = material, list(uniforms(material))
        return cached[1]

    def _bind_map(self, program: moderngl.Program, draw: Draw, name: str) -> None:
        unit = (*draw.maps, *draw.blank_maps).index(name)
        texture = MAPS[name].texture(draw.surface) if name in draw.maps else None
        if texture is None:
            self.textures.bind_blank(name, unit)
        else:
            self.textures.bind(texture, name, unit)
        set_uniform(program, f"u_{name}_map", unit)
        if draw.program[f"{name.upper()}_TRANSFORM"]:
            transform = (texture and texture.transform) or UVTransform()
            set_uniform(program, f"u_{name}_transform", transform.matrix().T.astype(np.float32).tobytes())

    def _program(self, fragment: str, switches: dict[str, int]) -> moderngl.Program:
        return self._programs.get(vertex_of(fragment, switches), fragment, switches)

    def _mesh(self, index: int) -> MeshBuffers:
        mesh = self.scene.meshes[index]
        if mesh not in self._meshes:
            self._meshes[mesh] = MeshBuffers(self._context, mesh)
        return self._meshes[mesh]

    def _drop_arrays(self) -> None:
        """Release the vertex arrays, for other programs, or other buffers of what belongs to an instance."""
        for mesh in self._meshes.values():
            mesh.drop_arrays()

    def _release_indirect(self) -> None:
        for buffer in (*self._indirect, *self._behind.values()):
            buffer.release()
        self._indirect, self._behind = [], {}

    def release(self) -> None:
        for mesh_buffers in self._meshes.values():
            mesh_buffers.release()
        self._release_indirect()
        self._weave.release()
        self.set_interiors({})
        self.textures.release()


def _is_visible(draw: Draw, frame: Frame) -> bool:
    """Whether it may be in the picture. Of many instances each is asked when they are drawn."""
    return bool(draw.instances) or bool(frame.visible[draw.instance])


def bind_blocks(program: moderngl.Program) -> None:
    """Bind the uniform blocks of lights and of shadow maps."""
    for binding, name in enumerate(("Lights", "Shadows")):
        if name in program:
            program[name].binding = binding
