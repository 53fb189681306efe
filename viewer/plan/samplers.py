"""How many textures a program of the raster samples: OpenGL 3.3 grants a fragment shader 16, and macOS no more."""

from __future__ import annotations

from collections.abc import Mapping

from ..scene.schema import MAPS

MAX_SAMPLERS = 16
_OPTIONAL = ("TRACED_REFRACTION", "TRACED_REFLECTION", "VISIBILITY")
"""Switches that bring samplers and can be off, in the order in which a program does without them."""


def sampler_count(switches: Mapping[str, int]) -> int:
    """The samplers of a program with these switches: its maps, and those of shaders/raster and shaders/light."""
    on = {name: int(switches.get(name, 0) > 0) for name in (
        "REFLECTS", "HAS_ENVIRONMENT", "SHADOW_LAYERS", "HAS_TRANSMISSION", *_OPTIONAL)}
    is_pbr = int("REFLECTS" in switches)
    tables = on["REFLECTS"] + is_pbr * on["HAS_ENVIRONMENT"] * (1 + on["REFLECTS"]) + on["SHADOW_LAYERS"]
    passes = on["HAS_TRANSMISSION"] + 2 * on["VISIBILITY"] + 2 * on["TRACED_REFLECTION"] + 3 * on["TRACED_REFRACTION"]
    return sum(switches[f"{name.upper()}_MAP"] for name in MAPS) + tables + passes


def within_limit(switches: Mapping[str, int]) -> dict[str, int]:
    """The switches without those that would bring more samplers than there may be."""
    kept = dict(switches)
    for name in _OPTIONAL:
        if sampler_count(kept) > MAX_SAMPLERS and kept.get(name):
            kept[name] = 0
    return kept
