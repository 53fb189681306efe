"""Directional lights in place of an environment, as the command line can give them."""

from __future__ import annotations

import math
from dataclasses import replace

from ...bake.dominant import ambient_and_key
from ...bake.environment import BakedEnvironment
from ...scene.color import LUMINANCE
from ...scene.environment import Environment
from ...scene.light import Light


def environment_lights(environment: Environment, baked: BakedEnvironment) -> tuple[Light, ...]:
    """White directional lights in place of the environment: its suns, or the one light that is nearest to all of it."""
    lights = baked.suns
    if not lights:
        key = ambient_and_key(baked.irradiance)[1]
        lights = (replace(key, intensity=key.intensity * baked.scale),)
    return tuple(_as_option(light, environment.rotation, environment.intensity) for light in lights)


def light_option(light: Light) -> str:
    """A light that `_as_option` made as AZ,EL,LUX for --light."""
    x, y, z = (-part for part in light.direction)
    return f"{math.degrees(math.atan2(x, z)):.1f},{math.degrees(math.asin(max(-1.0, min(1.0, y)))):.1f}," \
           f"{light.intensity:.4g}"


def _as_option(light: Light, rotation: float, intensity: float) -> Light:
    """The light, rotated and scaled with its environment, white, and rounded as `light_option` writes it."""
    x, y, z = light.direction
    c, s = math.cos(rotation), math.sin(rotation)
    lux = light.intensity * intensity * float(light.color @ LUMINANCE)
    turned = replace(light, direction=(c * x + s * z, y, c * z - s * x), intensity=lux)
    azimuth, elevation, lux = map(float, light_option(turned).split(","))
    return Light.from_angles(math.radians(azimuth), math.radians(elevation), lux)
