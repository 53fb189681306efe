"""Writes docs/materials.md: tables of a material's parameters, maps and features, from their declaration."""

from __future__ import annotations

from ..scene.parameter import Feature
from ..scene.schema import FEATURES, MAPS, PARAMETERS, Parameter

_HEAD = """# Materials

This page lists every parameter and every texture map of a material. The first column is the name in `viewer.Material`,
and the second the name in glTF. The page is generated from `viewer/scene/material.py` by `python -m viewer.material`.

A parameter is multiplied by the value of the map in the column "times map"; `base_color.RGBA` means all four channels
of `base_color_texture`. Maps marked sRGB are decoded to linear values. All other maps hold linear values.

## Parameters

| `Material` | glTF | default | range | times map | meaning |
|---|---|---|---|---|---|
"""
_MAPS = """
## Maps

| `Material` | glTF | channels | meaning |
|---|---|---|---|
"""
_FEATURES = """
## Features

The code of a feature is compiled into a shader only if a material in the scene needs it.

| feature | glTF extension | switch in shaders |
|---|---|---|
"""


def table() -> str:
    """The page as Markdown."""
    parameters = "".join(
        f"| `{p.name}` | `{_gltf(p.info.feature, p.info.key)}` | {_show(p.default)} | {_range(p)} | "
        f"{f'`{p.info.times}`' if p.info.times else ''} | {p.info.meaning}{_unit(p.info.unit)} |\n"
        for p in PARAMETERS.values())
    maps = "".join(
        f"| `{m.name}_texture` | `{_gltf(m.info.feature, m.info.key)}` | {m.info.channels}{', sRGB' * m.info.srgb} | "
        f"{m.info.meaning} |\n" for m in MAPS.values())
    features = "".join(
        f"| {f.title} | {f.extension or 'glTF 2.0'} | {f'`{f.switch}`' if f.switch else 'always there'} |\n"
        for f in FEATURES)
    return _HEAD + parameters + _MAPS + maps + _FEATURES + features


def _gltf(feature: Feature, key: str) -> str:
    return ".".join(part for part in (feature.extension, feature.place, key) if part)


def _show(value: object) -> str:
    return ", ".join(f"{v:g}" for v in value) if isinstance(value, tuple) else f"{value:g}"


def _range(p: Parameter) -> str:
    special = f", or {p.info.special:g}" if p.info.special is not None else ""
    return f"{p.info.low:g} to {p.info.high:g}{special}"


def _unit(unit: str) -> str:
    return f", in {unit}" if unit else ""
