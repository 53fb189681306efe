"""glTF's materials: metallic-roughness and the supported extensions."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import fields
from typing import Any

import numpy as np

from ..animation import Animation
from ..light import BRIGHTEST
from ..material import (
    METALLIC_ROUGHNESS,
    SPECULAR_GLOSSINESS,
    AlphaMode,
    Material,
    UVTransform,
)
from ..parameter import Feature
from ..posed_materials import moved_material
from ..scene import Variant
from ..schema import FEATURES, MAPS, PARAMETERS, Parameter, Value
from ..specular_glossiness import Factors, with_factors
from .element import Element
from .scatter import read_scatter
from .specular_glossiness import read_factors
from .textures import Textures
from .variants import VARIANTS, material_choice, unique_names

_DEFAULTS = {field.name: field.default for field in fields(Material)}
_ALPHA_MODES: dict[str, AlphaMode] = {"OPAQUE": "opaque", "MASK": "mask", "BLEND": "blend"}


class Materials:
    """The materials of meshes. Primitives share one of the scene's if they have the same material in every variant."""

    def __init__(self, root: Element, textures: Textures) -> None:
        self._items = root.array("materials")
        self._textures = textures
        self._read: dict[int, Material] = {-1: Material()}
        self._choices: list[tuple[int, ...]] = []
        self._number: dict[tuple[int, ...], int] = {}
        self._peaks: dict[int, dict[str, np.ndarray]] = {}
        variants = root.extension(VARIANTS)
        self._names = unique_names(variants) if variants is not None else []

    def number(self, primitive: Element) -> int:
        """The number of a primitive's material in the scene."""
        choice = material_choice(primitive, len(self._items), len(self._names))
        if choice not in self._number:
            self._number[choice] = len(self._choices)
            self._choices.append(choice)
        return self._number[choice]

    def looks(self, number: int) -> list[Material]:
        """The materials that the scene's material of this number may be, the file's own choice first: as they are at
        rest, and with everything on that tracks turn on."""
        indices = dict.fromkeys(self._choices[number])
        return [*map(self._material, indices), *(moved_material(self._material(index), self._peaks[index])
                                                 for index in indices if index in self._peaks)]

    def moved_by(self, animations: Sequence[Animation]) -> None:
        """Note how far tracks take the parameters from 0. Tangents of splines count, too: values between key frames
        may be larger than those."""
        for track in (track for animation in animations for track in animation.tracks):
            kind, index, name = track.target
            if kind == "material" and name in PARAMETERS and name != "emissive":
                peak = np.abs(track.values).reshape(-1, track.values.shape[-1]).max(axis=0)
                peaks = self._peaks.setdefault(index, {})
                peaks[name] = np.maximum(peak, peaks.get(name, 0.0))

    @property
    def drawn(self) -> frozenset[int]:
        """The numbers in the file of all materials that may be drawn."""
        return frozenset(index for choice in self._choices for index in choice)

    def variants(self) -> tuple[Variant, ...]:
        """The file's own choice of materials, and those of its variants."""
        found = []
        for k, name in enumerate(["", *self._names]):
            numbers = tuple(choice[k] for choice in self._choices)
            found.append(Variant(name, tuple(self._material(number) for number in numbers), numbers))
        return tuple(found)

    def _material(self, index: int) -> Material:
        if index not in self._read:
            self._read[index] = read_material(self._items[index], self._textures)
        return self._read[index]

    def value(self, index: int, name: str) -> np.ndarray:
        """The value at rest of what a track moves of a used material of the file, (C,): `name` is as in `Target`."""
        element, material = self._items[index], self._material(index)
        if name == "emissive_strength":
            return np.atleast_1d(_emissive_strength(element))
        if name == "emissive":  # `Material.emissive` is multiplied by the strength
            return np.array(element.vector("emissiveFactor", 3, (0.0, 0.0, 0.0), 0.0, 1.0))
        glossy = element.extension(SPECULAR_GLOSSINESS.extension)
        if name in Factors._fields and glossy is not None:
            return np.atleast_1d(read_factors(glossy)[name])
        field, _, part = name.partition(".")
        value = getattr(material, field)
        if part:
            value = getattr((value.transform if value is not None else None) or UVTransform(), part)
        return np.atleast_1d(np.array(value, np.float64))


def _emissive_strength(element: Element) -> float:
    extension = element.extension("KHR_materials_emissive_strength")
    return 1.0 if extension is None else extension.number("emissiveStrength", 1.0, 0.0, BRIGHTEST)


def read_material(element: Element, textures: Textures) -> Material:
    """Reads one element of `materials`: all parameters and maps that viewer/scene/material.py declares."""
    glossy = element.extension(SPECULAR_GLOSSINESS.extension)
    other = METALLIC_ROUGHNESS if glossy is not None else None  # what the file has for readers without the extension
    places: dict[Feature, Element | None] = {feature: _place(element, feature) for feature in FEATURES
                                             if feature is not other}
    values: dict[str, Any] = {}
    for parameter in PARAMETERS.values():
        place = places.get(parameter.info.feature)
        if place is not None:
            values[parameter.name] = _read_parameter(place, parameter)
    for source in MAPS.values():
        place = places.get(source.info.feature)
        if place is not None:
            values[f"{source.name}_texture"] = textures.read(place, source.info.key, source.info.neutral)
    strength = _emissive_strength(element)
    values["emissive"] = tuple(channel * strength for channel in values["emissive"])
    if glossy is not None:
        values["base_color_texture"] = textures.read(glossy, "diffuseTexture", MAPS["base_color"].info.neutral)
    values |= read_scatter(element, {**_DEFAULTS, **values})
    material = Material(
        name=element.string("name", ""),
        alpha_mode=element.choice("alphaMode", _ALPHA_MODES, "OPAQUE"),
        double_sided=element.boolean("doubleSided", False),
        unlit=element.extension("KHR_materials_unlit") is not None,
        **values,
    )
    return material if glossy is None else with_factors(material, Factors(**read_factors(glossy)))


def _place(element: Element, feature: Feature) -> Element | None:
    """The JSON object with a feature's parameters; None if the material does not have the extension."""
    place = element.extension(feature.extension) if feature.extension else element
    return place.object(feature.place) if place is not None and feature.place else place


def _read_parameter(place: Element, parameter: Parameter) -> Value:
    info, default = parameter.info, parameter.default
    *objects, key = info.key.split(".")
    for name in objects:
        place = place.object(name)
    if isinstance(default, tuple):
        return place.vector(key, len(default), default, info.low, info.high)
    if info.special is not None and place.number(key, default) == info.special:
        return info.special
    return place.number(key, default, info.low, info.high)
