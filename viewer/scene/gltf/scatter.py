"""Scattering: KHR_materials_scatter, and the names that KHR_materials_volume_scatter had in earlier drafts."""

from __future__ import annotations

from typing import Any

from ..material import DIFFUSE_TRANSMISSION, SCATTER, SPECULAR_GLOSSINESS, TRANSMISSION, VOLUME_SCATTER
from ..schema import PARAMETERS
from .element import Element

_UNLIT = "KHR_materials_unlit"


def read_scatter(material: Element, values: dict[str, Any]) -> dict[str, Any]:
    """The fields of a `Material` with these `values` that scattering changes. What cannot be shown is warned of."""
    changes: dict[str, Any] = {}
    volume, scatter = material.extension(VOLUME_SCATTER.extension), material.extension(SCATTER.extension)
    if volume is not None:
        for key in ("multiscatterColor", "scatterAlbedo"):
            if key in volume and PARAMETERS["scatter_color"].info.key not in volume:
                changes["scatter_color"] = volume.vector(key, 3, (0.0, 0.0, 0.0), 0.0, 1.0)
                break
    if scatter is None or values["scatter_strength"] == 0:
        return changes
    excluding = [name for name in (_UNLIT, SPECULAR_GLOSSINESS.extension) if material.extension(name) is not None]
    if excluding or values["transmission"] == 0:
        scatter.warn(f"it cannot be combined with {excluding[0]} and is left out" if excluding else
                     f"it has no effect without light that {TRANSMISSION.extension} lets through")
        return changes | {"scatter_strength": 0.0, "scatter_strength_texture": None}
    if material.extension(DIFFUSE_TRANSMISSION.extension) is not None:
        scatter.warn(f"it takes the place of {DIFFUSE_TRANSMISSION.extension}, which is left out")
        changes["diffuse_transmission"] = 0.0
    maps = [name for name in ("scatter_strength_texture", "multiscatter_color_texture") if values[name] is not None]
    if maps and values["thickness"] > 0:
        scatter.warn("a solid is filled with the same medium everywhere; the maps of scattering are left out")
        changes |= dict.fromkeys(maps)
    return changes
