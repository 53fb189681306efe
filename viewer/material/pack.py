"""A material's numbers as shaders get them: uniforms of the raster, texels of the path tracer's scene buffer."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from ..scene.material import Material
from ..scene.schema import MAPS, PARAMETERS, Value


@dataclass(frozen=True)
class Place:
    """Where a value lies in a material's record: which texel, its first component, and how many components."""

    texel: int
    component: int
    size: int

    @property
    def swizzle(self) -> str:
        return "xyzw"[self.component : self.component + self.size]



def _layout() -> dict[str, Place]:
    """Each value goes to the first texel that has room for it; those that every material needs go first."""
    shown = [p for p in PARAMETERS.values() if p.info.paths and p.info.role != "python"]
    shown.sort(key=lambda p: p.info.role == "argument" or p.info.feature.switch != "")
    sizes = {p.name: p.size for p in shown}
    room: list[int] = []
    places = {}
    for name, size in sizes.items():
        texel = next((k for k, free in enumerate(room) if free >= size), len(room))
        if texel == len(room):
            room.append(4)
        places[name] = Place(texel, 4 - room[texel], size)
        room[texel] -= size
    return places


RECORD = _layout()
MAPS_TEXEL = max(place.texel for place in RECORD.values()) + 1
"""The texel behind the values, which says where the records of the material's maps are."""
RECORD_TEXELS = MAPS_TEXEL + 1

COLOR_ROLES = {m.name: 1 << k for k, m in enumerate(m for m in MAPS.values() if m.info.paths and m.info.srgb)}
DATA_ROLES = {m.name: 1 << k for k, m in enumerate(
    m for m in MAPS.values() if m.info.paths and not m.info.srgb and m.name != "normal")}
"""Bits that say which maps a record of a texture serves; the normal map has a record of its own."""


def uniforms(material: Material) -> Iterator[tuple[str, Value]]:
    """The uniforms `u_<parameter>` of a material."""
    for parameter in PARAMETERS.values():
        yield f"u_{parameter.name}", parameter.value(material)


def record(material: Material) -> np.ndarray:
    """(MAPS_TEXEL, 4) float32: the values of a material. Where alpha blends, the cutoff is -1."""
    values = {name: PARAMETERS[name].value(material) for name in RECORD}
    if material.alpha_mode == "blend":
        values["alpha_cutoff"] = -1.0
    texels = np.zeros((MAPS_TEXEL, 4), np.float32)
    for name, place in RECORD.items():
        texels[place.texel, place.component : place.component + place.size] = values[name]
    return texels
