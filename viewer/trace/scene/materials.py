"""Materials as the tracer's shaders read them: factors in words, and the maps that make a difference.

A material's maps are in two runs of records, those of colours (sRGB) and those of data; one record serves all the
fields that read the same image in the same way, so that it is sampled once.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from ...material.pack import COLOR_ROLES, DATA_ROLES, record
from ...material.use import used_maps
from ...scene.material import Material, Sampler, Texture
from ...scene.medium import VACUUM, Medium
from ...scene.mesh import Mesh
from ...scene.schema import MAPS

_WRAPS = ("repeat", "clamp", "mirror")
_NEAREST, _SECOND_UV, _TRANSFORMED, _ROLES = 1 << 4, 1 << 5, 1 << 6, 8

MAP_WORDS = 3


@dataclass(frozen=True)
class MapUse:
    """A texture and the fields that read it, as bits."""

    texture: Texture
    roles: int


@dataclass(frozen=True, eq=False)
class TraceMaterial:
    """A material on a mesh that has certain attributes; `medium` is what is behind its front."""

    material: Material
    color_maps: tuple[MapUse, ...]
    data_maps: tuple[MapUse, ...]
    normal_map: Texture | None
    transmission: float
    medium: Medium
    is_thin: bool

    @property
    def data_textures(self) -> list[Texture]:
        """What is read from the data atlas."""
        normal = [self.normal_map] if self.normal_map is not None else []
        return [use.texture for use in self.data_maps] + normal


def trace_material(material: Material, mesh: Mesh) -> TraceMaterial:
    """What of `material` changes anything on `mesh`."""
    names = [name for name in used_maps(material, mesh, "unlit" if material.unlit else "pbr") if MAPS[name].info.paths]

    def uses(roles: Mapping[str, int]) -> tuple[MapUse, ...]:
        found: dict[Texture, int] = {}
        for name in names:
            texture = MAPS[name].texture(material)
            if name in roles and texture is not None:
                found[texture] = found.get(texture, 0) | roles[name]
        return tuple(MapUse(texture, bits) for texture, bits in found.items())

    transmits = material.transmits and not material.unlit
    is_thin = material.thickness <= 0
    return TraceMaterial(
        material,
        _emission_last(uses(COLOR_ROLES)),
        uses(DATA_ROLES),
        material.normal_texture if "normal" in names else None,
        material.transmission if transmits else 0.0,
        VACUUM if is_thin or not transmits else Medium(tuple(material.absorption.tolist())),
        is_thin,
    )


def material_words(material: TraceMaterial, first_color: int, first_data: int, normal: int) -> np.ndarray:
    """(RECORD_TEXELS, 4) uint32, the records of its maps being given by their numbers (`normal` -1 for none)."""
    values = record(material.material, {"transmission": material.transmission})
    maps = (first_color | len(material.color_maps) << 24, first_data | len(material.data_maps) << 24, normal + 1, 0)
    return np.concatenate([values.view(np.uint32), np.array([maps], np.uint32)])


def map_words(texture: Texture, roles: int, page: tuple[int, int, int, int]) -> np.ndarray:
    """(MAP_WORDS, 4) uint32 of a texture whose image lies in an atlas at `page` (x, y, width, height)."""
    sampler: Sampler = texture.sampler
    flags = _WRAPS.index(sampler.wrap_s) | _WRAPS.index(sampler.wrap_t) << 2 | roles << _ROLES
    flags |= _NEAREST * (sampler.mag_filter == "nearest") | _SECOND_UV * (texture.uv_set == 1)
    flags |= _TRANSFORMED * (texture.transform is not None)
    words = np.zeros((MAP_WORDS, 4), np.uint32)
    words[0] = (page[0] | page[1] << 16, page[2] | page[3] << 16, flags, 0)
    if texture.transform is not None:
        words[1:, :3] = texture.transform.matrix().astype(np.float32).view(np.uint32)
    return words


def _emission_last(maps: tuple[MapUse, ...]) -> tuple[MapUse, ...]:
    """Shaders look for the base colour in the first record and for emission in the last.

    Emission gets a record of its own where it would share one that has to come first.
    """
    emission = COLOR_ROLES["emissive"]
    own = next((use for use in maps if use.roles & emission), None)
    if own is None or own is maps[-1]:
        return maps
    rest = (MapUse(use.texture, use.roles & ~emission) for use in maps)
    return (*(use for use in rest if use.roles), MapUse(own.texture, emission))
