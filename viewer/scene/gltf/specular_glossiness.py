"""KHR_materials_pbrSpecularGlossiness, an archived extension that old files use."""

from __future__ import annotations

from typing import Any

from .element import Element

FACTORS = {"diffuseFactor": ("diffuse", 4), "specularFactor": ("specular_f0", 3), "glossinessFactor": ("glossiness", 1)}
"""The name of each in `viewer.scene.specular_glossiness.Factors`, and how many numbers it has."""


def read_factors(place: Element) -> dict[str, Any]:
    """The extension's factors, as numbers and tuples, by their names in `Factors`."""
    return {name: place.vector(key, size, (1.0,) * size, 0.0, 1.0) if size > 1 else place.number(key, 1.0, 0.0, 1.0)
            for key, (name, size) in FACTORS.items()}
