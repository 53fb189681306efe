"""Generates the GLSL code that reads a material, shaders/material/*.glsl, from the declaration of materials.

`python -m viewer.material` writes the files. A test checks that they are up to date.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from itertools import groupby
from textwrap import fill

from ..scene.schema import MAPS, PARAMETERS, SWITCHED, Map, Parameter, multiplied_by
from .pack import COLOR_ROLES, DATA_ROLES, MAPS_TEXEL, RECORD, RECORD_TEXELS

_TYPES = {1: "float", 2: "vec2", 3: "vec3", 4: "vec4"}
_HEAD = "// Written by `python -m viewer.material` from viewer/scene/material.py; change it there.\n"


def files() -> dict[str, str]:
    """The name and the text of each file of shaders/material."""
    return {"inputs.glsl": _HEAD + _inputs(), "uniforms.glsl": _HEAD + _uniforms(), "records.glsl": _HEAD + _records()}


def _inputs() -> str:
    members = [p for p in PARAMETERS.values() if p.info.role == "input"]
    lines = [f"    {_type(p)} {p.name};{' ' * max(30 - len(_type(p)) - len(p.name), 1)}// {p.info.meaning}"
             for p in members]
    raw_maps = [m for m in MAPS.values() if m.info.raw_channels]
    lines += [f"    {_TYPES[len(m.info.raw_channels)]} {m.name}_texel; // channels {m.info.raw_channels} of the map"
              for m in raw_maps]
    defaults = ", ".join([*map(_literal, members), *map(_neutral, raw_maps)])
    return "\n".join([
        "// A material's parameters at one point of a surface, multiplied by its maps and vertex colours.",
        "struct MaterialInputs {", *lines, "};", "",
        "const MaterialInputs DEFAULT_INPUTS = MaterialInputs(",
        *fill(f"{defaults});", 110, initial_indent="    ", subsequent_indent="    ").splitlines(), ""])


def _uniforms() -> str:
    """The raster's file: a uniform for each parameter, and a sampler for each map that the program's switches name."""
    lines = ["// Reads a material for the raster, from uniforms and samplers (raster/attributes.glsl).",
             '#include "material/inputs.glsl"', '#include "raster/attributes.glsl"', *_includes(), ""]
    shown = [p for p in PARAMETERS.values() if p.info.role != "python"]
    lines += _guarded(shown, "uniform {type} u_{name};")
    for source in MAPS.values():
        name, macro = source.name, source.name.upper()
        lines += ["", f"#if {macro}_MAP", f"uniform sampler2D u_{name}_map;", f"uniform mat3x2 u_{name}_transform;",
                  f"vec4 {name}_texel() {{",
                  f"    return map_texel(u_{name}_map, {macro}_UV, {macro}_TRANSFORM,",
                  f"        u_{name}_transform, {macro}_MIRROR);", "}", "#endif"]
    lines += ["", "MaterialInputs read_inputs() {", "    MaterialInputs m = DEFAULT_INPUTS;"]
    lines += _guarded([p for p in shown if p.info.role == "input"], "    m.{name} = u_{name};")
    for source in MAPS.values():
        products = ["        " + line for line in _products(source)]
        if products:
            # A program that several materials share may have the map but not the feature.
            switch = f" && {source.info.feature.switch}" if source.info.is_applied else ""
            lines += [f"#if {source.name.upper()}_MAP{switch}", "    {", f"        vec4 texel = {source.name}_texel();",
                      *products, "    }", "#endif"]
    lines += ["#if HAS_COLOR", "    m.base_color *= v_color;", "#endif", *_applied_last(), "    return m;", "}", ""]
    return "\n".join(lines)


def _records() -> str:
    """The path tracer's file: parameters come from the scene buffer, maps from two atlases of textures."""
    lines = ["// Reads a material for the path tracer, from the scene buffer (viewer/material/pack.py).",
             '#include "material/inputs.glsl"', '#include "trace/scene_buffer.glsl"', "#if HAS_TEXTURES",
             '#include "trace/atlas.glsl"', "#endif", *_includes(), "", "uniform int u_materials;", ""]
    for roles in (COLOR_ROLES, DATA_ROLES):
        listed = ", ".join(f"{name.upper()}_ROLE = {bit}u" for name, bit in roles.items())
        lines += [f"const uint {listed};"]
    lines += ["", "int material_texel(int material, int part) {",
              f"    return u_materials + material * {RECORD_TEXELS} + part;", "}", ""]
    for name, place in RECORD.items():
        lines += [f"{_TYPES[place.size]} {name}_factor(int material) {{",
                  f"    return scene_float4(material_texel(material, {place.texel})).{place.swizzle};", "}", ""]
    lines += ["// The records of the material's maps: x colour maps and y data maps, as index of the first record |",
              "// number of records << 24; z that of the normal map + 1, w that of the coat's normal map + 1, or 0",
              "uvec4 map_records(int material) {",
              f"    return scene_uint4(material_texel(material, {MAPS_TEXEL}));", "}", "",
              "// `color` is the interpolated vertex colour.",
              "MaterialInputs read_inputs(int material, vec4 color, vec2 uv0, vec2 uv1) {",
              "    MaterialInputs m = DEFAULT_INPUTS;"]
    shown = [p for p in PARAMETERS.values() if p.info.role == "input" and p.info.path_traced]
    lines += _guarded(shown, "    m.{name} = {name}_factor(material);", has_unlit=False)
    lines.append("    m.base_color *= color;")
    lines += ["#if HAS_TEXTURES", "    uvec4 maps = map_records(material);", "#endif"]
    for kind, roles, run in (("color", COLOR_ROLES, "x"), ("data", DATA_ROLES, "y")):
        lines += [f"#if HAS_{kind.upper()}_MAPS",
                  f"    int {kind}_map = int(maps.{run} & 0xffffffu);",
                  f"    int {kind}_end = {kind}_map + int(maps.{run} >> 24);",
                  # llvmpipe runs the body of a loop once more if its condition comes first.
                  f"    if ({kind}_map < {kind}_end) do {{",
                  f"        TextureMap map = texture_map({kind}_map, uv0, uv1);",
                  f"        vec4 texel = sample_atlas(u_{kind}_atlas, map);"]
        for name in roles:
            products = ["            " + line for line in _products(MAPS[name])]
            branch = [f"        if (has_role(map, {name.upper()}_ROLE)) {{", *products, "        }"]
            switch = MAPS[name].info.feature.switch
            lines += [f"#if {switch}", *branch, "#endif"] if switch else branch
        lines += [f"    }} while (++{kind}_map < {kind}_end);", "#endif"]
    lines += [*_applied_last(), "    return m;", "}", ""]
    return "\n".join(lines)


def _includes() -> list[str]:
    """The lines that include the functions of maps and features that are applied by one."""
    files = [(m.info.feature.switch, m.name) for m in MAPS.values() if m.info.is_applied]
    files += [(feature.switch, feature.applied_by) for feature in SWITCHED if feature.applied_by]
    return [line for switch, name in files for line in (f"#if {switch}", f'#include "bsdf/{name}.glsl"', "#endif")]


def _applied_last() -> list[str]:
    return [line for feature in SWITCHED if feature.applied_by
            for line in (f"#if {feature.switch}", f"    apply_{feature.applied_by}(m);", "#endif")]


def _guarded(parameters: Iterable[Parameter], text: str, has_unlit: bool = True) -> list[str]:
    """A line for each parameter, inside an #if if only some programs declare it.

    With `has_unlit` there are unlit programs (HAS_NORMAL is 0), which declare only few parameters.
    """
    lines: list[str] = []
    conditions = {True: "", False: "HAS_NORMAL"} if has_unlit else {True: "", False: ""}
    for condition, group in groupby(sorted(parameters, key=lambda p: (not p.info.unlit, _guard(p, conditions))),
                                    key=lambda p: _guard(p, conditions)):
        body = [text.format(type=_type(p), name=p.name) for p in group]
        lines += [f"#if {condition}", *body, "#endif"] if condition else body
    return lines


def _guard(p: Parameter, conditions: Mapping[bool, str]) -> str:
    return p.info.switch or conditions[p.info.unlit]


def _products(source: Map) -> list[str]:
    """The lines that apply a texel: it multiplies parameters or changes them, and its raw channels are stored."""
    lines = [f"m.{p.name} *= texel.{_swizzle(p)};" for p in multiplied_by(source.name)]
    lines += [f"apply_{source.name}(m, texel);"] * source.info.is_applied
    raw = source.info.raw_channels
    return lines + ([f"m.{source.name}_texel = texel.{raw.lower()};"] if raw else [])


def _neutral(source: Map) -> str:
    values = ", ".join(f"{source.info.neutral['RGBA'.index(c)]}" for c in source.info.raw_channels)
    return f"{_TYPES[len(source.info.raw_channels)]}({values})"


def _swizzle(p: Parameter) -> str:
    return p.map_and_channels[1].lower()


def _type(p: Parameter) -> str:
    return _TYPES[p.size]


def _literal(p: Parameter) -> str:
    values = p.default if isinstance(p.default, tuple) else (p.default,)
    numbers = ", ".join(f"{float(v)}" for v in values)
    return f"{_type(p)}({numbers})" if p.size > 1 else numbers
