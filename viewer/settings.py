"""How a scene is to be shown. A render is a pure function of (scene, camera, settings, size)."""

from __future__ import annotations

import math
import re
from dataclasses import dataclass, field, fields, replace
from operator import index
from typing import Any, Literal, get_args, get_type_hints

from .errors import UsageError

Mode = Literal["pbr", "phong", "path"]
Denoise = Literal["off", "fast", "oidn"]
Lobes = Literal["all", "uniform-diffuse", "specular", "directional-diffuse"]
Tonemap = Literal["neutral", "agx", "aces", "none"]
Background = Literal["env", "none"] | tuple[float, float, float]
Ndf = Literal["ggx", "beckmann", "blinn-phong"]
Masking = Literal["smith", "smith-separable", "v-cavity", "none"]

NDFS: tuple[Ndf, ...] = get_args(Ndf)
"""In the order of the shaders' switch NDF."""
MASKINGS: tuple[Masking, ...] = get_args(Masking)
"""In the order of the shaders' switch MASKING."""
LAYERS = ("albedo", "normal", "depth", "variance", "samples")
"""What mode path can tell of a picture beside its colour; see `viewer.trace.layers`."""
MAX_EXPOSURE = 64.0
"""In stops; 2**64 times any radiance a half float holds is still a float32."""
DEFAULT_SPP = 64
MAX_SPP = 1 << 16
"""A float32 sum of so many samples is off by 0.4 % at worst, were each rounded the same way."""


@dataclass(frozen=True)
class Range:
    """The numbers a setting can have, both ends among them."""

    low: float
    high: float
    is_whole: bool = False

    def number(self, value: object, prefix: str) -> float:
        """`value` as such a number, an int where it is whole; else UsageError, which begins with `prefix`."""
        try:
            number = self._whole(value) if self.is_whole else float(value)  # type: ignore[arg-type]
        except (TypeError, ValueError):
            number = math.nan
        if not self.low <= number <= self.high:
            raise UsageError(f"{prefix} is {self}")
        return number

    @staticmethod
    def _whole(value: object) -> int:
        return int(value) if isinstance(value, str) else index(value)  # type: ignore[arg-type]

    def __str__(self) -> str:
        return f"a {'whole ' * self.is_whole}number from {_plain(self.low)} to {_plain(self.high)}"


def _plain(number: float) -> str:
    return str(number) if isinstance(number, int) else f"{number:g}"


RANGES = {
    "exposure": Range(-MAX_EXPOSURE, MAX_EXPOSURE),
    "spp": Range(1, MAX_SPP, is_whole=True),
    "time_budget": Range(0.01, 1e6),
    "error": Range(1e-5, 1.0),
    "seed": Range(0, (1 << 32) - 1, is_whole=True),
    "bounces": Range(1, 255, is_whole=True),
    "light_radius": Range(0.0, 1e9),
    "clamp": Range(0.0, 1e9),
}


def _option(default: str | float, meaning: str) -> Any:
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

    # Of mode path. It ends by whichever of spp, time_budget and error comes first; where none is given, after 64 spp.
    spp: int | None = None
    """Samples a pixel: exactly so many where no other rule is given, else the most that a pixel gets."""
    time_budget: float | None = None
    """In seconds, for one picture, preparing it included."""
    error: float | None = None
    """The relative error to reach, estimated from the samples themselves."""
    seed: int = 0
    denoise: Denoise = "off"

    # --set
    ndf: Ndf = _option("ggx", "how the normals of microfacets are spread, D")
    masking: Masking = _option(
        "smith", "how microfacets hide one another, G; smith is height-correlated")
    fresnel: Literal["schlick", "exact"] = _option("schlick", "how reflection grows towards grazing angles, F")
    multiscatter: Literal["on", "off"] = _option("on", "give back the light that bounces between microfacets")
    lobes: Lobes = _option("all", "show one contribution alone")
    phong: Literal["phong", "blinn-phong"] = _option("phong", "the highlight of --mode phong")
    shadows: Literal["on", "off"] = _option("on", "shadows of the lights")
    environment_shadows: Literal["off", "16", "64", "256", "1024"] = _option(
        "off", "lights drawn from the environment to find what of it is hidden")
    ambient_occlusion: Literal["off", "gtao"] = _option(
        "off", "darken what the picture itself shows to be hidden; nothing beside environment-shadows")
    indirect: Literal["off", "baked"] = _option(
        "off", "light that surfaces throw on one another; baked: path traced at the vertices, once")
    reflections: Literal["environment", "traced"] = _option(
        "environment", "what surfaces mirror; traced: also of the model itself, by a ray from each point shaded")
    refraction: Literal["screen", "traced"] = _option(
        "screen", "refraction in solid glass; traced: from surface to surface, by two paths from each shaded point")
    specular_aa: Literal["on", "off"] = _option(
        "off", "widen highlights that are finer than a pixel: calmer in motion, but farther from the truth")
    antialias: Literal["auto", "none", "msaa-2", "msaa-4", "msaa-8", "ssaa-4", "ssaa-9", "ssaa-16"] = _option(
        "auto", "samples a pixel, shaded once (msaa) or each (ssaa); auto: four, shaded once, but one while the camera "
        "moves and a processor draws")
    plan: Literal["needed", "everything"] = _option(
        "needed", "everything: leave nothing out, for the same picture; shows what is saved")
    sampling: Literal["mis", "bsdf", "lights"] = _option("mis", "mode path: how light is found; mis weighs both ways")
    bounces: int = _option(32, "mode path: the most often light is reflected or refracted on its way")
    light_radius: float = _option(0.0, "mode path: radius of point and spot lights, in the scene's unit")
    clamp: float = _option(0.0, "mode path: most luminance of one indirect sample; 0: none; what it takes is lost")

    @classmethod
    def of(cls, **values: Any) -> Settings:
        """Settings with some fields given; a colour may be written "#rrggbb", as sRGB.

        Raises UsageError for a field that does not exist or a value it cannot have.
        """
        names = [f.name for f in fields(cls)]
        choices = setting_choices() | {"mode": get_args(Mode), "tonemap": get_args(Tonemap),
                                       "denoise": get_args(Denoise)}
        for name, value in values.items():
            if name not in names:
                raise UsageError(f"no setting {name!r}; there are {', '.join(names)}")
            if name in choices and value not in choices[name]:
                raise UsageError(f"{name}={value!r}: {name} is one of {', '.join(choices[name])}")
        if "background" in values:
            values["background"] = parse_background(values["background"])
        for name in values.keys() & RANGES.keys():
            if values[name] is not None or name not in STOPPING:
                values[name] = RANGES[name].number(values[name], f"{name}={values[name]!r}: it")
        return cls(**values)

    def check_used(self) -> None:
        """Raises UsageError where a setting that this mode ignores is not the default."""
        idle = ignored(self.mode)
        unused = [f.name for f in fields(self) if f.name in idle and getattr(self, f.name) != f.default]
        if unused:
            verb = "does" if len(unused) == 1 else "do"
            modes = [mode for mode in get_args(Mode) if all(mode in _USED_BY[name] for name in unused)]
            where = f", only in mode{'s' * (len(modes) > 1)} {' and '.join(modes)}" if modes else ""
            raise UsageError(f"{' and '.join(unused)} {verb} nothing in mode {self.mode}{where}")

    @property
    def is_used(self) -> bool:
        """Whether `check_used` has nothing to say."""
        try:
            self.check_used()
        except UsageError:
            return False
        return True

    def check_open(self) -> tuple[Settings | None, Settings | None]:
        """Where the mode is left open: these settings in mode pbr and in mode path, each None where it ignores one of
        them. Raises UsageError where both do."""
        ways = replace(self, mode="pbr", time_budget=None, error=None), replace(self, mode="path")
        found = [settings if settings.is_used else None for settings in ways]
        if found == [None, None]:
            raise UsageError("neither mode pbr nor mode path uses all that is set: give a mode")
        return found[0], found[1]

    @property
    def most_spp(self) -> int:
        """The most samples a pixel can get in mode path."""
        if self.spp is not None:
            return self.spp
        return DEFAULT_SPP if self.time_budget is None and self.error is None else MAX_SPP

    def samples(self, is_software: bool, is_still: bool) -> int:
        """Samples a pixel on such a device, for a picture that is kept or one of a moving camera."""
        if self.antialias == "auto":
            return 1 if is_software and not is_still else 4
        return int(self.antialias[5:]) if self.antialias.startswith("msaa") else 1

    @property
    def supersampling(self) -> int:
        """Points along each side of a pixel that are shaded."""
        return math.isqrt(int(self.antialias[5:])) if self.antialias.startswith("ssaa") else 1

    def with_option(self, assignment: str) -> Settings:
        """A copy with one `NAME=VALUE` of `--set` applied; dashes in the name may be written for underscores."""
        name, _, value = assignment.partition("=")
        name = name.strip().replace("-", "_")
        choices = setting_choices()
        if name not in setting_meanings():
            raise UsageError(f"--set {assignment}: no setting {name!r}; there are {', '.join(setting_meanings())}")
        if name in RANGES:
            change: dict[str, Any] = {name: RANGES[name].number(value, f"--set {assignment}: {name}")}
        elif value in choices[name]:
            change = {name: value}
        else:
            raise UsageError(f"--set {assignment}: {name} is one of {', '.join(choices[name])}")
        return replace(self, **change)


STOPPING = ("spp", "time_budget", "error")
_USED_BY: dict[str, tuple[Mode, ...]] = {
    **dict.fromkeys(("ndf", "masking", "fresnel", "multiscatter"), ("pbr", "path")),
    "phong": ("phong",),
    **dict.fromkeys(("shadows", "antialias"), ("pbr", "phong")),
    **dict.fromkeys(("environment_shadows", "ambient_occlusion", "indirect", "reflections", "refraction",
                     "specular_aa"), ("pbr",)),
    **dict.fromkeys((*STOPPING, "seed", "denoise", "sampling", "bounces", "light_radius", "clamp"), ("path",)),
}
"""The modes that use a setting, of those that not all modes use."""


def ignored(*modes: Mode) -> tuple[str, ...]:
    """The settings that none of `modes` uses."""
    return tuple(name for name, users in _USED_BY.items() if not set(users) & set(modes))


def parse_background(value: object) -> Background:
    """What `Settings.background` holds, from "env", "none", "#rrggbb" (sRGB) or linear (r, g, b); else UsageError."""
    if isinstance(value, str) and value in ("env", "none"):
        return value  # type: ignore[return-value]
    if isinstance(value, str) and re.fullmatch("#?[0-9a-fA-F]{6}", value):
        import numpy as np

        from .scene.color import srgb_to_linear

        code = np.frombuffer(bytes.fromhex(value.removeprefix("#")), np.uint8)
        red, green, blue = srgb_to_linear(code / 255).tolist()
        return red, green, blue
    if isinstance(value, (tuple, list)) and len(value) == 3:
        red, green, blue = (Range(0, 1).number(part, f"background={part!r}: it") for part in value)
        return red, green, blue
    raise UsageError(f"background={value!r}: it is env, none, #rrggbb or three linear numbers from 0 to 1")


def setting_choices() -> dict[str, tuple[str, ...]]:
    """The settings of words that `--set` reaches, each with its allowed values; those of numbers are in `RANGES`."""
    hints = get_type_hints(Settings)
    return {name: get_args(hints[name]) for name in setting_meanings() if name not in RANGES}


def setting_meanings() -> dict[str, str]:
    """The settings `--set` reaches and what each is for, in the order they are documented."""
    return {f.name: f.metadata["meaning"] for f in fields(Settings) if "meaning" in f.metadata}
