"""`--quality draft|standard|high`: named points of the front of error against time, for mode pbr (docs/quality.md)."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace
from types import MappingProxyType
from typing import Any, Literal, get_args

from .errors import UsageError
from .settings import Settings

QualityName = Literal["draft", "standard", "high"]

QUALITIES: tuple[QualityName, ...] = get_args(QualityName)
POINTS: Mapping[QualityName, Mapping[str, Any]] = MappingProxyType({
    "draft": {},
    "standard": {"environment_shadows": "64", "indirect": "estimated", "antialias": "ssaa-4"},
    "high": {"environment_shadows": "64", "indirect": "baked", "reflections": "traced", "refraction": "traced",
             "antialias": "ssaa-9"},
})
"""The settings of each point that are not the defaults of `Settings`."""
DETERMINED = frozenset(name for point in POINTS.values() for name in point)
"""The settings on which the points differ."""


@dataclass(frozen=True)
class Quality:
    """A point by its name, and the settings that the user has set, which win over those of the point."""

    name: QualityName = "draft"
    given: frozenset[str] = frozenset()

    @classmethod
    def of(cls, name: str | None, given: Iterable[str]) -> Quality:
        """The point `name`, or the default one for None. Raises UsageError for a name that no point has."""
        if name is None:
            return cls(given=frozenset(given))
        if name not in QUALITIES:
            raise UsageError(f"quality={name!r}: quality must be one of {', '.join(QUALITIES)}")
        return cls(name, frozenset(given))

    def applied(self, settings: Settings) -> Settings:
        """`settings` at this point. Other modes than pbr have no points: their settings stay as they are."""
        if settings.mode != "pbr":
            return settings
        kept = self.given
        if settings.ambient_occlusion != "off":  # it has no effect together with shadows of the environment
            kept |= {"environment_shadows"}
        return replace(settings, **{name: value for name, value in POINTS[self.name].items() if name not in kept})

    def facts(self, settings: Settings) -> dict[str, str]:
        """What plans tell of it."""
        return {"quality": self.name} if settings.mode == "pbr" else {}


DRAFT = Quality("draft")
"""With it all settings are what the user, or their defaults, say."""


def check_quality(name: str | None, settings: Settings, chooses: bool) -> None:
    """Raises UsageError for a quality where there is none: in other modes, and where a method is chosen."""
    if name is None:
        return
    if chooses:
        raise UsageError("quality has no effect together with a time budget or an error: these choose the method")
    if settings.mode != "pbr":
        raise UsageError(f"quality has no effect in mode {settings.mode}, only in mode pbr")
