"""The parameters, texture maps and features of a material, as viewer/scene/material.py declares them."""

from __future__ import annotations

from dataclasses import dataclass, fields
from functools import cache
from typing import cast

from .material import Material, Texture
from .parameter import Feature, MapInfo, ParameterInfo

Value = float | tuple[float, ...]


@dataclass(frozen=True)
class Parameter:
    """A parameter: a number, or a tuple of 3 or 4 numbers."""

    name: str
    default: Value
    info: ParameterInfo

    @property
    def size(self) -> int:
        """How many numbers it has: 1, 3 or 4."""
        return len(self.default) if isinstance(self.default, tuple) else 1

    @property
    def map_and_channels(self) -> tuple[str, str]:
        """The map that multiplies it and that map's channels, or two empty strings."""
        name, _, channels = self.info.times.partition(".")
        return name, channels

    def value(self, material: Material) -> Value:
        """The value for shaders: the material's, or the default if the material does not use the feature."""
        return getattr(material, self.name) if self.info.feature.is_on(material) else self.default


@dataclass(frozen=True)
class Map:
    """A texture map; its field is called `<name>_texture`."""

    name: str
    info: MapInfo

    def texture(self, material: Material) -> Texture | None:
        return getattr(material, f"{self.name}_texture")


_FIELDS = fields(Material)
PARAMETERS: dict[str, Parameter] = {
    f.name: Parameter(f.name, cast(Value, f.default), f.metadata["parameter"])
    for f in _FIELDS if "parameter" in f.metadata}
MAPS: dict[str, Map] = {name: Map(name, f.metadata["map"])
        for f in _FIELDS if "map" in f.metadata for name in [f.name.removesuffix("_texture")]}
FEATURES: tuple[Feature, ...] = tuple(dict.fromkeys(
    [p.info.feature for p in PARAMETERS.values()] + [m.info.feature for m in MAPS.values()]))
SWITCHED = tuple(feature for feature in FEATURES if feature.switch)
"""The features whose code a switch compiles into shaders."""
PATH_TRACED = tuple(feature for feature in SWITCHED if any(
    p.info.feature is feature and p.info.path_traced and p.info.role != "python" for p in PARAMETERS.values()) or any(
    m.info.feature is feature and m.info.path_traced for m in MAPS.values()))
"""The features among SWITCHED that have parameters or maps in the path tracer's records."""
MAP_SWITCHES = ("MAP", "UV", "TRANSFORM", "MIRROR")
"""The endings of a map's switches; the map "normal" has NORMAL_MAP, NORMAL_UV and so on. Their meaning is in
shaders/raster/attributes.glsl."""


@cache
def multiplied_by(name: str) -> tuple[Parameter, ...]:
    """The parameters that a map multiplies."""
    return tuple(p for p in PARAMETERS.values() if p.map_and_channels[0] == name)


def no_switches() -> dict[str, int]:
    """The switches of a program that reads no map and has no feature: all 0."""
    off = {feature.switch: 0 for feature in SWITCHED}
    return off | {f"{name.upper()}_{ending}": 0 for name in MAPS for ending in MAP_SWITCHES}


def tangent_texture(material: Material) -> Texture | None:
    """The texture whose coordinates define the tangents; None means the first UV set."""
    textures = (m.texture(material) for m in MAPS.values() if m.info.needs_tangents)
    return next((texture for texture in textures if texture is not None), None)


def needs_tangents(material: Material) -> bool:
    """Whether a mesh of this material needs tangents."""
    if material.unlit:
        return False
    maps = (m for m in MAPS.values() if m.info.needs_tangents and m.texture(material) is not None)
    return (any(m.info.has_effect(material) for m in maps)
            or any(f.needs_tangents and f.is_on(material) for f in SWITCHED))
