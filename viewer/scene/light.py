"""Punctual lights in world space and physical units (KHR_lights_punctual)."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Literal, get_args

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..base.expect import expect, expect_number, expect_positive
from ..errors import UsageError
from .arrays import check_flag, scene_numbers

RGB = tuple[float, float, float]
Kind = Literal["directional", "point", "spot"]
KINDS: tuple[Kind, ...] = get_args(Kind)
"""In the order in which the raster's programs have their lights."""
BRIGHTEST = 1e30
"""The most of an intensity that renderers count, which leaves float32 room for highlights and for sums of lights."""
RANGES = {"intensity": (0.0, math.inf), "inner_cone": (0.0, 1.5708), "outer_cone": (0.0, 1.5708),
          "angular_radius": (0.0, math.inf), "radius": (0.0, math.inf)}
"""The numbers that a light may have. Cones end at pi / 2, with as few digits as files write it."""


@dataclass(frozen=True)
class Light:
    """A point, spot or directional light.

    `intensity` is the illuminance in lux for a directional light, and the luminous intensity in candela for point and
    spot lights. As in other glTF viewers, photometric units are used as radiometric ones: a white Lambertian surface
    that faces a directional light of pi lux has radiance 1. `direction` is the direction in which the light travels,
    of any length but 0.
    `range` None means unlimited. Cone angles are measured from the axis, in radians, 0 <= inner <= outer <= pi / 2, and
    count for spot lights only. `angular_radius` is for a
    directional light that represents a sun: the sun's angular radius in radians, which limits the brightness of
    highlights to that of the sun; 0 means no limit. `casts_shadow` is False for a light that represents a wide source.
    `radius` is for a point light that stands for what volumes emit within this distance of it, where the rasterizer
    takes it to be no brighter than at that distance; it lights no volumes.
    """

    kind: Kind
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
    radius: float = 0.0

    def __post_init__(self) -> None:
        if self.kind not in KINDS:
            raise UsageError(f"Light.kind is {self.kind!r}, not one of {', '.join(KINDS)}")
        for name in ("color", "position", "direction"):
            object.__setattr__(self, name, scene_numbers(getattr(self, name), f"Light.{name}", 3))
        if min(self.color) < 0:
            raise UsageError(f"Light.color is {self.color}, not at least 0")
        for name, (low, high) in RANGES.items():
            expect_number(getattr(self, name), f"Light.{name}", low, high, is_finite=True)
        if self.kind == "spot" and self.inner_cone > self.outer_cone:
            raise UsageError(f"Light.inner_cone is {self.inner_cone}, wider than its outer_cone, {self.outer_cone}")
        if self.range is not None:
            expect_positive(self.range, "Light.range", is_finite=False)
        check_flag(self.casts_shadow, "Light.casts_shadow")
        expect(self.name, str, "Light.name", "text")
        largest = max(map(abs, self.direction))
        if largest == 0:
            raise UsageError("Light.direction is 0, 0, 0, which points nowhere")
        if abs(math.hypot(*self.direction) - 1) > 1e-6:
            scaled = tuple(number / largest for number in self.direction)  # whose squares do not overflow
            object.__setattr__(self, "direction", tuple(number / math.hypot(*scaled) for number in scaled))

    @property
    def cone(self) -> tuple[float, float]:
        """Scale and offset of a spot's attenuation, as `spot_falloff` has them; (0, 1) of other lights, without any."""
        if self.kind != "spot":
            return 0.0, 1.0
        scale, offset = spot_falloff(self.inner_cone, self.outer_cone)
        return float(scale), float(offset)

    @classmethod
    def from_angles(cls, azimuth: float, elevation: float, lux: float) -> Light:
        """A directional light that shines *from* azimuth (0 = +Z, growing towards +X) and elevation, in radians."""
        for name, value in (("azimuth", azimuth), ("elevation", elevation)):
            expect_number(value, name, is_finite=True)
        cos_el = math.cos(elevation)
        origin = (cos_el * math.sin(azimuth), math.sin(elevation), cos_el * math.cos(azimuth))
        return cls("directional", intensity=lux, direction=(-origin[0], -origin[1], -origin[2]), name="--light")


def spot_falloff(inner: ArrayLike, outer: ArrayLike) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Scale s and offset o of the attenuation clamp(o - s (1 - cos))^2 at an angle from a spot's axis.

    `inner` and `outer` are half angles of its cones in radians, of any shape.

    It is ((cos - cos_outer) / (cos_inner - cos_outer))^2 (KHR_lights_punctual, "Inner and Outer Cone Angles"). 1 - cos
    keeps the digits of narrow cones, where cosines have none. The edge of a cone is no sharper than a step of 1e-4 in
    the cosine, or a thousandth of the whole cone.
    """
    low, high = (2 * np.sin(np.asarray(angle, np.float64) / 2) ** 2 for angle in (inner, outer))
    width = np.maximum(np.maximum(high - low, np.minimum(1e-4, 1e-3 * high)), 1e-30)
    return 1 / width, high / width
