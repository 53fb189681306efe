"""Materials as the tracer's shaders read them: factors in words, and the maps that make a difference.

A material's maps are in two runs of records, those of colours (sRGB) and those of data; one record serves all the
fields that read the same image in the same way, so that it is sampled once.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ...scene.material import Material, Sampler, Texture
from ...scene.mesh import Mesh

# Roles of a record in shaders/trace/material.glsl: bits of the fields that read it.
BASE_COLOR, SPECULAR_COLOR, EMISSION = 1, 2, 4
METALLIC_ROUGHNESS, SPECULAR, TRANSMISSION = 1, 2, 4

_WRAPS = ("repeat", "clamp", "mirror")
_NEAREST, _SECOND_UV, _TRANSFORMED, _ROLES = 1 << 4, 1 << 5, 1 << 6, 8

MATERIAL_WORDS, MAP_WORDS = 6, 3


@dataclass(frozen=True)
class MapUse:
    """A texture and the fields that read it, as bits."""

    texture: Texture
    roles: int


@dataclass(frozen=True, eq=False)
class TraceMaterial:
    """A material on a mesh that has certain attributes; `sigma` is Beer's absorption by tracer units, (3,) float64."""

    material: Material
    color_maps: tuple[MapUse, ...]
    data_maps: tuple[MapUse, ...]
    normal_map: Texture | None
    transmission: float
    sigma: np.ndarray
    is_thin: bool

    @property
    def data_textures(self) -> list[Texture]:
        """What is read from the data atlas."""
        normal = [self.normal_map] if self.normal_map is not None else []
        return [use.texture for use in self.data_maps] + normal


def trace_material(material: Material, mesh: Mesh, unit: float) -> TraceMaterial:
    """What of `material` changes anything on `mesh`; `unit` is the world's length of a tracer unit."""
    lit = not material.unlit
    dielectric = lit and (material.metallic < 1 or material.metallic_roughness_texture is not None)
    transmission = material.transmission if dielectric else 0.0
    is_thin = material.thickness <= 0
    shines = any(material.emissive)
    reflects = dielectric and material.specular > 0
    has_lobes = lit and (material.metallic > 0 or material.perceptual_roughness > 0)

    def maps(*fields: tuple[str, int, bool]) -> tuple[MapUse, ...]:
        uses: dict[Texture, int] = {}
        for name, role, matters in fields:
            texture = getattr(material, f"{name}_texture")
            if matters and texture is not None and texture.uv_set < len(mesh.uvs):
                uses[texture] = uses.get(texture, 0) | role
        return tuple(MapUse(texture, roles) for texture, roles in uses.items())

    # The shaders look for the base colour in the first record and for emission in the last.
    color_maps = maps(
        ("base_color", BASE_COLOR, True),
        ("specular_color", SPECULAR_COLOR, reflects and any(material.specular_color)),
        ("emissive", EMISSION, shines),
    )
    data_maps = maps(
        ("metallic_roughness", METALLIC_ROUGHNESS, has_lobes),
        ("specular", SPECULAR, reflects),
        ("transmission", TRANSMISSION, transmission > 0),
    )
    has_normals = lit and mesh.tangents is not None and mesh.normals is not None and material.normal_scale != 0
    normal = maps(("normal", 1, has_normals))
    return TraceMaterial(
        material,
        # Emission that shares the base colour's record, with another behind them: it gets one of its own.
        _emission_last(color_maps),
        data_maps,
        normal[0].texture if normal else None,
        transmission,
        np.zeros(3) if is_thin or transmission == 0 else material.absorption * unit,
        is_thin,
    )


def material_words(material: TraceMaterial, first_color: int, first_data: int, normal: int) -> np.ndarray:
    """(MATERIAL_WORDS, 4) uint32, the records of its maps being given by their numbers (`normal` -1 for none)."""
    m = material.material
    cutoff = -1.0 if m.alpha_mode == "blend" else m.alpha_cutoff
    floats = np.array([
        m.base_color,
        (m.metallic, m.perceptual_roughness, m.ior, m.specular),
        (*m.specular_color, cutoff),
        (*m.emissive, m.normal_scale),
        (*material.sigma, material.transmission),
    ], np.float32)
    maps = (first_color | len(material.color_maps) << 24, first_data | len(material.data_maps) << 24, normal + 1, 0)
    return np.concatenate([floats.view(np.uint32), np.array([maps], np.uint32)])


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
    shared = next((use for use in maps[:-1] if use.roles & EMISSION), None)
    if shared is None:
        return maps
    rest = tuple(MapUse(use.texture, use.roles & ~EMISSION) for use in maps)
    return (*(use for use in rest if use.roles), MapUse(shared.texture, EMISSION))
