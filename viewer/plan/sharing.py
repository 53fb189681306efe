"""Programs with more features than a draw needs. Unneeded inputs are neutral and change no pixel: white maps, black
lights.

They have two uses. In a scene with many different materials fewer programs are compiled if draws share them. The other
use is the setting `plan` = everything, which turns all features on to show what planning saves.

Some switches cannot be turned on for a draw that does not need them. They are the user's choices (the microfacet model,
the samples), the blending (ALPHA_MODE), the UV set of a map and its mirroring, the number of lookups of anisotropic
lobes, features that are not shareable (viewer/scene/material.py), and the fragment file (unlit.frag has no lights).
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from pathlib import PurePosixPath

from ..scene.light import KINDS, Light
from ..scene.scene import Scene
from ..scene.schema import MAPS, SWITCHED
from .model import GATHERED, NO_SUBSURFACE, Draw, Plan, Program
from .samplers import MAX_SAMPLERS, sampler_count

MIN_PROGRAMS_TO_SHARE = 5
"""Programs of one fragment file are shared only if there are at least so many."""

_SWITCHES = {
    "raster/unlit.frag": ("HAS_COLOR", "IS_POINTS"),
    "raster/phong.frag": ("HAS_COLOR", "IS_POINTS", "HAS_TANGENT", "DOUBLE_SIDED"),
    "raster/pbr.frag": ("HAS_COLOR", "IS_POINTS", "HAS_TANGENT", "DOUBLE_SIDED", "REFLECTS"),
}
"""The switches of each fragment file, beside those of the material, that may be on for a draw that does not need
them."""

_LOOKUPS = "LOOKUPS", "COAT_LOOKUPS"
"""Where one lookup suffices, two are halves of the same."""


def _model(fragment: str) -> str:
    """The shading model of a fragment file: unlit, phong or pbr."""
    return PurePosixPath(fragment).stem


def _maps(fragment: str) -> list[str]:
    """The maps that a fragment file may sample, as they are called in switches."""
    return [name.upper() for name, m in MAPS.items() if _model(fragment) in m.info.models]


def _sees_lamps_through(switches: Mapping[str, int]) -> bool:
    """Whether lamps are seen through a solid that scatters light (shaders/raster/sees_lamps_through.glsl)."""
    return bool(switches["SUBSURFACE"] not in (NO_SUBSURFACE, GATHERED) and switches["HAS_TRANSMISSION"]
                and switches["LIGHT_COUNT"])


def attributes_of(switches: Mapping[str, int]) -> tuple[str, ...]:
    """The vertex attributes that a program with these switches reads."""
    names = {"a_normal": switches["HAS_NORMAL"], "a_tangent": switches["HAS_TANGENT"], "a_color": switches["HAS_COLOR"],
             "a_indirect": switches["INDIRECT"], "a_interior": switches["SUBSURFACE"],
             "a_other_side": _sees_lamps_through(switches),
             "a_behind": switches["SUBSURFACE"] and switches["INDIRECT"],
             "a_uv0": switches["UV_SETS"] & 1, "a_uv1": switches["UV_SETS"] & 2}
    return ("a_position", *(name for name, is_read in names.items() if is_read))


def include_everything(plan: Plan, scene: Scene) -> Plan:
    """A plan for the same picture in which all features are compiled, and all textures, buffers and bakes are made."""
    lights, layers = list(plan.lights), list(plan.shadow_layers)
    for kind in KINDS:
        if not any(light.kind == kind for light in lights):
            behind = (k for k, light in enumerate(lights) if KINDS.index(light.kind) > KINDS.index(kind))
            at = next(behind, len(lights))
            # The light is outside the scene: at the position of a light the irradiance would be 0 times infinity.
            position = tuple((scene.center + 2 * scene.radius).tolist())
            lights.insert(at, Light(kind, intensity=0.0, position=position, name="black"))
            layers.insert(at, -1)
    layer_count = plan.shadow_layer_count
    if not layer_count:
        layers[-1], layer_count = 0, 1
    counts = {kind: sum(light.kind == kind for light in lights) for kind in KINDS}
    common = {"LIGHT_COUNT": len(lights), "DIRECTIONAL_COUNT": counts["directional"], "POINT_COUNT": counts["point"],
              "SUNS": 1, "SHADOW_LAYERS": layer_count, "HAS_ENVIRONMENT": 1, "ENVIRONMENT_ROTATED": 1}
    draws = tuple(_with_switches(draw, _all_on(draw.program, common)) for draw in plan.draws)
    ground = plan.ground and Program.of(plan.ground.fragment, {
        name: common.get(name, value) for name, value in plan.ground.switches})
    media, curves = plan.media, plan.curves
    if media is not None:
        media = replace(media, march=_with_counts(media.march, common), bake=_with_counts(media.bake, common),
                        glow=media.glow and _with_counts(media.glow, common),
                        depth=media.depth and _with_counts(media.depth, common))
    if curves is not None:
        curves = replace(curves, shade=tuple(_with_counts(program, common) for program in curves.shade))
    return replace(plan, draws=draws, ground=ground, media=media, curves=curves, lights=tuple(lights),
                   shadow_layers=tuple(layers), shadow_layer_count=layer_count, environment=True, reflections=True,
                   ambient=True, dfg=True, is_everything=True)


def _with_counts(program: Program, counts: Mapping[str, int]) -> Program:
    """A program that stays as it is but for black lights among those that it has, so that it finds the others."""
    names = ("LIGHT_COUNT", "DIRECTIONAL_COUNT", "POINT_COUNT") if program["LIGHT_COUNT"] else ()
    return Program.of(program.fragment, dict(program.switches) | {name: counts[name] for name in names})


def share_programs(draws: Sequence[Draw], always: bool = False) -> tuple[Draw, ...]:
    """The same draws, where the draws of a fragment file share as few programs as possible if that saves time.

    `always` shares programs in any case. With llvmpipe, compiling and first using a draw's own program takes 0.2 s of
    one core, and a shared one 0.45 s. Frames with shared programs take up to 10 % longer.
    """
    shared: dict[Program, dict[str, int]] = {}
    for fragment in dict.fromkeys(draw.program.fragment for draw in draws):
        programs = list(dict.fromkeys(draw.program for draw in draws if draw.program.fragment == fragment))
        if always or len(programs) >= MIN_PROGRAMS_TO_SHARE:
            groups = _grouped(programs, fragment)
            if always or len(programs) > 2 * len(groups):
                shared |= {program: switches for switches, members in groups for program in members}
    return tuple(_with_switches(draw, shared[draw.program]) if draw.program in shared else draw for draw in draws)


def _grouped(programs: Sequence[Program], fragment: str) -> list[tuple[dict[str, int], list[Program]]]:
    """Groups of programs that one program can replace: its switches, and the programs of the group."""
    groups: list[tuple[dict[str, int], list[Program]]] = []
    for program in programs:
        switches = dict(program.switches)
        for k, (group, members) in enumerate(groups):
            both = _union(group, switches, fragment)
            if both is not None:
                groups[k] = both, [*members, program]
                break
        else:
            groups.append((switches, [program]))
    return groups


def _all_on(program: Program, common: Mapping[str, int]) -> dict[str, int]:
    """The program's switches with all features on that may be, and as many maps as there are free samplers."""
    switches, fragment = dict(program.switches), program.fragment
    switches |= {name: 1 for name in _combinations(fragment) if name in switches} | {"UV_SETS": 3}
    more: list[dict[str, int]] = []
    if fragment != "raster/unlit.frag":
        more += [{name: value} for name, value in common.items()]
    if fragment == "raster/pbr.frag":
        switches |= {"METALNESS": 2} | {name: max(switches[name], 2) for name in _LOOKUPS}
        if not switches["TRACED_REFLECTION"]:  # transmissive surfaces trace no reflections
            more += [{"HAS_TRANSMISSION": 1}]
    more += [{f"{name}_MAP": 1, f"{name}_TRANSFORM": 1} for name in _maps(fragment)]
    for extra in more:
        if sampler_count(switches | extra) <= max(MAX_SAMPLERS, sampler_count(switches)):
            switches |= extra
    return switches


def _combinations(fragment: str) -> dict[str, Callable[[int, int], int]]:
    """The switches that may be on without need, each with the function that combines the values of two programs."""
    features = [f.switch for f in SWITCHED if f.is_shareable and _model(fragment) in f.models]
    return dict.fromkeys((*_SWITCHES[fragment], *features), max) | {"UV_SETS": int.__or__}


def _union(a: Mapping[str, int], b: Mapping[str, int], fragment: str) -> dict[str, int] | None:
    """The switches of a program that can replace two programs of the same fragment file; None if no program can."""
    combinations = _combinations(fragment)
    both = dict(a)
    for name in _maps(fragment):
        switch, fixed = f"{name}_MAP", (f"{name}_UV", f"{name}_MIRROR")
        if a[switch] and b[switch] and any(a[other] != b[other] for other in fixed):
            return None
        both |= {other: (a if a[switch] else b)[other] for other in fixed}
        combinations |= {switch: max, f"{name}_TRANSFORM": max}
    for name, value in b.items():
        if name in combinations:
            both[name] = combinations[name](a[name], value)
        elif name == "METALNESS" and a[name] != value:
            both[name] = 2
        elif name in _LOOKUPS and max(a[name], value) <= 2:
            both[name] = max(a[name], value)
        elif both[name] != value and not name.endswith(("_UV", "_MIRROR")):
            return None
    return both if sampler_count(both) <= MAX_SAMPLERS else None


def _with_switches(draw: Draw, switches: Mapping[str, int]) -> Draw:
    """The draw by a program with these switches; maps that its material does not have become blank maps."""
    program = replace(draw.program, switches=tuple(sorted(switches.items())))
    names = (name.lower() for name in _maps(program.fragment) if switches[f"{name}_MAP"])
    return replace(draw, program=program, attributes=attributes_of(switches),
                   blank_maps=tuple(name for name in names if name not in draw.maps))
