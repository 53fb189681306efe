"""How many lookups of the filtered environment stand for a lobe."""

from __future__ import annotations

from ..scene.material import ANISOTROPY, CLEARCOAT, Material
from ..settings import Settings

NARROW_ROUGHNESS = 0.06
"""Up to this perceptual roughness one lookup is the whole lobe: _NARROW_COLUMNS in viewer/bake/lookups.py."""


def lookups(material: Material, settings: Settings) -> int:
    """The number of isotropic lobes that stand for the lobe of the base under an environment.

    An anisotropic lobe has 2 alpha_t / alpha, rounded up to a power of 2. docs/choices.md has the error of each number.
    If a map varies the roughness, the ratio is not known and the number is 16. An isotropic lobe has 2, or 1 if it is
    narrow everywhere.
    """
    if not material.reflects:
        return 0
    if not ANISOTROPY.is_on(material):
        # Of glossiness a map makes less, so more of roughness. Smaller levels of normal maps are rougher.
        varies = material.specular_glossiness_texture is not None or material.normal_texture is not None
        return _of_isotropic(1.0 if varies else material.perceptual_roughness, settings)
    if material.metallic_roughness_texture is not None:
        return 16
    alpha = material.perceptual_roughness**2
    alpha_t = alpha + (1 - alpha) * material.anisotropy_strength**2
    return next((count for count in (4, 8, 16) if 2 * alpha_t <= count * alpha), 32)


def coat_lookups(material: Material, settings: Settings) -> int:
    """The number of isotropic lobes that stand for the lobe of a clear coat under an environment; 0 without a coat."""
    is_even = material.clearcoat_normal_texture is None
    return CLEARCOAT.is_on(material) * _of_isotropic(material.clearcoat_roughness if is_even else 1.0, settings)


def _of_isotropic(perceptual_roughness: float, settings: Settings) -> int:
    """1 or 2, by the largest roughness that there may be. Specular antialiasing widens the lobe."""
    return 1 if perceptual_roughness <= NARROW_ROUGHNESS and settings.specular_aa == "off" else 2
