"""The kinds of glass that a scene has, as switches of shaders/bsdf/glass.glsl and shaders/trace/glass.frag."""

from __future__ import annotations

from collections.abc import Iterable

from ...material.pack import DATA_ROLES
from ...scene.material import SPECULAR_TINT
from .materials import TraceMaterial


def glass_switches(materials: Iterable[TraceMaterial]) -> dict[str, int]:
    """Switches for solid glass, for thin glass, for rough glass, for a mixture with an opaque part, and for a modified
    specular interface."""
    glass = [m for m in materials if m.transmits and not m.is_boundary]
    return {
        "HAS_SOLID_GLASS": int(any(not m.is_thin for m in glass)),
        "HAS_THIN_GLASS": int(any(m.is_thin for m in glass)),
        "HAS_ROUGH_GLASS": int(any(m.material.perceptual_roughness > 0 for m in glass)),
        "HAS_PARTLY_GLASS": int(any(_is_partly_glass(m) for m in glass)),
        "HAS_SPECULAR_GLASS": int(any(_has_own_interface(m) for m in glass)),
    }


def _is_partly_glass(m: TraceMaterial) -> bool:
    varies = any(use.roles & DATA_ROLES["transmission"] for use in m.data_maps)
    return varies or m.material.transmission < 1 or m.material.metallic > 0 or m.material.scatters_thinly


def _has_own_interface(m: TraceMaterial) -> bool:
    varies = any(use.roles & DATA_ROLES["specular"] for use in m.data_maps)
    return varies or m.material.specular != 1 or SPECULAR_TINT.is_on(m.material)
