"""Which lights have shadow maps, and where in the atlas: the brightest that its tiles are enough for."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from ..scene.light import Light
from ..scene.scene import Scene

MAX_SHADOW_LAYERS = 64
"""Tiles of the atlas, which are 512 x 512 texels then (viewer/raster/shadows.py)."""


def shadow_layers(lights: Sequence[Light], scene: Scene) -> tuple[tuple[int, ...], int]:
    """The first layer of each light, or -1 if it has none, and the number of layers: six for a point light.

    Where they are not enough for all lights that cast shadows, those that are brightest at the scene come first. Those
    that stand for what volumes emit are as bright as all of them together: one fire.
    """
    chosen, used = set(), 0
    casting = [k for k, light in enumerate(lights) if light.casts_shadow]
    bright = {k: _illuminance(lights[k], scene) for k in casting}
    emitted = sum(bright[k] for k in casting if lights[k].radius > 0)
    for k in sorted(casting, key=lambda k: -(emitted if lights[k].radius > 0 else bright[k])):
        if used + _needed(lights[k]) <= MAX_SHADOW_LAYERS:
            chosen.add(k)
            used += _needed(lights[k])
    first, used = [], 0
    for k, light in enumerate(lights):
        first.append(used if k in chosen else -1)
        used += _needed(light) * (k in chosen)
    return tuple(first), used


def point_lights_left(lights: Sequence[Light]) -> int:
    """For how many point lights more there are layers beside `lights`."""
    used = sum(_needed(light) for light in lights if light.casts_shadow and light.intensity * max(light.color) > 0)
    return max(MAX_SHADOW_LAYERS - used, 0) // 6


def _needed(light: Light) -> int:
    return 6 if light.kind == "point" else 1


def _illuminance(light: Light, scene: Scene) -> float:
    """In lux, at the centre of the scene; of a lamp within the scene's sphere, at the sphere's radius from it."""
    bright = light.intensity * max(light.color)
    if light.kind == "directional":
        return bright
    distance = max(float(np.linalg.norm(np.subtract(light.position, scene.center))), scene.radius)
    if light.range and distance - scene.radius >= light.range:
        return 0.0
    return bright / distance / distance if math.isfinite(distance) else 0.0
