"""The passes of the raster that draw fog: their programs, and the switches of surfaces in it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from ..settings import Settings
from .model import Program

SLICES = 7
"""Slices of the media that one pass marches through: OpenGL 3.3 grants eight targets, and one carries light on."""
SLICE_COUNT = 28
SKY_LIGHTS = 32
"""Directions from which light of the environment reaches the cells of the grid."""


@dataclass(frozen=True)
class MediaPlan:
    """The programs of viewer/raster/media.py and media_light.py. `surfaces` are the switches that surfaces get."""

    march: Program
    bake: Program
    surfaces: Mapping[str, int]
    scatters_again: bool
    """Whether light that has been scattered is scattered once more."""


def media_switches(settings: Settings) -> dict[str, int]:
    """The switches of surfaces: MEDIA, whether there are any between them and the eye, and which."""
    fog = int(settings.fog > 0)
    return {"MEDIA": fog, "FOG": fog, "FOG_HEIGHT": int(fog and settings.fog_height > 0)}


def plan_media(settings: Settings, common: Mapping[str, int]) -> MediaPlan | None:
    """The plan of the media, None without any. `common` are the switches that all lit surfaces have in common."""
    switches = media_switches(settings)
    if not switches["MEDIA"]:
        return None
    names = ("LIGHT_COUNT", "DIRECTIONAL_COUNT", "POINT_COUNT", "SHADOW_LAYERS", "HAS_ENVIRONMENT",
             "ENVIRONMENT_ROTATED")
    lit = switches | {name: common[name] for name in names} | {"SHADOW_PATTERN": 0, "REFLECTS": 0}
    steps = int(settings.media_steps) // SLICE_COUNT
    return MediaPlan(_program("raster/media_march.frag", lit | {"SLICES": SLICES, "STEPS": steps}),
                     _program("raster/media_bake.frag", lit | {"SKY_LIGHTS": SKY_LIGHTS}),
                     switches, settings.media_scattering == "multiple")


def _program(fragment: str, switches: Mapping[str, int]) -> Program:
    return Program(fragment, tuple(sorted(switches.items())))
