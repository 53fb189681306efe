"""Materials of KHR_materials_pbrSpecularGlossiness as materials of metallic-roughness: dielectrics with a coloured f0.

The map of specular and glossiness is the only thing that metallic-roughness cannot say; shaders convert its texels as
`with_glossiness` does (shaders/bsdf/specular_glossiness.glsl).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from .material import Material
from .parameter import WHITE

DIELECTRIC_F0 = 0.04
"""Of the default index of refraction, 1.5; specular_color multiplies it."""


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
