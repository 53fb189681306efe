"""A scene in one material, for looking at its shape alone."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from ..base.expect import expect
from .material import Material
from .mesh import Mesh

if TYPE_CHECKING:
    from .scene import Scene


def with_material(scene: Scene, material: Material) -> Scene:
    """See `Scene.with_material`."""
    expect(material, Material, "material", "a Material")
    rig = scene.rig
    if rig is not None:
        deformed = {number: replace(each, rest=_plain(each.rest)) for number, each in rig.deformed.items()}
        rig = replace(rig, materials=(-1,), deformed=deformed)
    return replace(scene, meshes=tuple(map(_plain, scene.meshes)), materials=(material,), rig=rig, variants=(),
                   variant="")


def _plain(mesh: Mesh) -> Mesh:
    return replace(mesh, material=0, colors=None)
