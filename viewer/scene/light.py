"""Punctual lights in physical units, in world space (KHR_lights_punctual)."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Literal

RGB = tuple[float, float, float]


@dataclass(frozen=True)
class Light:
    """A light without size.

    `intensity` is illuminance in lux for a directional light and luminous intensity in candela for point and spot.
    As in glTF viewers, one unit of luminous flux is one unit of radiance here: a white Lambertian surface facing a
    directional light of pi lux has radiance 1. `direction` is where the light travels to. `range` None is unlimited.
    Cone angles are measured from the axis, in radians. `angular_radius`, of a directional light, is that of the sun it
    stands in for, in radians: no highlight of it is brighter than that sun was; 0: any may be. `casts_shadow` is off
    for one that stands in for a wide source.
    """

    kind: Literal["directional", "point", "spot"]
    color: RGB = (1.0, 1.0, 1.0)
    intensity: float = 1.0
    position: tuple[float, float, float] = (0.0, 0.0, 0.0)
    direction: tuple[float, float, float] = (0.0, 0.0, -1.0)
    range: float | None = None
    inner_cone: float = 0.0
    outer_cone: float = math.pi / 4
    angular_radius: float = 0.0
    casts_shadow: bool = True
    name: str = ""

    @classmethod
    def from_angles(cls, azimuth: float, elevation: float, lux: float) -> Light:
        """A directional light that shines *from* azimuth (0 = +Z, growing towards +X) and elevation, in radians."""
        cos_el = math.cos(elevation)
        origin = (cos_el * math.sin(azimuth), math.sin(elevation), cos_el * math.cos(azimuth))
        return cls("directional", intensity=lux, direction=(-origin[0], -origin[1], -origin[2]), name="--light")
