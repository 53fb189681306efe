"""Counts the textures that a program of the raster samples. OpenGL 3.3 guarantees 16 per fragment shader, and macOS has
no more."""

from __future__ import annotations

from collections.abc import Mapping

from ..scene.schema import MAP_SWITCHES, MAPS
from .map_switches import ALPHA_MODES
from .model import ALONE, SPREAD

MAX_SAMPLERS = 16
_OPTIONAL = ("TRACED_REFRACTION", "TRACED_REFLECTION", "VISIBILITY")
"""Switches that need samplers and may be turned off, in the order in which they are turned off."""


def sampler_count(switches: Mapping[str, int]) -> int:
    """The number of samplers of a program with these switches: those of its maps, of tables and of earlier passes."""
    on = {name: int(switches.get(name, 0) > 0) for name in (
        "REFLECTS", "HAS_ENVIRONMENT", "SHADOW_LAYERS", "HAS_TRANSMISSION", "MEDIA", "VOLUMES", "LIGHT_COUNT",
        "WOVEN", *_OPTIONAL)}
    is_pbr, is_lit = int("REFLECTS" in switches), int("LIGHT_COUNT" in switches)
    tables = on["REFLECTS"] + is_pbr * on["HAS_ENVIRONMENT"] * (1 + on["REFLECTS"]) + on["SHADOW_LAYERS"]
    has_gaps = on["WOVEN"] and switches["ALPHA_MODE"] == ALPHA_MODES.index("blend")
    passes = on["HAS_TRANSMISSION"] + 2 * on["TRACED_REFLECTION"] + 3 * on["TRACED_REFRACTION"]
    passes += max(2 * on["VISIBILITY"], has_gaps)
    passes += 2 * (switches.get("SUBSURFACE") == SPREAD)
    tables += on["WOVEN"] + switches.get("GROOVED", 0)
    passes += 2 * switches.get("DEFERRED", 0)
    passes += on["MEDIA"] * (1 + is_lit) + on["VOLUMES"] * on["LIGHT_COUNT"]
    return sum(switches[f"{name.upper()}_MAP"] for name in MAPS) + tables + passes


def within_limit(switches: Mapping[str, int]) -> dict[str, int]:
    """The switches, with optional ones turned off until the program needs at most MAX_SAMPLERS samplers, and then maps
    from the last in the declaration of materials on: extensions before what glTF 2.0 itself has."""
    reduced = dict(switches)
    if reduced.get("SUBSURFACE") == SPREAD and sampler_count(reduced) > MAX_SAMPLERS:
        reduced["SUBSURFACE"] = ALONE
    for name in _OPTIONAL:
        if reduced.get(name) and sampler_count(reduced) > MAX_SAMPLERS:
            reduced[name] = 0
    for name in reversed(MAPS):
        if reduced[f"{name.upper()}_MAP"] and sampler_count(reduced) > MAX_SAMPLERS:
            reduced |= {f"{name.upper()}_{ending}": 0 for ending in MAP_SWITCHES}
    return reduced
