"""How the instances of meshes are drawn: those of a mesh by one call for all of them, or by one for each."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

from ..scene.material import VOLUME, Material
from ..scene.scene import Scene
from .model import Draw

INSTANCED_FROM = 64
"""From so many instances on, a mesh is drawn by one call. Fewer cost little, and a program that reads their places from
attributes would be one more to compile where other meshes could have shared it."""


def instances_of(scene: Scene) -> dict[int, tuple[int, ...]]:
    """The instances of each mesh that has any, the meshes in the order of their first ones."""
    found: dict[int, list[int]] = {}
    for number, instance in enumerate(scene.instances):
        found.setdefault(instance.mesh, []).append(number)
    return {mesh: tuple(numbers) for mesh, numbers in found.items()}


def is_instanced(count: int, material: Material, switches: Mapping[str, int]) -> bool:
    """Whether one call can draw the `count` instances of a mesh.

    Blended ones are sorted, and their shadows and those of glass have patterns by their numbers; solids that light
    enters differ in thickness; and baked light has an array for each.
    """
    lets_light_in = material.alpha_mode == "blend" or material.transmits or VOLUME.is_on(material)
    return count >= INSTANCED_FROM and not (lets_light_in or switches["INDIRECT"] or switches["SUBSURFACE"])


def placed(alike: Mapping[int, Draw], instances: Mapping[int, tuple[int, ...]]) -> tuple[Draw, ...]:
    """All draws in the order of the instances. `alike` has one of each mesh."""
    draws: list[Draw] = []
    for mesh, numbers in instances.items():
        if alike[mesh].program["INSTANCED"]:
            draws.append(replace(alike[mesh], instance=numbers[0], instances=numbers))
        else:
            draws += (replace(alike[mesh], instance=number, instances=()) for number in numbers)
    return tuple(sorted(draws, key=lambda draw: draw.instance))
