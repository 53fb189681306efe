"""KHR_materials_pbrSpecularGlossiness, an archived extension that old files use."""

from __future__ import annotations

from typing import Any

from ..schema import MAPS
from ..specular_glossiness import DIELECTRIC_F0
from .element import Element
from .textures import Textures


def read_specular_glossiness(place: Element, textures: Textures) -> dict[str, Any]:
    """The fields of `Material` that the extension replaces, but for its map of specular and glossiness."""
    white = (1.0, 1.0, 1.0)
    specular = place.vector("specularFactor", 3, white, 0.0, 1.0)
    return {
        "base_color": place.vector("diffuseFactor", 4, (*white, 1.0), 0.0, 1.0),
        "base_color_texture": textures.read(place, "diffuseTexture", MAPS["base_color"].info.neutral),
        "metallic": 0.0,
        "perceptual_roughness": 1.0 - place.number("glossinessFactor", 1.0, 0.0, 1.0),
        "specular_color": tuple(channel / DIELECTRIC_F0 for channel in specular),
    }
