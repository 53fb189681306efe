"""Materials of a stage, UsdPreviewSurface, as JSON; runs in the other process.

Source: openusd.org/release/spec_usdpreviewsurface.html, with the names and the defaults of its inputs.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from pxr import Sdf, UsdShade

Json = dict[str, Any]
_DEFAULTS: Json = {
    "diffuseColor": [0.18, 0.18, 0.18], "emissiveColor": [0.0, 0.0, 0.0], "useSpecularWorkflow": 0,
    "specularColor": [0.0, 0.0, 0.0], "metallic": 0.0, "roughness": 0.5, "clearcoat": 0.0, "clearcoatRoughness": 0.01,
    "opacity": 1.0, "opacityThreshold": 0.0, "ior": 1.5, "normal": [0.0, 0.0, 1.0], "occlusion": 1.0}
_PRIM_READER, _TRANSFORM, _TEXTURE = "UsdPrimvarReader_float2", "UsdTransform2d", "UsdUVTexture"


def read_material(material: UsdShade.Material, warnings: list[str]) -> Json:
    """Name, `values` of the inputs, `textures` by input, and `uv`: the name and the transform of the coordinates."""
    found: Json = {"name": material.GetPrim().GetName(), "values": dict(_DEFAULTS), "textures": {}, "uv": None}
    surface, *_ = material.ComputeSurfaceSource()
    kind = surface.GetIdAttr().Get() if surface else None
    if kind != "UsdPreviewSurface":
        what = f"its shader {str(kind)[:80]!r} is not read" if surface else "it has no shader that is read"
        warnings.append(f"material {found['name'][:80]!r}: {what}; it is grey")
        return found | {"values": None}
    for shader_input in surface.GetInputs():
        name = shader_input.GetBaseName()
        if name in _DEFAULTS:
            _read_input(found, name, shader_input, warnings)
        elif name == "displacement" and shader_input.GetAttr().HasAuthoredConnections():
            warnings.append(f"material {found['name'][:80]!r}: displacement is left out")
    return found


def _read_input(found: Json, name: str, shader_input: UsdShade.Input, warnings: list[str]) -> None:
    for attribute in UsdShade.Utils.GetValueProducingAttributes(shader_input):
        shader = UsdShade.Shader(attribute.GetPrim())
        if UsdShade.Utils.GetType(attribute.GetName()) != UsdShade.AttributeType.Output:
            found["values"][name] = _numbers(attribute.Get(), _DEFAULTS[name])
        elif shader.GetIdAttr().Get() == _TEXTURE:
            _read_texture(found, name, shader, attribute.GetName().rpartition(":")[2], warnings)
        else:
            warnings.append(f"material {found['name'][:80]!r}: {name} comes from the shader "
                            f"{str(shader.GetIdAttr().Get())[:80]!r}, which is not read")


def _read_texture(found: Json, name: str, shader: UsdShade.Shader, output: str, warnings: list[str]) -> None:
    file = _value(shader, "file")
    if not isinstance(file, Sdf.AssetPath) or not file.path:
        return
    found["textures"][name] = {
        "file": str(file.resolvedPath), "asked": file.path, "output": output,
        "wrap": [str(_value(shader, key)) for key in ("wrapS", "wrapT")],
        "scale": _numbers(_value(shader, "scale"), [1.0] * 4), "bias": _numbers(_value(shader, "bias"), [0.0] * 4)}
    uv = _coordinates(shader)
    if found["uv"] in (None, uv):
        found["uv"] = uv
    else:
        warnings.append(f"material {found['name'][:80]!r}: the texture of {name} has texture coordinates of its own; "
                        "it is read at those of the others")


def _coordinates(shader: UsdShade.Shader) -> Json:
    """The name of the coordinates, and scale, rotation in degrees and translation of them."""
    uv: Json = {"name": "st", "scale": [1.0, 1.0], "rotation": 0.0, "translation": [0.0, 0.0]}
    source = _source(shader, "st")
    if source and source.GetIdAttr().Get() == _TRANSFORM:
        for key in ("scale", "translation"):
            uv[key] = _numbers(_value(source, key), uv[key])
        uv["rotation"] = _numbers(_value(source, "rotation"), 0.0)
        source = _source(source, "in")
    if source and source.GetIdAttr().Get() == _PRIM_READER:
        uv["name"] = str(_value(source, "varname") or "st")
    return uv


def _numbers(value: Any, default: Any) -> Any:
    """The value, if it is a finite number, or as many of them as the default has; else the default."""
    try:
        array = np.asarray(default if value is None else value, np.float64)
    except (TypeError, ValueError):
        return default
    return array.tolist() if array.shape == np.shape(default) and np.isfinite(array).all() else default


def _source(shader: UsdShade.Shader, name: str) -> UsdShade.Shader | None:
    for attribute in UsdShade.Utils.GetValueProducingAttributes(shader.GetInput(name)) if shader.GetInput(name) else ():
        return UsdShade.Shader(attribute.GetPrim())
    return None


def _value(shader: UsdShade.Shader, name: str) -> Any:
    """Of an input, or of what it is connected to."""
    shader_input = shader.GetInput(name)
    for attribute in UsdShade.Utils.GetValueProducingAttributes(shader_input) if shader_input else ():
        return attribute.Get()
    return None
