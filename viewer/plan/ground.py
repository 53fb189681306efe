"""What draws the shadow of the model on the ground below it."""

from __future__ import annotations

from collections.abc import Mapping

from ..settings import Settings
from .model import Program

_LIGHTS = ("LIGHT_COUNT", "DIRECTIONAL_COUNT", "POINT_COUNT", "SHADOW_LAYERS", "SHADOW_PATTERN", "HAS_ENVIRONMENT")


def plan_ground(settings: Settings, common: Mapping[str, int], has_casters: bool) -> Program | None:
    """The program of the pass; None if it is not asked for, nothing casts shadows or nothing lights the ground.
    `common` are the switches that lit surfaces share."""
    is_lit = common["LIGHT_COUNT"] > 0 or common["HAS_ENVIRONMENT"]
    if settings.ground == "off" or not has_casters or not is_lit:
        return None
    return Program.of("raster/ground.frag", {name: common[name] for name in _LIGHTS} | {"MEDIA": 0})
