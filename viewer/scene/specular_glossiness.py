"""Materials of KHR_materials_pbrSpecularGlossiness as materials of metallic-roughness: dielectrics with a coloured f0.

The map of specular and glossiness is the only thing that metallic-roughness cannot say; shaders convert its texels as
`with_glossiness` does (shaders/bsdf/specular_glossiness.glsl).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import NamedTuple

from .material import RGB, Material
from .parameter import RGBA, WHITE

DIELECTRIC_F0 = 0.04
"""Of the default index of refraction, 1.5; specular_color multiplies it."""


class Factors(NamedTuple):
    """The extension's factors, each from 0 to 1; tracks move them by these names."""

    diffuse: RGBA
    specular_f0: RGB
    glossiness: float


def with_factors(material: Material, factors: Factors) -> Material:
    """`material`, which has the maps, with the factors in place of its own; without the map of specular and glossiness
    it becomes a dielectric of metallic-roughness."""
    red, green, blue = (channel / DIELECTRIC_F0 for channel in factors.specular_f0)
    factored = replace(
        material, base_color=factors.diffuse, metallic=0.0, perceptual_roughness=1.0 - factors.glossiness,
        specular_color=(red, green, blue))
    return factored if factored.specular_glossiness_texture is not None else with_glossiness(factored)


def with_glossiness(material: Material, texel: Sequence[float] = WHITE) -> Material:
    """`material` whose map of specular and glossiness has the color `texel`, linear RGBA, everywhere: without a map.

    f0 = specular * texel RGB, roughness = 1 - glossiness * texel A, albedo = diffuse * (1 - max(f0)): appendix B of the
    extension.
    """
    red, green, blue = (c * t for c, t in zip(material.specular_color, texel[:3], strict=True))
    share = 1.0 - min(DIELECTRIC_F0 * max(red, green, blue), 1.0)
    r, g, b, alpha = material.base_color
    return replace(
        material, specular_glossiness_texture=None, specular_color=(red, green, blue),
        base_color=(r * share, g * share, b * share, alpha),
        perceptual_roughness=1.0 - (1.0 - material.perceptual_roughness) * texel[3])
