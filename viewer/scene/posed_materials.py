"""Materials at a time: the parameters and texture transforms that tracks move."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np

from .animation import Target
from .light import BRIGHTEST
from .material import Material, UVTransform
from .schema import PARAMETERS
from .specular_glossiness import Factors, with_factors

if TYPE_CHECKING:
    from .scene import Scene


def posed_materials(scene: Scene, values: dict[Target, np.ndarray]) -> tuple[Material, ...]:
    """The materials of `scene` with the values of tracks, kept within the ranges of their parameters."""
    rig = scene.rig
    moved: dict[int, dict[str, Any]] = {}
    for target, value in values.items():
        if rig is not None and target.kind == "material" and target.number in rig.materials:
            moved.setdefault(target.number, {})[target.name] = value
    if rig is None or not moved:
        return scene.materials
    materials = list(scene.materials)
    for k, number in enumerate(rig.materials):
        if number in moved:
            materials[k] = moved_material(materials[k], moved[number])
    return scene.materials if tuple(materials) == scene.materials else tuple(materials)


def plain(value: np.ndarray) -> Any:
    """A value of a track as a field holds it: a number, or a tuple of numbers."""
    numbers = value.tolist()
    return numbers[0] if len(numbers) == 1 else tuple(numbers)


def moved_material(material: Material, values: Mapping[str, np.ndarray]) -> Material:
    """`material` with the values of tracks, by the names of their targets. That of "emissive" needs the strength,
    and each of `Factors` needs the others."""
    changes: dict[str, Any] = {}
    for name, value in values.items():
        if name in PARAMETERS:
            info = PARAMETERS[name].info
            is_special = info.special is not None and bool((value == info.special).all())
            changes[name] = plain(value if is_special else np.clip(value, info.low, info.high))
        elif "." in name:  # "base_color_texture.offset"
            field, part = name.split(".")
            texture = changes.get(field, getattr(material, field))
            if texture is not None:
                transform = replace(texture.transform or UVTransform(), **{part: plain(value)})
                changes[field] = replace(texture, transform=transform)
    if "emissive" in changes:  # which is multiplied by its strength
        strength = max(float(values["emissive_strength"][0]), 0.0)
        changes["emissive"] = tuple(min(channel * strength, BRIGHTEST) for channel in changes["emissive"])
    moved = replace(material, **changes)
    if "diffuse" not in values:
        return moved
    return with_factors(moved, Factors(*(plain(np.clip(values[name], 0.0, 1.0)) for name in Factors._fields)))
