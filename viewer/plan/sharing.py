"""Programs that can do more than a draw needs, and are fed with what changes no pixel: white maps, black lights.

Two have a use for them: the plan that leaves nothing out, which shows what leaving out saves, and a scene whose
materials would need more programs than are worth compiling.

Some switches are no feature to be had and not used, and stay: what the user chose (the microfacet model, the samples),
how a surface is composed (ALPHA_MODE), which UV set a map reads and whether it is mirrored, METALNESS 1 (a pure metal
looks the environment up once, a mixture twice), the features that are not shareable (viewer/scene/material.py), and the
fragment file: unlit code knows no light.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from pathlib import PurePosixPath

from ..scene.light import Light
from ..scene.scene import Scene
from ..scene.schema import MAPS, SWITCHED
from .model import Draw, Plan, Program
from .samplers import MAX_SAMPLERS, sampler_count

OWN_PROGRAMS = 4
"""Of one fragment file: so many are never shared."""

_SWITCHES = {
    "raster/unlit.frag": ("HAS_COLOR", "IS_POINTS"),
    "raster/phong.frag": ("HAS_COLOR", "IS_POINTS", "HAS_TANGENT", "DOUBLE_SIDED"),
    "raster/pbr.frag": ("HAS_COLOR", "IS_POINTS", "HAS_TANGENT", "DOUBLE_SIDED", "REFLECTS"),
}
"""Those of each fragment file, beside the material's, that may be on for a draw that has no need of it."""


def _model(fragment: str) -> str:
    """The model of shading in a fragment file: unlit, phong or pbr."""
    return PurePosixPath(fragment).stem


def _maps(fragment: str) -> list[str]:
    """The maps that a fragment file knows, as they are called in switches."""
    return [name.upper() for name, m in MAPS.items() if _model(fragment) in m.info.models]


def attributes_of(switches: Mapping[str, int]) -> tuple[str, ...]:
    """What a program with these switches reads of each vertex."""
    names = {"a_normal": switches["HAS_NORMAL"], "a_tangent": switches["HAS_TANGENT"], "a_color": switches["HAS_COLOR"],
             "a_indirect": switches["INDIRECT"], "a_uv0": switches["UV_SETS"] & 1, "a_uv1": switches["UV_SETS"] & 2}
    return ("a_position", *(name for name, is_read in names.items() if is_read))


def leave_nothing_out(plan: Plan, scene: Scene) -> Plan:
    """The plan that draws the same pixels with every feature compiled in and every texture, buffer and bake made."""
    lights, layers = list(plan.lights), list(plan.shadow_layers)
    for kind in ("directional", "point", "spot"):
        if not any(light.kind == kind for light in lights):
            behind = (k for k, light in enumerate(lights) if _ORDER.index(light.kind) > _ORDER.index(kind))
            at = next(behind, len(lights))
            # Outside the scene: at a point of it the light would be 0 times infinity.
            place = tuple((scene.center + 2 * scene.radius).tolist())
            lights.insert(at, Light(kind, intensity=0.0, position=place, name="black"))
            layers.insert(at, -1)
    layer_count = plan.shadow_layer_count
    if not layer_count:
        layers[-1], layer_count = 0, 1
    counts = {kind: sum(light.kind == kind for light in lights) for kind in _ORDER}
    common = {"LIGHT_COUNT": len(lights), "DIRECTIONAL_COUNT": counts["directional"], "POINT_COUNT": counts["point"],
              "SUNS": 1, "SHADOW_LAYERS": layer_count, "HAS_ENVIRONMENT": 1, "ENVIRONMENT_ROTATED": 1}
    draws = tuple(_widened(draw, _full(draw.program, common)) for draw in plan.draws)
    return replace(plan, draws=draws, lights=tuple(lights), shadow_layers=tuple(layers), shadow_layer_count=layer_count,
                   environment=True, reflections=True, ambient=True, dfg=True, is_everything=True)


def share_programs(draws: Sequence[Draw], always: bool = False) -> tuple[Draw, ...]:
    """The same draws; those of a fragment file in as few programs as can do the same, `always` or if that saves time.

    On llvmpipe a program of a draw's own takes 0.2 s of a processor until it has drawn, a shared one 0.45 s; frames
    then take up to 10 % longer.
    """
    wide: dict[Program, dict[str, int]] = {}
    for fragment in dict.fromkeys(draw.program.fragment for draw in draws):
        programs = list(dict.fromkeys(draw.program for draw in draws if draw.program.fragment == fragment))
        if always or len(programs) > OWN_PROGRAMS:
            groups = _grouped(programs, fragment)
            if always or len(programs) > 2 * len(groups):
                wide |= {program: switches for switches, members in groups for program in members}
    return tuple(_widened(draw, wide[draw.program]) if draw.program in wide else draw for draw in draws)


def _grouped(programs: Sequence[Program], fragment: str) -> list[tuple[dict[str, int], list[Program]]]:
    """The switches of programs that can do what those given can, each with these."""
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


_ORDER = ("directional", "point", "spot")


def _full(program: Program, common: Mapping[str, int]) -> dict[str, int]:
    """The program's switches with every feature on that can be, and as many maps as there are samplers left."""
    switches, fragment = dict(program.switches), program.fragment
    switches |= {name: 1 for name in _free(fragment) if name in switches} | {"UV_SETS": 3}
    if fragment != "raster/unlit.frag":
        switches |= common
    if fragment == "raster/pbr.frag" and switches["METALNESS"] != 1:  # no surface transmits and is traced as a mirror
        switches |= {"METALNESS": 2,
                     "HAS_TRANSMISSION": max(switches["HAS_TRANSMISSION"], 1 - switches["TRACED_REFLECTION"])}
    for name in _maps(fragment):
        more = switches | {f"{name}_MAP": 1, f"{name}_TRANSFORM": 1}
        if switches[f"{name}_MAP"] or sampler_count(more) <= MAX_SAMPLERS:
            switches = more
    return switches


def _free(fragment: str) -> dict[str, Callable[[int, int], int]]:
    """Switches that may be raised, each with what two programs' values make together."""
    features = [f.switch for f in SWITCHED if f.is_shareable and _model(fragment) in f.models]
    return dict.fromkeys((*_SWITCHES[fragment], *features), max) | {"UV_SETS": int.__or__}


def _union(a: Mapping[str, int], b: Mapping[str, int], fragment: str) -> dict[str, int] | None:
    """The switches of a program that can do what two of the same fragment file do; None where there is none."""
    free = _free(fragment)
    both = dict(a)
    for name in _maps(fragment):
        switch, words = f"{name}_MAP", (f"{name}_UV", f"{name}_MIRROR")
        if a[switch] and b[switch] and any(a[word] != b[word] for word in words):
            return None
        both |= {word: (a if a[switch] else b)[word] for word in words}
        free |= {switch: max, f"{name}_TRANSFORM": max}
    for name, value in b.items():
        if name in free:
            both[name] = free[name](a[name], value)
        elif name == "METALNESS" and {a[name], value} == {0, 2}:
            both[name] = 2
        elif both[name] != value and not name.endswith(("_UV", "_MIRROR")):
            return None
    return both if sampler_count(both) <= MAX_SAMPLERS else None


def _widened(draw: Draw, switches: Mapping[str, int]) -> Draw:
    program = replace(draw.program, switches=tuple(sorted(switches.items())))
    names = (name.lower() for name in _maps(program.fragment) if switches[f"{name}_MAP"])
    return replace(draw, program=program, attributes=attributes_of(switches),
                   blank_maps=tuple(name for name in names if name not in draw.maps))
