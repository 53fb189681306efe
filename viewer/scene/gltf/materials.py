"""Materials: metallic-roughness with the extensions that are supported."""

from __future__ import annotations

import math
from typing import Any

from ..material import AlphaMode, Material
from .element import Element
from .textures import Textures

_ALPHA_MODES: dict[str, AlphaMode] = {"OPAQUE": "opaque", "MASK": "mask", "BLEND": "blend"}


class Materials:
    """The materials that are in use, in the order of their first use."""

    def __init__(self, root: Element, textures: Textures) -> None:
        self._items = root.array("materials")
        self._textures = textures
        self._number: dict[int | None, int] = {}
        self.used: list[Material] = []

    def number(self, primitive: Element) -> int:
        """The place in `used` of a primitive's material, or of the default material where it names none."""
        index = primitive.index("material", len(self._items), None)
        if index not in self._number:
            self._number[index] = len(self.used)
            self.used.append(Material() if index is None else read_material(self._items[index], self._textures))
        return self._number[index]


def read_material(element: Element, textures: Textures) -> Material:
    """One element of `materials`."""
    pbr = element.object("pbrMetallicRoughness")
    normal, occlusion = element.object("normalTexture"), element.object("occlusionTexture")
    strength = element.extension("KHR_materials_emissive_strength")
    emissive = element.vector("emissiveFactor", 3, (0.0, 0.0, 0.0), 0.0, 1.0)
    scale = 1.0 if strength is None else strength.number("emissiveStrength", 1.0, 0.0)
    ior = element.extension("KHR_materials_ior")
    return Material(
        name=element.string("name", ""),
        base_color=pbr.vector("baseColorFactor", 4, (1.0, 1.0, 1.0, 1.0), 0.0, 1.0),
        base_color_texture=textures.read(pbr, "baseColorTexture"),
        metallic=pbr.number("metallicFactor", 1.0, 0.0, 1.0),
        perceptual_roughness=pbr.number("roughnessFactor", 1.0, 0.0, 1.0),
        metallic_roughness_texture=textures.read(pbr, "metallicRoughnessTexture"),
        normal_texture=textures.read(element, "normalTexture"),
        normal_scale=normal.number("scale", 1.0),
        occlusion_texture=textures.read(element, "occlusionTexture"),
        occlusion_strength=occlusion.number("strength", 1.0, 0.0, 1.0),
        emissive=tuple(channel * scale for channel in emissive),
        emissive_texture=textures.read(element, "emissiveTexture"),
        ior=1.5 if ior is None else _ior(ior),
        **_specular(element, textures),
        **_transmission(element, textures),
        **_volume(element, textures),
        alpha_mode=element.choice("alphaMode", _ALPHA_MODES, "OPAQUE"),
        alpha_cutoff=element.number("alphaCutoff", 0.5, 0.0),
        double_sided=element.boolean("doubleSided", False),
        unlit=element.extension("KHR_materials_unlit") is not None,
    )


def _ior(extension: Element) -> float:
    # 0 is not below 1 by mistake: the extension gives it the meaning "f0 = 1 before the specular parameters".
    ior = extension.number("ior", 1.5, 0.0)
    return ior if ior == 0.0 else extension.number("ior", 1.5, 1.0, math.inf)


def _specular(element: Element, textures: Textures) -> dict[str, Any]:
    extension = element.extension("KHR_materials_specular")
    if extension is None:
        return {}
    return {
        "specular": extension.number("specularFactor", 1.0, 0.0, 1.0),
        "specular_texture": textures.read(extension, "specularTexture"),
        "specular_color": extension.vector("specularColorFactor", 3, (1.0, 1.0, 1.0), 0.0),
        "specular_color_texture": textures.read(extension, "specularColorTexture"),
    }


def _transmission(element: Element, textures: Textures) -> dict[str, Any]:
    extension = element.extension("KHR_materials_transmission")
    if extension is None:
        return {}
    return {
        "transmission": extension.number("transmissionFactor", 0.0, 0.0, 1.0),
        "transmission_texture": textures.read(extension, "transmissionTexture"),
    }


def _volume(element: Element, textures: Textures) -> dict[str, Any]:
    extension = element.extension("KHR_materials_volume")
    if extension is None:
        return {}
    return {
        "thickness": extension.number("thicknessFactor", 0.0, 0.0),
        "thickness_texture": textures.read(extension, "thicknessTexture"),
        # Must be above 0: what lets nothing through is said by its colour.
        "attenuation_distance": extension.number("attenuationDistance", math.inf, 1e-9),
        "attenuation_color": extension.vector("attenuationColor", 3, (1.0, 1.0, 1.0), 0.0, 1.0),
    }
