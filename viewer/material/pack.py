"""Packs a material's values for shaders: uniforms for the raster, texels of the scene buffer for the path tracer."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from ..scene.material import Material
from ..scene.schema import MAPS, PARAMETERS, Value, multiplied_by


@dataclass(frozen=True)
class Place:
    """The position of a value in a material's record: its texel, its first component and its number of components."""

    texel: int
    component: int
    size: int

    @property
    def swizzle(self) -> str:
        return "xyzw"[self.component : self.component + self.size]


def _layout() -> dict[str, Place]:
    """Places each value in the first texel with enough free components. Values that all materials need come first."""
    shown = [p for p in PARAMETERS.values() if p.info.path_traced and p.info.role != "python"]
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
"""The texel after the values, which points to the records of the material's maps."""
RECORD_TEXELS = MAPS_TEXEL + 1

COLOR_ROLES = {m.name: 1 << k for k, m in enumerate(m for m in MAPS.values() if m.info.path_traced and m.info.srgb)}
DATA_ROLES = {m.name: 1 << k for k, m in enumerate(
    m for m in MAPS.values()
    if m.info.path_traced and not m.info.srgb and (multiplied_by(m.name) or m.info.raw_channels or m.info.is_applied))}
"""Bits in the record of a texture: the maps that it is used as. Normal maps, which are neither multiplied nor kept in
the inputs, have records of their own."""


def uniforms(material: Material) -> Iterator[tuple[str, Value]]:
    """The name `u_<parameter>` and the value of each uniform of a material."""
    for parameter in PARAMETERS.values():
        if parameter.info.role != "python":
            yield f"u_{parameter.name}", parameter.value(material)


def record(material: Material) -> np.ndarray:
    """The values of a material, (MAPS_TEXEL, 4) float32. If alpha_mode is blend, the cutoff is -1."""
    values = {name: PARAMETERS[name].value(material) for name in RECORD}
    if material.alpha_mode == "blend":
        values["alpha_cutoff"] = -1.0
    texels = np.zeros((MAPS_TEXEL, 4), np.float32)
    for name, place in RECORD.items():
        texels[place.texel, place.component : place.component + place.size] = values[name]
    return texels
