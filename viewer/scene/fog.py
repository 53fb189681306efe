"""Fog: a medium that fills a ball about the scene, the same for both renderers."""

from __future__ import annotations

import math
from dataclasses import dataclass

from ..settings import Settings
from .medium import Medium
from .scene import Scene

REACH = 4.0
"""The radius of the ball of fog in radii of the scene. The default camera stands inside. A fog without an end would
hide the environment and every light that is infinitely far away."""


@dataclass(frozen=True)
class Fog:
    """`medium` in a ball, in world units.

    Its extinction is sigma_t at the height `base` and below, and thins out above as exp(-(y - base) / scale_height).
    """

    medium: Medium
    center: tuple[float, float, float]
    radius: float
    base: float
    scale_height: float = math.inf


def fog_medium(settings: Settings) -> Medium:
    """The medium of the settings `fog-...`; its sigma_t is 0 where there is no fog."""
    return Medium(sigma_t=(settings.fog,) * 3, albedo=settings.fog_albedo, g=settings.fog_g,
                  droplet_diameter=settings.fog_droplets)


def fog_of(scene: Scene, settings: Settings) -> Fog | None:
    """The fog around a scene, None if the settings ask for none."""
    if settings.fog <= 0:
        return None
    return Fog(fog_medium(settings), tuple(scene.center.tolist()), REACH * scene.radius, float(scene.bounds[0, 1]),
               settings.fog_height or math.inf)
