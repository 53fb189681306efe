"""Draws surfaces into shadow maps."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import moderngl
import numpy as np

from ..gpu.programs import Programs, matrix_uniform, set_uniform
from ..plan.model import Draw, Program
from ..scene.scene import Scene
from ..scene.transform import handedness
from .geometry import MeshBuffers
from .surface_programs import SHADOW_VERTEX, TINT_MAPS, shadow_maps_of, shadow_program, tint_program
from .surfaces import Surfaces

_DEEPEST = 8192.0
"""Optical depth across a solid. Half floats, which sum those of its faces, do not hold much more, and what is thicker
than a thousandth of the solid is black then."""


class SurfaceCasters:
    """The surfaces of the current scene, as what lies between them and lights."""

    def __init__(self, programs: Programs, surfaces: Surfaces) -> None:
        self._programs, self._surfaces = programs, surfaces
        self._numbers: tuple[Scene, np.ndarray] | None = None

    def prepare(self, draw: Draw, to_unit: np.ndarray) -> Callable[[np.ndarray, np.ndarray], None]:
        """Prepare to draw instances into shadow maps. `to_unit` takes the world to scene units about the scene's
        centre.

        What is returned draws them, until this is called again, by a matrix that takes the world to clip space, and the
        light, which has its place (4,) in scene units, or is as far as its direction (0 last); 0 where panes stop it.
        """
        program, mesh = self._use(shadow_program(draw), draw, shadow_maps_of(draw))
        scene = self._surfaces.scene
        if shadow_maps_of(draw):
            set_uniform(program, "u_caster", self._number(draw.instance))
        if draw.instances:
            parts = [(part, part.show(scene.center)) for part in mesh.instances(scene, draw.instances)]
            from_unit = np.linalg.inv(to_unit)

            def draw_parts(matrix: np.ndarray, light: np.ndarray) -> None:
                set_uniform(program, "u_to_light", matrix_uniform(matrix @ from_unit))
                for part, count in parts:
                    mesh.draw_instances(program, part, count)

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

    def prepare_tint(self, draw: Draw, to_unit: np.ndarray) -> Callable[[np.ndarray, np.ndarray], None]:
        """As `prepare`, to draw what light keeps on its way through an instance of glass."""
        program, mesh = self._use(tint_program(draw), draw, TINT_MAPS)
        scene = self._surfaces.scene
        transform = scene.instances[draw.instance].transform
        corners = scene.corners[draw.instance]
        center = (corners.mean(axis=0) - scene.center) / scene.radius
        across = max(float(np.linalg.norm(np.ptp(corners, axis=0))) / scene.radius, 1e-30)
        absorption = np.minimum(draw.surface.extinction * scene.radius, _DEEPEST / across)
        set_uniform(program, "u_model_to_unit", matrix_uniform(to_unit @ transform @ mesh.to_mesh))
        set_uniform(program, "u_center", tuple(center))
        set_uniform(program, "u_absorption", tuple(absorption))

        def draw_tint(matrix: np.ndarray, light: np.ndarray) -> None:
            from_model = matrix @ transform
            set_uniform(program, "u_model_to_light", matrix_uniform(from_model @ mesh.to_mesh))
            set_uniform(program, "u_light", tuple(light))
            set_uniform(program, "u_front", -handedness(from_model))  # depth grows away from the light
            mesh.draw(program)

        return draw_tint

    def _use(self, wanted: Program, draw: Draw, maps: Sequence[str]) -> tuple[moderngl.Program, MeshBuffers]:
        """A program with the draw's material and those of `maps` that it has, and the mesh."""
        program = self._programs.get(SHADOW_VERTEX, wanted.fragment, dict(wanted.switches))
        if maps:
            self._surfaces.materials.set_maps(
                program, draw, [name for name in maps if wanted[f"{name.upper()}_MAP"]])
        return program, self._surfaces.mesh(draw.mesh)

    def _number(self, instance: int) -> int:
        """The number of a blended instance among all that cast shadows: by where it stands, not by its place in the
        file, since the number decides which texels of the shadow let light through."""
        scene = self._surfaces.scene
        if self._numbers is None or self._numbers[0] is not scene:
            keys = np.concatenate([scene.corners.mean(axis=1), [i.transform.ravel() for i in scene.instances]], axis=1)
            self._numbers = scene, np.argsort(np.lexsort(keys.T[::-1]))
        return int(self._numbers[1][instance])
