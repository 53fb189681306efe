"""Materials as the tracer's shaders read them: texels of the scene buffer with factors and with records of maps.

The maps of a material are in two runs of records, one for colours (sRGB) and one for data. If several fields read the
same texture, they share one record, so that the texture is sampled once.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from ...material.pack import COLOR_ROLES, DATA_ROLES, record
from ...material.use import feature_switches, may_be_pane, used_maps
from ...scene.material import SHEEN, Material, Sampler, Texture
from ...scene.medium import VACUUM, Medium
from ...scene.mesh import Mesh
from ...scene.schema import MAPS
from ..layout import (
    MAP_NEAREST,
    MAP_ROLE_SHIFT,
    MAP_SECOND_UV,
    MAP_TEXELS,
    MAP_TRANSFORMED,
    MAP_WRAP_BITS,
    WRAPS,
)


@dataclass(frozen=True)
class MapUse:
    """A texture and its roles: the fields that read it, as bits."""

    texture: Texture
    roles: int


@dataclass(frozen=True, eq=False)
class TraceMaterial:
    """A material on a mesh, without the maps that make no difference there.

    `medium` is the one behind its front side. `is_boundary`: a path goes straight through it, into another medium.
    `is_pane`: a thin wall of glass with points that may be smooth, through which light goes straight on
    (shaders/trace/pane.glsl).
    """

    material: Material
    color_maps: tuple[MapUse, ...]
    data_maps: tuple[MapUse, ...]
    normal_map: Texture | None
    clearcoat_normal_map: Texture | None
    transmits: bool
    transmits_diffusely: bool
    medium: Medium
    is_thin: bool
    is_boundary: bool = False
    is_pane: bool = False

    @property
    def features(self) -> dict[str, int]:
        """The switches of all features of materials: on if it has the feature."""
        return feature_switches(self.material, "unlit" if self.material.unlit else "pbr")

    @property
    def is_solid(self) -> bool:
        """Whether light travels inside."""
        return (self.transmits or self.transmits_diffusely) and not self.is_thin

    @property
    def data_textures(self) -> list[Texture]:
        """The textures that are read from the data atlas."""
        return [use.texture for use in self.data_maps] + self.normal_maps

    @property
    def normal_maps(self) -> list[Texture]:
        """Of the base and of the clear coat, those that there are."""
        return [texture for texture in (self.normal_map, self.clearcoat_normal_map) if texture is not None]


def trace_material(material: Material, mesh: Mesh, scatters: bool = False) -> TraceMaterial:
    """`material` on `mesh`, with those of its maps that make a difference. `scatters`: any medium of the scene does."""
    model = "unlit" if material.unlit else "pbr"
    names = [name for name in used_maps(material, mesh, model) if MAPS[name].info.path_traced]

    def uses(roles: Mapping[str, int]) -> tuple[MapUse, ...]:
        found: dict[Texture, int] = {}
        for name in names:
            texture = MAPS[name].texture(material)
            if name in roles and texture is not None:
                found[texture] = found.get(texture, 0) | roles[name]
        return tuple(MapUse(texture, bits) for texture, bits in found.items())

    transmits = material.transmits and not material.unlit
    transmits_diffusely = material.transmits_diffusely and not material.unlit
    is_thin = material.thickness <= 0
    return TraceMaterial(
        material,
        _emission_last(uses(COLOR_ROLES)),
        uses(DATA_ROLES),
        material.normal_texture if "normal" in names else None,
        material.clearcoat_normal_texture if "clearcoat_normal" in names else None,
        transmits,
        transmits_diffusely,
        VACUUM if material.unlit else material.medium,
        is_thin,
        scatters and transmits and _is_index_matched(material, names, mesh),
        may_be_pane(material, names),
    )


def _is_index_matched(material: Material, maps: list[str], mesh: Mesh) -> bool:
    """Whether a surface that transmits light changes nothing but the medium."""
    changes_nothing = {"transmission": 1.0, "ior": 1.0, "metallic": 0.0, "clearcoat": 0.0, "alpha_mode": "opaque",
                       "emissive": (0.0, 0.0, 0.0), "base_color": (1.0, 1.0, 1.0, material.base_color[3])}
    return (material.thickness > 0 and not SHEEN.is_on(material) and mesh.colors is None
            and not {"base_color", "transmission"} & set(maps)
            and all(getattr(material, name) == value for name, value in changes_nothing.items()))


def material_texels(
    material: TraceMaterial, first_color: int, first_data: int, normal: int, clearcoat_normal: int
) -> np.ndarray:
    """(RECORD_TEXELS, 4) uint32. The other arguments are numbers of records of maps; those of normals are -1 for none.
    """
    values = record(material.material)
    maps = (first_color | len(material.color_maps) << 24, first_data | len(material.data_maps) << 24, normal + 1,
            clearcoat_normal + 1)
    return np.concatenate([values.view(np.uint32), np.array([maps], np.uint32)])


def map_texels(texture: Texture, roles: int, page: tuple[int, int, int, int]) -> np.ndarray:
    """(MAP_TEXELS, 4) uint32: the record of a texture whose image is at `page` (x, y, width, height) of an atlas."""
    sampler: Sampler = texture.sampler
    flags = WRAPS[sampler.wrap_s] | WRAPS[sampler.wrap_t] << MAP_WRAP_BITS | roles << MAP_ROLE_SHIFT
    flags |= MAP_NEAREST * (sampler.mag_filter == "nearest") | MAP_SECOND_UV * (texture.uv_set == 1)
    flags |= MAP_TRANSFORMED * (texture.transform is not None)
    texels = np.zeros((MAP_TEXELS, 4), np.uint32)
    texels[0] = (page[0] | page[1] << 16, page[2] | page[3] << 16, flags, 0)
    if texture.transform is not None:
        texels[1:, :3] = texture.transform.matrix().astype(np.float32).view(np.uint32)
    return texels


def _emission_last(maps: tuple[MapUse, ...]) -> tuple[MapUse, ...]:
    """Order the maps so that emission is in the last record; the base colour is in the first already.

    Shaders look for them there. If emission shares a record that is not the last, it gets a record of its own.
    """
    emission = COLOR_ROLES["emissive"]
    own = next((use for use in maps if use.roles & emission), None)
    if own is None or own is maps[-1]:
        return maps
    rest = (MapUse(use.texture, use.roles & ~emission) for use in maps)
    return (*(use for use in rest if use.roles), MapUse(own.texture, emission))
