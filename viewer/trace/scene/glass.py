"""The kinds of glass that a scene has, as switches of shaders/bsdf/glass.glsl and shaders/trace/glass.frag."""

from __future__ import annotations

from collections.abc import Iterable

from ...material.pack import COLOR_ROLES, DATA_ROLES
from .materials import TraceMaterial


def glass_switches(materials: Iterable[TraceMaterial]) -> dict[str, int]:
    """Switches for solid glass, for thin glass, for a mixture with an opaque part, and for a modified specular
    interface."""
    glass = [m for m in materials if m.transmission > 0]
    return {
        "HAS_SOLID_GLASS": int(any(not m.is_thin for m in glass)),
        "HAS_THIN_GLASS": int(any(m.is_thin for m in glass)),
        "HAS_PARTLY_GLASS": int(any(_is_partly_glass(m) for m in glass)),
        "HAS_SPECULAR_GLASS": int(any(_has_own_interface(m) for m in glass)),
    }


def _is_partly_glass(m: TraceMaterial) -> bool:
    # An index of 0 means that all light is reflected (KHR_materials_ior).
    varies = any(use.roles & DATA_ROLES["transmission"] for use in m.data_maps)
    return varies or m.transmission < 1 or m.material.metallic > 0 or m.material.ior < 1


def _has_own_interface(m: TraceMaterial) -> bool:
    plain = m.material.specular == 1 and m.material.specular_color == (1.0, 1.0, 1.0)
    return not plain or any(use.roles & COLOR_ROLES["specular_color"] for use in m.color_maps) \
        or any(use.roles & DATA_ROLES["specular"] for use in m.data_maps)
