"""How a scene is to be shown. A render is a pure function of (scene, camera, settings, size)."""

from __future__ import annotations

import math
import re
from dataclasses import dataclass, field, fields, replace
from typing import Any, Literal, get_args, get_type_hints

from .errors import UsageError

Mode = Literal["pbr", "phong"]
Tonemap = Literal["neutral", "agx", "aces", "none"]
Background = Literal["env", "none"] | tuple[float, float, float]

MAX_EXPOSURE = 64.0
"""In stops; 2**64 times any radiance a half float holds is still a float32."""


def _option(default: str, meaning: str) -> Any:
    return field(default=default, metadata={"meaning": meaning})


@dataclass(frozen=True)
class Settings:
    """Everything that is not scene, camera or size. The fields below `# --set` are reached by `--set NAME=VALUE`."""

    mode: Mode = "pbr"
    background: Background = "env"
    """The environment itself, nothing (alpha 0), or a colour in linear Rec. 709.

    A colour is shown as it is, whatever the exposure and the tone map."""
    exposure: float = 0.0
    """In EV: radiance is multiplied by 2**exposure before the tone map."""
    tonemap: Tonemap = "neutral"

    # --set
    ndf: Literal["ggx", "beckmann", "blinn-phong"] = _option("ggx", "how the normals of microfacets are spread, D")
    masking: Literal["smith", "smith-separable", "v-cavity", "none"] = _option(
        "smith", "how microfacets hide one another, G; smith is height-correlated")
    fresnel: Literal["schlick", "exact"] = _option("schlick", "how reflection grows towards grazing angles, F")
    multiscatter: Literal["on", "off"] = _option("on", "give back the light that bounces between microfacets")
    lobes: Literal["all", "uniform-diffuse", "specular", "directional-diffuse"] = _option(
        "all", "show one contribution alone")
    phong: Literal["phong", "blinn-phong"] = _option("phong", "the highlight of --mode phong")
    shadows: Literal["on", "off"] = _option("on", "shadows of the lights")
    specular_aa: Literal["on", "off"] = _option("on", "widen highlights that are finer than a pixel")
    antialias: Literal["auto", "none", "msaa-2", "msaa-4", "msaa-8"] = _option(
        "auto", "samples a pixel; auto: four, but one while the camera moves and a processor draws")

    @classmethod
    def of(cls, **values: Any) -> Settings:
        """Settings with some fields given; a colour may be written "#rrggbb", as sRGB.

        Raises UsageError for a field that does not exist or a value it cannot have.
        """
        names = [f.name for f in fields(cls)]
        choices = setting_choices() | {"mode": get_args(Mode), "tonemap": get_args(Tonemap)}
        for name, value in values.items():
            if name not in names:
                raise UsageError(f"no setting {name!r}; there are {', '.join(names)}")
            if name in choices and value not in choices[name]:
                raise UsageError(f"{name}={value!r}: {name} is one of {', '.join(choices[name])}")
        if "background" in values:
            values["background"] = parse_background(values["background"])
        if "exposure" in values:
            values["exposure"] = _number(values["exposure"], "exposure", -MAX_EXPOSURE, MAX_EXPOSURE)
        return cls(**values)

    def samples(self, is_software: bool, is_still: bool) -> int:
        """Samples a pixel on such a device, for a picture that is kept or one of a moving camera."""
        if self.antialias == "auto":
            return 1 if is_software and not is_still else 4
        return int(self.antialias[5:]) if self.antialias.startswith("msaa") else 1

    def with_option(self, assignment: str) -> Settings:
        """A copy with one `NAME=VALUE` of `--set` applied; dashes in the name may be written for underscores."""
        name, _, value = assignment.partition("=")
        name = name.strip().replace("-", "_")
        choices = setting_choices()
        if name not in choices:
            raise UsageError(f"--set {assignment}: no setting {name!r}; there are {', '.join(choices)}")
        if value not in choices[name]:
            raise UsageError(f"--set {assignment}: {name} is one of {', '.join(choices[name])}")
        change: dict[str, Any] = {name: value}
        return replace(self, **change)


def parse_background(value: object) -> Background:
    """What `Settings.background` holds, from "env", "none", "#rrggbb" (sRGB) or linear (r, g, b); else UsageError."""
    if value == "env" or value == "none":
        return value  # type: ignore[return-value]
    if isinstance(value, str) and re.fullmatch("#?[0-9a-fA-F]{6}", value):
        import numpy as np

        from .scene.color import srgb_to_linear

        code = np.frombuffer(bytes.fromhex(value.removeprefix("#")), np.uint8)
        red, green, blue = srgb_to_linear(code / 255).tolist()
        return red, green, blue
    if isinstance(value, (tuple, list)) and len(value) == 3:
        red, green, blue = (_number(part, "background", 0.0, 1.0) for part in value)
        return red, green, blue
    raise UsageError(f"background={value!r}: it is env, none, #rrggbb or three linear numbers from 0 to 1")


def _number(value: object, name: str, low: float, high: float) -> float:
    try:
        number = float(value)  # type: ignore[arg-type]
    except (TypeError, ValueError):
        number = math.nan
    if not low <= number <= high:
        raise UsageError(f"{name}={value!r}: it is a number from {low:g} to {high:g}")
    return number


def setting_choices() -> dict[str, tuple[str, ...]]:
    """The settings `--set` reaches, each with its allowed values, in the order they are documented."""
    hints = get_type_hints(Settings)
    return {name: get_args(hints[name]) for name in setting_meanings()}


def setting_meanings() -> dict[str, str]:
    """What each setting of `setting_choices` is for, in a few words."""
    return {f.name: f.metadata["meaning"] for f in fields(Settings) if "meaning" in f.metadata}
