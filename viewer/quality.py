"""`--quality draft|standard|high`: named points of the front of error against time, for mode pbr (docs/quality.md)."""

from __future__ import annotations

import os
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace
from types import MappingProxyType
from typing import TYPE_CHECKING, Any, Literal, get_args

from .errors import UsageError
from .settings import Settings

if TYPE_CHECKING:
    from .scene.scene import Scene

QualityName = Literal["draft", "standard", "high"]
AUTO = "auto"
"""The choice of the point that the first picture allows: plan/first_picture.py."""

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
VARIABLE = "PBR_VIEWER_QUALITY"
"""The environment variable that has the quality where none is named. The pytest plugin sets it to draft."""


@dataclass(frozen=True)
class Quality:
    """A point by its name, and the settings that the user has set, which win over those of the point."""

    name: QualityName = "draft"
    given: frozenset[str] = frozenset()
    reason: str = ""
    """Why it is this one, if nobody has named it."""
    lights: int = 0
    """Of the environment, if the first picture has decided on their number; it may be less than the point's by name."""

    @classmethod
    def of(cls, name: str | None, given: Iterable[str], settings: Settings, scene: Scene,
           size: tuple[int, int]) -> Quality:
        """The point `name`; for auto, and for None, the one that a picture of `scene` with `size` pixels takes.

        Auto is draft where settings of the points are given that have an effect on `scene`, since somebody chooses by
        hand, and where no light is shown. Raises UsageError for a name that no point has.
        """
        kept = frozenset(given)
        told = "quality" if name is not None else VARIABLE
        name = os.environ.get(VARIABLE) or AUTO if name is None else name
        if name != AUTO:
            if name not in QUALITIES:
                raise UsageError(f"{told}={name!r}: quality must be one of {', '.join((AUTO, *QUALITIES))}")
            return cls(name, kept)
        from .plan.unused import without_effect

        chosen = kept & (DETERMINED | {"ambient_occlusion"})
        if by_hand := sorted(chosen - without_effect(scene, cls("standard", kept).applied(settings))):
            return cls("draft", kept, f"{' and '.join(by_hand)} chosen by hand")
        if settings.mode != "pbr" or settings.show != "shaded":
            return cls("draft", kept, "no light is shown" if settings.mode == "pbr" else "")
        from .plan.first_picture import FirstPicture

        first = FirstPicture.of(scene, size)
        return cls("standard" if first.lights else "draft", kept, first.reason, first.lights)

    def __str__(self) -> str:
        return self.name + (f" with {self.lights} lights" if self.point != POINTS[self.name] else "")

    @property
    def point(self) -> Mapping[str, Any]:
        """Its settings that are not the defaults of `Settings`."""
        named = POINTS[self.name]
        return {**named, "environment_shadows": str(self.lights)} if self.lights else named

    def applied(self, settings: Settings) -> Settings:
        """`settings` at this point. Other modes than pbr have no points: their settings stay as they are."""
        if settings.mode != "pbr":
            return settings
        kept = self.given
        if settings.ambient_occlusion != "off":  # it has no effect together with shadows of the environment
            kept |= {"environment_shadows"}
        return replace(settings, **{name: value for name, value in self.point.items() if name not in kept})

    def facts(self, settings: Settings) -> dict[str, str]:
        """What plans tell of it."""
        if settings.mode != "pbr":
            return {}
        return {"quality": self.name, **({"quality_reason": self.reason} if self.reason else {})}


DRAFT = Quality("draft")
"""With it all settings are what the user, or their defaults, say."""


def check_quality(name: str | None, settings: Settings, chooses: bool) -> None:
    """Raises UsageError for a quality where there is none: in other modes, and where a method is chosen."""
    if name in (None, AUTO):
        return
    if chooses:
        raise UsageError("quality has no effect together with a time budget or an error: these choose the method")
    if settings.mode != "pbr":
        raise UsageError(f"quality has no effect in mode {settings.mode}, only in mode pbr")
