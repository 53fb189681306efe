"""Joins scenes: several models, volumes and sets of curves in one picture."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np

from .rig import Nodes, Rig
from .scene import Scene


def join(scene: Scene, *others: Scene) -> Scene:
    """`scene` with all that is in `others`, in the same world coordinates.

    Its name, environment, animations and variants are kept. The animations of the others are not played, which a
    warning says, and they are shown in the materials and at the time that they have.
    """
    for other in others:
        scene = _joined(scene, other)
    return scene


def _joined(scene: Scene, other: Scene) -> Scene:
    first_material, first_mesh = len(scene.materials), len(scene.meshes)
    meshes = tuple(replace(mesh, material=mesh.material + first_material) for mesh in other.meshes)
    instances = tuple(replace(instance, mesh=instance.mesh + first_mesh) for instance in other.instances)
    added = len(other.materials)
    variants = tuple(replace(variant, materials=variant.materials + other.materials,
                             numbers=variant.numbers + (-1,) * added) for variant in scene.variants)
    warnings = [f"{other.name}: {line}" for line in other.warnings]
    if other.animations:
        warnings.append(f"{other.name}: its animations are not played; only those of {scene.name} are")
    return replace(
        scene, meshes=scene.meshes + meshes, materials=scene.materials + other.materials,
        instances=scene.instances + instances, lights=scene.lights + other.lights,
        cameras=scene.cameras + other.cameras, warnings=(*scene.warnings, *warnings),
        facts=_facts(scene, other),
        rig=None if scene.rig is None else _with_still(scene.rig, other), variants=variants,
        volumes=scene.volumes + other.volumes, curves=scene.curves + other.curves)


def _facts(scene: Scene, other: Scene) -> dict[str, object]:
    """Those of `scene`, with the counts, the images and the grids of both, and the names of what was joined to it."""
    facts: dict[str, Any] = dict(scene.facts)
    for name, value in other.facts.items():
        if isinstance(value, int) or name in ("images", "grids"):
            facts[name] = facts[name] + value if name in facts else value
    return facts | {"with": [*facts.get("with", []), other.name]}


def _with_still(rig: Rig, other: Scene) -> Rig:
    """The rig of a scene that another one was joined to, whose instances hang on a node that does not move."""
    nodes, count = rig.nodes, len(other.instances)
    still = Nodes(np.append(nodes.parents, -1), np.append(nodes.depth, 0),
                  np.append(nodes.translations, np.zeros((1, 3)), axis=0),
                  np.append(nodes.rotations, [[0.0, 0.0, 0.0, 1.0]], axis=0),
                  np.append(nodes.scales, np.ones((1, 3)), axis=0), nodes.matrices, np.append(nodes.visible, True))
    offsets = np.tile(np.eye(4), (len(rig.instances), 1, 1)) if rig.offsets is None else rig.offsets
    skinned = np.zeros(len(rig.instances), bool) if rig.is_skinned is None else rig.is_skinned
    return replace(
        rig, nodes=still, instances=np.append(rig.instances, np.full(count, len(nodes.parents))),
        materials=rig.materials + (-1,) * len(other.materials), offsets=np.concatenate([offsets, other.transforms]),
        is_skinned=np.append(skinned, np.zeros(count, bool)))
