"""The maps and features of a material that can change a pixel, for the raster and the path tracer alike."""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import replace
from typing import Any

from ..scene.material import ANISOTROPY, SHEEN, Material
from ..scene.mesh import Mesh
from ..scene.schema import MAPS, PARAMETERS, SWITCHED, multiplied_by
from ..scene.texture_image import TextureImage

DELTA_ALPHA = 1e-3
"""Lobes of a smaller alpha are mirrors, as in shaders/bsdf/bsdf.glsl."""


def used_maps(material: Material, mesh: Mesh, model: str, include_ineffective: bool = False) -> tuple[str, ...]:
    """The maps of `material` that can change how `mesh` looks with the shading model `model`: unlit, phong or pbr.

    `include_ineffective` also includes maps that have no effect because of their factors.
    """
    return tuple(name for name in MAPS if _is_used(name, material, mesh, model, include_ineffective))


def _is_used(name: str, material: Material, mesh: Mesh, model: str, include_ineffective: bool) -> bool:
    texture, info = MAPS[name].texture(material), MAPS[name].info
    if texture is None or texture.uv_set >= len(mesh.uvs) or model not in info.models:
        return False
    if info.needs_tangents and mesh.tangents is None:
        return False
    has_factor = bool(multiplied_by(name))  # without a factor the map would always change pixels
    return (include_ineffective and has_factor) or info.has_effect(material)


def supported(material: Material, mesh: Mesh, ndf: str = "ggx") -> Material:
    """`material` without the features that cannot be shown.

    A feature that needs tangents is dropped if `mesh` has none. Anisotropy is dropped if the distribution of normals,
    `ndf`, is not GGX.
    """
    dropped = [f for f in SWITCHED if f.is_on(material) and (
        (f.needs_tangents and mesh.tangents is None) or (f is ANISOTROPY and ndf != "ggx"))]
    defaults: dict[str, Any] = {p.name: p.default for p in PARAMETERS.values() if p.info.feature in dropped}
    return replace(material, **defaults) if dropped else material


def feature_switches(material: Material, model: str) -> dict[str, int]:
    """The switches of all features: on if `material` uses the feature and the shading model implements it."""
    return {f.switch: int(model in f.models and f.is_on(material)) for f in SWITCHED}


def metalness(material: Material) -> int:
    """The switch METALNESS of shaders/bsdf/surface.glsl: 0 dielectric, 1 metal, 2 a mixture."""
    if material.metallic == 0:
        return 0
    return 1 if material.metallic == 1 and material.metallic_roughness_texture is None else 2


def may_be_pane(material: Material, maps: Collection[str]) -> bool:
    """Whether light goes straight on through any point of a surface with these `maps`, which are not decoded: a thin
    wall of glass that may be as smooth as a mirror.

    A clear coat and fibres count as rough: neither is in what a pane transmits.
    """
    is_thin = material.transmits and not material.unlit and material.thickness <= 0 and material.weave is None
    is_smooth = material.perceptual_roughness**2 < DELTA_ALPHA or "metallic_roughness" in maps
    is_bare = material.clearcoat == 0 and not SHEEN.is_on(material)
    return is_thin and is_smooth and is_bare and not ANISOTROPY.is_on(material) and material.dispersion == 0


def texture_bytes(image: TextureImage) -> float:
    """About how many bytes an image takes on a GPU, with all its channels and mipmaps."""
    components = (1 if image.grey else 3) + image.has_alpha
    return image.width * image.height * components * (image.bits // 8) * 4 / 3
