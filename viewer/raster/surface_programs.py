"""The programs that draw a surface in other passes than the one that shades it, as they follow from the plan."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from ..plan.layers import FRAGMENT as LAYER_FRAGMENT
from ..plan.layers import VERTEX as LAYER_VERTEX
from ..plan.model import GATHERED, Draw, Program
from ..scene.schema import MAP_SWITCHES, no_switches

VERTEX, SHADOW_VERTEX = "raster/surface.vert", "raster/shadow.vert"
FULLSCREEN = "display/fullscreen.vert"
TINT_MAPS = "base_color", "metallic_roughness", "transmission"
"""The maps that decide how much light glass lets through."""
TRIANGLES = Program("raster/triangles.frag", ())
_GBUFFER_SWITCHES = ("ALPHA_MODE", "DOUBLE_SIDED", "HALF_TARGET", "HAS_COLOR", "HAS_NORMAL", "INSTANCED",
                     "IS_POINTS", "SAMPLES", "UV_SETS")


def vertex_of(fragment: str, switches: Mapping[str, int]) -> str:
    """The vertex shader that goes with the fragment shader of a surface."""
    if fragment == LAYER_FRAGMENT:
        return LAYER_VERTEX
    if fragment == TRIANGLES.fragment:
        return "raster/triangles.vert"
    return FULLSCREEN if switches.get("DEFERRED") else VERTEX


def gbuffer_program(program: Program) -> Program:
    return Program("raster/gbuffer.frag", _geometry_switches(program))


def path_program(program: Program, has_bands: bool) -> Program:
    """Of the first rays through solid glass. `has_bands`: red, green and blue take rays of their own."""
    switches = {**dict(_geometry_switches(program)), "IS_ORTHOGRAPHIC": program["IS_ORTHOGRAPHIC"],
                "DISPERSIVE": program["DISPERSIVE"], "BANDS": int(has_bands)}
    return Program.of("raster/refraction_rays.frag", switches)


def gathering_program(program: Program) -> Program:
    """Of the light that a solid scatters inside, without what its surface reflects and what it wears."""
    off = dict.fromkeys(("SHOW_SPECULAR", "SHOW_MULTISCATTER", "SHOW_EMISSION", "CLEARCOAT", "COAT_LOOKUPS", "SHEEN",
                         "TRACED_REFRACTION", "TRACED_REFLECTION", "DISPERSIVE", "HALF_TARGET"), 0)
    switches = dict(program.switches)
    switches |= {name: value for name, value in off.items() if name in switches}
    switches["LOOKUPS"] = min(switches["LOOKUPS"], 1)
    return Program.of(program.fragment, switches | {"SAMPLES": 1, "SUBSURFACE": GATHERED})


def shadow_program(draw: Draw) -> Program:
    """Of a shadow map, with SHADOW_VERTEX; it reads alpha where the surface is not opaque, and what panes transmit."""
    maps = shadow_maps_of(draw)
    names = ["ALPHA_MODE", "HAS_COLOR"] * bool(maps) + _map_switches(maps)
    of_pane = dict.fromkeys(("PANE", "HAS_NORMAL", "HAS_TRANSMISSION"), int(draw.is_pane))
    switches = no_switches() | dict.fromkeys(("ALPHA_MODE", "HAS_COLOR"), 0) | of_pane | {
        name: draw.program[name] for name in ("INSTANCED", *names)}
    switches["UV_SETS"] = _uv_sets(switches, maps)
    return Program.of("raster/shadow.frag", switches)


def tint_program(draw: Draw) -> Program:
    """Of what the light of the environment keeps on its way through glass, with SHADOW_VERTEX."""
    switches = no_switches() | {"PANE": 1, "HAS_NORMAL": 1, "HAS_TRANSMISSION": 1, "INSTANCED": 0} | {
        name: draw.program[name] for name in ("ALPHA_MODE", "HAS_COLOR", "IS_SOLID", *_map_switches(TINT_MAPS))}
    switches["UV_SETS"] = _uv_sets(switches, TINT_MAPS)
    return Program.of("raster/sky_tint.frag", switches)


def shadow_maps_of(draw: Draw) -> tuple[str, ...]:
    """The maps that decide how much light passes the surface, if it has them."""
    if draw.is_pane:
        return TINT_MAPS
    return () if draw.alpha_mode == "opaque" else ("base_color",)


def _map_switches(maps: Sequence[str]) -> list[str]:
    return [f"{name.upper()}_{ending}" for name in maps for ending in MAP_SWITCHES]


def _uv_sets(switches: Mapping[str, int], maps: Sequence[str]) -> int:
    return sum({1 << switches[f"{name.upper()}_UV"] for name in maps if switches[f"{name.upper()}_MAP"]})


def _geometry_switches(program: Program) -> tuple[tuple[str, int], ...]:
    """The switches that position, normal and roughness depend on. With only these, many materials share one program."""
    switches = dict(program.switches)
    maps = {"normal", "metallic_roughness"} | ({"base_color"} if switches["ALPHA_MODE"] else set())
    fixed = {"INDIRECT": 0, "MEDIA": 0, "SUBSURFACE": 0, "HAS_TANGENT": switches["NORMAL_MAP"]}
    if switches["SPECULAR_GLOSSINESS"]:
        maps.add("specular_glossiness")
        fixed["SPECULAR_GLOSSINESS"] = 1
    switches = no_switches() | {name: switches[name] for name in _GBUFFER_SWITCHES} | fixed | {
        f"{name.upper()}_{ending}": switches[f"{name.upper()}_{ending}"] for name in maps for ending in MAP_SWITCHES}
    return tuple(sorted(switches.items()))
