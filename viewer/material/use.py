"""What of a material can change a pixel: the one rule that the raster and the path tracer go by."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

from ..scene.material import Material
from ..scene.mesh import Mesh
from ..scene.schema import MAPS, PARAMETERS, SWITCHED
from ..scene.texture_image import TextureImage


def used_maps(material: Material, mesh: Mesh, model: str, leave_nothing_out: bool = False) -> tuple[str, ...]:
    """The maps of `material` that can change how `mesh` looks to a `model` of shading: unlit, phong or pbr.

    `leave_nothing_out` takes those, too, whose factors make them harmless.
    """
    return tuple(name for name in MAPS if _is_used(name, material, mesh, model, leave_nothing_out))


def _is_used(name: str, material: Material, mesh: Mesh, model: str, leave_nothing_out: bool) -> bool:
    texture, info = MAPS[name].texture(material), MAPS[name].info
    if texture is None or texture.uv_set >= len(mesh.uvs) or model not in info.models:
        return False
    if info.needs_tangents and mesh.tangents is None:
        return False
    has_factor = name not in ("normal", "occlusion")  # else nothing could make it harmless
    return (leave_nothing_out and has_factor) or info.counts(material)


def as_mesh_allows(material: Material, mesh: Mesh) -> Material:
    """`material` without the features that need tangents, where `mesh` has none."""
    lost = [f for f in SWITCHED if f.needs_tangents and mesh.tangents is None and f.is_on(material)]
    defaults: dict[str, Any] = {p.name: p.default for p in PARAMETERS.values() if p.info.feature in lost}
    return replace(material, **defaults) if lost else material


def feature_switches(material: Material, model: str) -> dict[str, int]:
    """The switches of the features that `material` has and `model` knows."""
    return {f.switch: int(model in f.models and f.is_on(material)) for f in SWITCHED}


def metalness(material: Material) -> int:
    """The switch METALNESS of shaders/bsdf/surface.glsl: 0 dielectric, 1 metal, 2 a mixture."""
    if material.metallic == 0:
        return 0
    return 1 if material.metallic == 1 and material.metallic_roughness_texture is None else 2


def texture_bytes(image: TextureImage) -> float:
    """About what an image takes on a GPU, all channels that it has, with mipmaps."""
    components = (1 if image.grey else 3) + image.has_alpha
    return image.width * image.height * components * (image.bits // 8) * 4 / 3
