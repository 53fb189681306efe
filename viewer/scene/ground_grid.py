"""A grid on the ground under a scene, whose lines are a power of ten apart."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from .scene import Scene

REACH = 3.0
"""Half of its side, in radii of the scene."""


@dataclass(frozen=True)
class GroundGrid:
    """`middle` (3,) in world space is as high as the scene's lowest point; lines are at multiples of `spacing`."""

    middle: np.ndarray
    half: float
    spacing: float

    @classmethod
    def under(cls, scene: Scene) -> GroundGrid:
        """The grid of a scene, whose diameter is two to twenty distances between lines."""
        middle = np.array([scene.center[0], scene.bounds[0][1], scene.center[2]])
        return cls(middle, REACH * scene.radius, 10.0 ** math.floor(math.log10(scene.radius)))
