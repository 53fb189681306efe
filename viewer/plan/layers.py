"""Plans the pass that finds what surface each pixel shows, as numbers: layers for other programs (docs/layers.md)."""

from __future__ import annotations

from collections.abc import Collection, Mapping
from dataclasses import replace

from ..scene.scene import Scene
from ..scene.schema import MAP_SWITCHES, MAPS, no_switches
from ..settings import Settings
from .bsdf_switches import bsdf_switches
from .curves import has_colors
from .instances import instances_of, placed
from .model import Draw, Plan, Program
from .planner import plan_scene
from .sharing import attributes_of

VERTEX, FRAGMENT = "raster/layers.vert", "raster/layers.frag"
OUTPUTS = {"OUT_NORMAL": {"normal"}, "OUT_IDS": {"instance", "material"}, "OUT_ALBEDO": {"albedo"},
           "OUT_UV": {"uv", "motion"}}
"""The outputs of shaders/raster/layers.frag beside the position, and the layers that need them."""
_NO_FEATURES = dict.fromkeys((*no_switches(), *bsdf_switches(Settings()), "REFLECTS", "METALNESS", "INDIRECT", "MEDIA",
                              "SUBSURFACE", "HALF_TARGET"), 0)
"""What unlit programs lack, and what counts for nothing but albedo."""
_GEOMETRY = ("ALPHA_MODE", "DOUBLE_SIDED", "HAS_COLOR", "HAS_NORMAL", "IS_POINTS", "SAMPLES", "UV_SETS",
             "IS_ORTHOGRAPHIC")


def places(names: Collection[str]) -> dict[str, int]:
    """The place of each output among the targets, 0: not wanted. The position has place 0."""
    wanted = [output for output, layers in OUTPUTS.items() if layers & set(names)]
    return {output: wanted.index(output) + 1 if output in wanted else 0 for output in OUTPUTS}


def plan_layers(scene: Scene, settings: Settings, names: Collection[str], orthographic: bool) -> Plan:
    """The plan of the pass: a draw of each instance, without light, and the programs of curves.

    It is the same in all modes, but that mode path shows neither lines nor points. Raises as `plan_scene`.
    """
    plain = replace(settings, mode="pbr", lobes="all", plan="needed", show="shaded", fog=0.0, subsurface="off",
                    indirect="off", environment_shadows="off", ambient_occlusion="off", reflections="environment",
                    refraction="screen", specular_aa="off", hair_scattering="single", caustics="off")
    plan = plan_scene(scene.relit(environment=None, volumes=()), plain, (), samples=1, half_target=False,
                      orthographic=orthographic)
    outputs = places(names) | {"HAS_UV": int("uv" in names), "HAS_MOTION": int("motion" in names)}
    alike = {draw.mesh: _layer_draw(draw, scene, outputs, orthographic) for draw in plan.kinds}
    instances = {mesh: numbers for mesh, numbers in instances_of(scene).items()
                 if settings.mode != "path" or scene.meshes[mesh].topology == "triangles"}
    draws = placed(alike, instances)
    curves = plan.curves and replace(plan.curves, shade=tuple(Program.of("raster/curve_layers.frag", outputs | {
        **dict(plan.curves.depth.switches), "HAS_COLORS": int(has_colors(curves, settings)),
        "IS_ORTHOGRAPHIC": int(orthographic)}) for curves in scene.curves))
    return replace(plan, draws=draws, curves=curves)


def _layer_draw(draw: Draw, scene: Scene, outputs: Mapping[str, int], orthographic: bool) -> Draw:
    program = _program(draw, scene, outputs, orthographic)
    maps, blank = (tuple(name for name in given if program[f"{name.upper()}_MAP"])
                   for given in (draw.maps, draw.blank_maps))
    switches = dict(program.switches)
    return replace(draw, program=program, maps=maps, blank_maps=blank, attributes=attributes_of(switches))


def _program(draw: Draw, scene: Scene, outputs: Mapping[str, int], orthographic: bool) -> Program:
    mesh, material, planned = scene.meshes[draw.mesh], scene.materials[draw.material], dict(draw.program.switches)
    is_lit = bool(planned["HAS_NORMAL"])
    planned = _NO_FEATURES | planned | {
        "HAS_NORMAL": int(mesh.normals is not None), "IS_ORTHOGRAPHIC": int(orthographic),
        "DOUBLE_SIDED": int(material.double_sided)}
    if outputs["OUT_ALBEDO"]:
        switches = planned
    else:  # many materials share a program then
        kept = [*["normal"] * bool(outputs["OUT_NORMAL"]), *["base_color"] * bool(planned["ALPHA_MODE"])]
        names = (*_GEOMETRY, *(f"{name.upper()}_{ending}" for name in kept for ending in MAP_SWITCHES))
        switches = _NO_FEATURES | {name: planned[name] for name in names}
        switches["HAS_TANGENT"] = switches["NORMAL_MAP"]
    texture = material.base_color_texture
    uv = texture.uv_set if texture is not None else 0
    has_uv = outputs["HAS_UV"] and uv < len(mesh.uvs)
    read = {switches[f"{name.upper()}_UV"] for name in MAPS if switches[f"{name.upper()}_MAP"]}
    read |= {uv} if has_uv else set()
    return Program.of(FRAGMENT, switches | dict(outputs) | {
        # What moves has a place at the next time, too, which is more than there are attributes for.
        "INSTANCED": draw.program["INSTANCED"] * (1 - outputs["HAS_MOTION"]),
        "IS_LIT": int(is_lit and outputs["OUT_ALBEDO"] > 0), "UV_SET": uv if has_uv else -1,
        "UV_SETS": sum(1 << k for k in read)})
