"""How a material declares its parameters and texture maps: one annotated field each, from which all else follows.

`viewer/material/` reads the declarations: the glTF reader, the folding of constant maps, the shaders' inputs, their
uniforms and records, and the table of docs/materials.md are made from them.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any, Literal

WHITE = (1.0, 1.0, 1.0, 1.0)
Role = Literal["input", "argument", "python"]


@dataclass(frozen=True)
class Feature:
    """A part of the material model that a material may lack.

    `extension` is the glTF extension that has its parameters, "" for glTF 2.0 itself; `place` the JSON object in which
    they stand, "" for the material or the extension itself. Shaders have the code of a feature where the switch
    `switch` is on, always where it is "". `is_on` says whether a material has it; where it has not, its parameters have
    their defaults. `models` are the fragment files of the raster that know it. `is_shareable` says that its code, with
    its parameters at their defaults, is cheap and changes nothing, so that materials may share a program that has it.
    """

    title: str
    extension: str = ""
    place: str = ""
    switch: str = ""
    is_on: Callable[[Any], bool] = lambda material: True
    models: tuple[str, ...] = ("pbr",)
    is_shareable: bool = False
    needs_tangents: bool = False


@dataclass(frozen=True)
class ParameterInfo:
    """What is declared of a parameter.

    `key` is its name in glTF, "a.b" for b of the object a. A number outside `low` and `high` is clamped, but for
    `special`. `times` names the map and the channels ("metallic_roughness.G") that it is multiplied by. `paths` says
    whether path tracing reads it, too. Its `role` is "input" where shaders have it as a member of `MaterialInputs`,
    "argument" where hand-written GLSL asks for it by name, and "python" where no shader reads it. `switch` is the
    condition under which the raster's shaders have it, by default that of the feature; `unlit` says whether surfaces
    without light have it.
    """

    feature: Feature
    key: str
    low: float
    high: float
    special: float | None
    times: str
    unit: str
    meaning: str
    paths: bool
    role: Role
    switch: str
    unlit: bool


@dataclass(frozen=True)
class MapInfo:
    """What is declared of a texture map.

    `channels` are those that are read. With `srgb` the colours are sRGB-encoded. `neutral`, RGBA in [0, 1], is the
    texel that changes nothing. `counts` says whether, by the material's factors, the map can change a pixel of a lit
    surface. `models` are the fragment files of the raster that read it; "unlit" also means: of surfaces without light.
    With `needs_tangents` it is read in tangent space. `keeps` are channels that multiply no parameter: hand-written
    GLSL finds them in `MaterialInputs` as they are stored, in `<map>_texel`.
    """

    feature: Feature
    key: str
    channels: str
    srgb: bool
    neutral: tuple[float, float, float, float]
    counts: Callable[[Any], bool]
    models: tuple[str, ...]
    paths: bool
    needs_tangents: bool
    keeps: str
    meaning: str


def parameter(default: Any, key: str, meaning: str, *, of: Feature, low: float = -math.inf, high: float = math.inf,
              special: float | None = None, times: str = "", unit: str = "", paths: bool = True,
              role: Role = "input", switch: str = "", unlit: bool = False) -> Any:
    """A dataclass field that holds a parameter; see ParameterInfo."""
    info = ParameterInfo(of, key, low, high, special, times, unit, meaning, paths, role, switch or of.switch, unlit)
    return field(default=default, metadata={"parameter": info})


def texture_map(key: str, meaning: str, *, of: Feature, channels: str, srgb: bool = False,
                neutral: tuple[float, float, float, float] = WHITE,
                counts: Callable[[Any], bool] = lambda material: True, models: tuple[str, ...] = ("pbr",),
                paths: bool = True, needs_tangents: bool = False, keeps: str = "") -> Any:
    """A dataclass field, called `<map>_texture`, that holds a texture map or None; see MapInfo."""
    info = MapInfo(of, key, channels, srgb, neutral, counts, models, paths, needs_tangents, keeps, meaning)
    return field(default=None, metadata={"map": info})
