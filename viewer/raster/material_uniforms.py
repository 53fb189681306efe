"""A material as the uniforms and textures of a program."""

from __future__ import annotations

from collections.abc import Iterable

import moderngl
import numpy as np

from ..gpu.programs import set_uniform
from ..material.pack import uniforms
from ..material.weave import WeaveBinding
from ..plan.model import THIN_WALLED, Draw
from ..scene.mask_levels import mask_map
from ..scene.material import VOLUME, Material, UVTransform
from ..scene.mesh import Mesh
from ..scene.schema import MAPS, Value
from .enclosed import light_inside
from .subsurface_uniforms import interior_uniforms
from .textures import Textures
from .units import UNIT_NORMAL_ROOT, UNIT_WEAVE


class MaterialUniforms:
    """Sets them. What is worked out for them is kept as long as the plan does not change."""

    def __init__(self, gl: moderngl.Context, textures: Textures) -> None:
        self._textures = textures
        self._weave = WeaveBinding(gl)
        self._uniforms: dict[int, tuple[Material, list[tuple[str, Value]]]] = {}
        self._light_inside: dict[tuple[object, ...], tuple[Material, Mesh, tuple[float, ...]]] = {}

    def clear(self) -> None:
        """Forget the uniforms of materials, for another plan."""
        self._uniforms.clear()
        self._light_inside.clear()

    def set(self, program: moderngl.Program, draw: Draw, radius: float) -> None:
        """Set all of the draw's material. `radius` is that of the scene."""
        material = draw.surface
        self._set_parameters(program, material)
        if VOLUME.is_on(material):
            set_uniform(program, "u_absorption", tuple(material.extinction * radius))
        if draw.has_subsurface:
            for name, value in interior_uniforms(draw, self._textures, radius):
                set_uniform(program, name, value)
        set_uniform(program, "u_shininess", material.shininess or 0.0)
        self._weave.bind(program, material.weave, UNIT_WEAVE)
        for name in (*draw.maps, *draw.blank_maps):
            self._bind_map(program, draw, name)
        if draw.program.get("GROOVED"):
            self._textures.bind_root(MAPS["normal"].texture(draw.surface), UNIT_NORMAL_ROOT)
            set_uniform(program, "u_normal_root", UNIT_NORMAL_ROOT)

    def set_maps(self, program: moderngl.Program, draw: Draw, names: Iterable[str]) -> None:
        """Set the parameters of the draw's material, and of its maps only `names`."""
        self._set_parameters(program, draw.surface)
        for name in names:
            self._bind_map(program, draw, name)

    def set_light_inside(self, program: moderngl.Program, draw: Draw, mesh: Mesh) -> None:
        """Set what arrives at the inner sides of the draw, if it is a thin wall. `mesh` is its mesh."""
        key = draw.mesh, id(draw.surface), draw.maps, draw.transmits
        cached = self._light_inside.get(key)
        if cached is None or cached[0] is not draw.surface or cached[1] is not mesh:
            is_wall = draw.transmits == THIN_WALLED  # others get here by programs that leave nothing out
            inside = tuple(light_inside(draw, mesh, self._textures.mean)) if is_wall else (1.0, 1.0, 1.0)
            cached = self._light_inside[key] = draw.surface, mesh, inside
        set_uniform(program, "u_light_inside", cached[2])

    def _set_parameters(self, program: moderngl.Program, material: Material) -> None:
        cached = self._uniforms.get(id(material))
        if cached is None or cached[0] is not material:
            cached = self._uniforms[id(material)] = material, list(uniforms(material))
        for name, value in cached[1]:
            set_uniform(program, name, value)

    def _bind_map(self, program: moderngl.Program, draw: Draw, name: str) -> None:
        unit = (*draw.maps, *draw.blank_maps).index(name)
        texture = MAPS[name].texture(draw.surface) if name in draw.maps else None
        if texture is None:
            self._textures.bind_blank(name, unit)
        else:
            self._textures.bind(draw, name, unit)
        set_uniform(program, f"u_{name}_map", unit)
        if name == "base_color":
            set_uniform(program, "u_mask_levels", _mask_levels(draw.surface) if texture is not None else 0)
        if draw.program[f"{name.upper()}_TRANSFORM"]:
            transform = (texture and texture.transform) or UVTransform()
            set_uniform(program, f"u_{name}_transform", transform.matrix().T.astype(np.float32).tobytes())

    def release(self) -> None:
        self._weave.release()


def _mask_levels(material: Material) -> int:
    """What shaders/raster/alpha_mask.glsl has to know of the levels of its base colour."""
    if material.base_color_texture is None or mask_map("base_color", material) is None:
        return 0
    return {"nearest": 1, "linear": 2}[material.base_color_texture.sampler.mip_filter or "linear"]
