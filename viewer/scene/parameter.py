"""The declaration of a material's parameters and texture maps: one annotated dataclass field for each.

Everything else is derived from these declarations: the glTF reader, the folding of constant maps, the inputs of the
shaders, their uniforms and records, and the tables of docs/materials.md.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any, Literal

from ..base.expect import expect_number, range_words
from ..errors import UsageError
from .arrays import scene_numbers

RGBA = tuple[float, float, float, float]
WHITE: RGBA = (1.0, 1.0, 1.0, 1.0)
Role = Literal["input", "argument", "python"]
Encoding = Literal["linear", "srgb", "normal"]
"""What the numbers of an image are to a map: as they stand, sRGB, or normals, whose mip levels tell their spread."""


@dataclass(frozen=True)
class Feature:
    """A part of the material model that a material may or may not use.

    `title` is its name in plans and documents. `extension` is the glTF extension that defines its parameters, "" for
    glTF 2.0 itself. `place` is the JSON object that contains them, "" for the material or the extension itself. Shaders
    compile the feature's code if the switch `switch` is on, or always if it is "". `is_on` tests whether a material
    uses the feature; if not, its parameters have their defaults. `models` are the shading models (the raster's fragment
    files) that implement it. If `is_shareable`, its code is cheap and changes nothing when its parameters have their
    defaults, so a program that has it may be shared by materials that do not use it. `needs_tangents`: a mesh must have
    tangents for it. With `applied_by` = "name" it changes other parameters once all are known: apply_name(inout
    MaterialInputs) of shaders/bsdf/name.glsl.
    """

    title: str
    extension: str = ""
    place: str = ""
    switch: str = ""
    is_on: Callable[[Any], bool] = lambda material: True
    models: tuple[str, ...] = ("pbr",)
    is_shareable: bool = False
    needs_tangents: bool = False
    applied_by: str = ""


@dataclass(frozen=True)
class ParameterInfo:
    """The declaration of a parameter.

    `key` is its name in glTF; "a.b" means b in the object a. A number outside `low`..`high`, except `special`, is
    clamped in a file and refused from Python. A material may hold up to `held`, which is above `high` for what the
    reader multiplies by another number. `times` names the map and its channels ("metallic_roughness.G") that multiply
    the parameter. `path_traced` tells whether the path tracer reads it, too. `role` is "input" if it is a member of the
    shaders' `MaterialInputs`, "argument" if hand-written GLSL uses its uniform by name, and "python" if no shader reads
    it. `switch` is the preprocessor condition under which the raster's shaders declare it, by default the switch of its
    feature. `unlit` tells whether unlit surfaces use it.
    """

    feature: Feature
    key: str
    low: float
    high: float
    special: float | None
    held: float
    times: str
    unit: str
    meaning: str
    path_traced: bool
    role: Role
    switch: str
    unlit: bool

    def checked(self, value: Any, name: str, default: Any) -> Any:
        """`value` as a material holds it, a number or a tuple like `default`. Raises UsageError, which begins with
        `name`, for what is none or out of range."""
        if not isinstance(default, tuple):
            if not (type(value) is float and self.low <= value <= self.held and abs(value) < math.inf):  # most are
                expect_number(value, name, self.low, self.held, special=self.special, is_finite=default != math.inf)
            return value
        numbers = scene_numbers(value, name, len(default))
        if not all(self.low <= number <= self.held for number in numbers):
            raise UsageError(f"{name} is {numbers}, not {range_words(self.low, self.held)}")
        return numbers


@dataclass(frozen=True)
class MapInfo:
    """The declaration of a texture map.

    `channels` are the channels that are read. With `srgb` its colours are encoded as sRGB. `neutral`, RGBA in [0, 1],
    is the texel that changes nothing. `has_effect` tests whether the map can change a pixel of a lit surface, given the
    material's factors: a map that is multiplied by 0 cannot. `models` are the shading models (the raster's fragment
    files) that read it. `path_traced` tells whether the path tracer reads it, too. With `needs_tangents` it is read in
    tangent space. `raw_channels` are the channels that multiply no parameter: hand-written GLSL reads them, as stored,
    from the member `<map>_texel` of `MaterialInputs`. If `is_applied`, the map multiplies no parameter either, but
    apply_<map>(inout MaterialInputs, vec4 texel) of shaders/bsdf/<map>.glsl changes the inputs. `is_normal` tells
    whether its texels are normals.
    """

    feature: Feature
    key: str
    channels: str
    srgb: bool
    neutral: RGBA
    has_effect: Callable[[Any], bool]
    models: tuple[str, ...]
    path_traced: bool
    needs_tangents: bool
    raw_channels: str
    is_applied: bool
    is_normal: bool
    meaning: str

    @property
    def encoding(self) -> Encoding:
        return "normal" if self.is_normal else "srgb" if self.srgb else "linear"


def parameter(default: Any, key: str, meaning: str, *, of: Feature, low: float = -math.inf, high: float = math.inf,
              special: float | None = None, held: float | None = None, times: str = "", unit: str = "",
              path_traced: bool = True, role: Role = "input", switch: str = "", unlit: bool = False) -> Any:
    """A dataclass field that holds a parameter of the feature `of`; see ParameterInfo."""
    info = ParameterInfo(of, key, low, high, special, high if held is None else held, times, unit, meaning, path_traced,
                         role, switch or of.switch, unlit)
    return field(default=default, metadata={"parameter": info})


def texture_map(key: str, meaning: str, *, of: Feature, channels: str, srgb: bool = False,
                neutral: RGBA = WHITE,
                has_effect: Callable[[Any], bool] = lambda material: True, models: tuple[str, ...] = ("pbr",),
                path_traced: bool = True, needs_tangents: bool = False, raw_channels: str = "",
                is_applied: bool = False, is_normal: bool = False) -> Any:
    """A dataclass field that holds a texture map of the feature `of`, or None; see MapInfo.

    The field must be called `<map>_texture`.
    """
    info = MapInfo(of, key, channels, srgb, neutral, has_effect, models, path_traced, needs_tangents, raw_channels,
                   is_applied, is_normal, meaning)
    return field(default=None, metadata={"map": info})
