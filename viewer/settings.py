"""How a scene is to be shown. A render is a pure function of (scene, camera, settings, size)."""

from __future__ import annotations

from dataclasses import dataclass, fields, replace
from typing import Literal, get_args, get_type_hints

from .errors import UsageError

Mode = Literal["pbr", "phong"]
Tonemap = Literal["neutral", "agx", "aces", "none"]
Background = Literal["env", "none"] | tuple[float, float, float]


@dataclass(frozen=True)
class Settings:
    """Everything that is not scene, camera or size. The fields below `# --set` are reached by `--set NAME=VALUE`."""

    mode: Mode = "pbr"
    background: Background = "env"
    """The environment itself, nothing (alpha 0), or a colour in linear Rec. 709."""
    exposure: float = 0.0
    """In EV: radiance is multiplied by 2**exposure before the tone map."""
    tonemap: Tonemap = "neutral"

    # --set
    ndf: Literal["ggx", "beckmann", "blinn-phong"] = "ggx"
    masking: Literal["smith", "smith-separable", "v-cavity", "none"] = "smith"
    fresnel: Literal["schlick", "exact"] = "schlick"
    multiscatter: Literal["on", "off"] = "on"
    lobes: Literal["all", "uniform-diffuse", "specular", "directional-diffuse"] = "all"
    phong: Literal["phong", "blinn-phong"] = "phong"
    shadows: Literal["on", "off"] = "on"
    specular_aa: Literal["on", "off"] = "on"
    antialias: Literal["auto", "none", "msaa-2", "msaa-4", "msaa-8"] = "auto"
    """auto: four samples a pixel; one for frames of a moving camera that a processor draws, where four double the time."""

    @classmethod
    def of(cls, **values: object) -> Settings:
        """Settings with some fields given; UsageError for one that does not exist or a value it cannot have."""
        choices = setting_choices() | {"mode": get_args(Mode), "tonemap": get_args(Tonemap)}
        for name, value in values.items():
            if name not in {f.name for f in fields(cls)}:
                raise UsageError(f"no setting {name!r}; there are {', '.join(f.name for f in fields(cls))}")
            if name in choices and value not in choices[name]:
                raise UsageError(f"{name}={value!r}: {name} is one of {', '.join(choices[name])}")
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
        return replace(self, **{name: value})


def setting_choices() -> dict[str, tuple[str, ...]]:
    """The settings `--set` reaches, each with its allowed values, in the order they are documented."""
    hints = get_type_hints(Settings)
    by_option = ("mode", "background", "exposure", "tonemap")
    return {f.name: get_args(hints[f.name]) for f in fields(Settings) if f.name not in by_option}
