"""The white furnace test: a white scene under constant light, in which a surface that loses no light is invisible."""

from __future__ import annotations

import math
from dataclasses import replace

from .environment_presets import make_preset
from .material import Material
from .mesh import Mesh
from .scene import Scene


def in_furnace(scene: Scene) -> Scene:
    """`scene` under radiance 1 from all directions, without other lights; its surfaces neither absorb nor emit light.

    Roughness, metalness, index of refraction, transmission and normals stay, since the test is about them.
    """
    return replace(
        scene,
        meshes=tuple(map(_uncolored, scene.meshes)),
        materials=tuple(map(whitened, scene.materials)),
        lights=(),
        environment=make_preset("furnace"),
    )


def whitened(material: Material) -> Material:
    """`material` with all colours 1, so that neither the surface nor the volume behind it absorbs light."""
    return replace(
        material, base_color=(1.0, 1.0, 1.0, material.base_color[3]), base_color_texture=None, emissive=(0.0, 0.0, 0.0),
        emissive_texture=None, occlusion_texture=None, specular_color=(1.0, 1.0, 1.0), specular_color_texture=None,
        diffuse_transmission_color=(1.0, 1.0, 1.0), diffuse_transmission_color_texture=None,
        multiscatter_color=(1.0, 1.0, 1.0), multiscatter_color_texture=None,
        sheen_color=(max(material.sheen_color),) * 3, sheen_color_texture=None,
        specular_glossiness_texture=None, attenuation_distance=math.inf, attenuation_color=(1.0, 1.0, 1.0),
        unlit=False, alpha_mode="opaque",
    )


def _uncolored(mesh: Mesh) -> Mesh:
    return mesh if mesh.colors is None else replace(mesh, colors=None)
