"""A scene as a white furnace: white, and lit alike from everywhere, so that what keeps all light cannot be seen."""

from __future__ import annotations

from dataclasses import replace

from .environment_presets import make_preset
from .material import Material
from .mesh import Mesh
from .scene import Scene


def in_furnace(scene: Scene) -> Scene:
    """`scene` under radiance 1 from all around, without lights of its own, every surface white and none shining.

    Roughness, metalness, index of refraction and normals stay: they are what is tested.
    """
    return replace(
        scene,
        meshes=tuple(map(_uncolored, scene.meshes)),
        materials=tuple(map(_white, scene.materials)),
        lights=(),
        environment=make_preset("furnace"),
    )


def _white(material: Material) -> Material:
    return replace(
        material, base_color=(1.0, 1.0, 1.0, material.base_color[3]), base_color_texture=None, emissive=(0.0, 0.0, 0.0),
        occlusion_texture=None, specular_color=(1.0, 1.0, 1.0), specular_color_texture=None, unlit=False,
        alpha_mode="opaque",
    )


def _uncolored(mesh: Mesh) -> Mesh:
    return mesh if mesh.colors is None else replace(mesh, colors=None)
