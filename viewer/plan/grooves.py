"""Surfaces whose normal maps are full of grooves, which stretch their lobes (shaders/bsdf/grooves.glsl)."""

from __future__ import annotations

from ..scene.material import ANISOTROPY
from .samplers import MAX_SAMPLERS, sampler_count

GROOVE_LOOKUPS = 16
"""Of the lobe of a normal map with grooves, whose stretching varies from pixel to pixel."""


def with_grooves(switches: dict[str, int]) -> dict[str, int]:
    """The switches of a surface whose normal map has grooves, if there is a sampler left for how they spread."""
    stretched = switches | {"GROOVED": 1, ANISOTROPY.switch: 1}
    if switches["LOOKUPS"]:
        stretched["LOOKUPS"] = max(GROOVE_LOOKUPS, switches["LOOKUPS"])
    return stretched if sampler_count(stretched) <= MAX_SAMPLERS else switches
