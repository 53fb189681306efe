"""What pixels that no geometry can touch show of the environment. They are resolved once and never traced."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from ...gpu.context import Context
from ...gpu.float_target import float_target
from ..layout import TILE

UNIT_SKY = 23  # beyond that of viewer/trace/scene/traced_scene.py
MOST_POINTS = 16


def points_of(height: int, pixel_angle: float) -> int:
    """At how many points along each axis of a pixel a map with `height` rows is looked up: two and two for each row
    that the pixel crosses."""
    return min(2 + math.ceil(2 * pixel_angle * height / math.pi), MOST_POINTS)


class Sky:
    """A picture of the environment where `covered`, (H, W), row 0 at the bottom, is false.

    `texture` has there the mean radiance of the pixel and 1, and elsewhere 0. A pass draws it into `framebuffer` with
    `mask` and `points` (shaders/trace/sky.frag). `is_bare`, (rows, columns), says which tiles have no other pixels, and
    `is_seen` whether the picture shows the environment.
    """

    def __init__(self, context: Context, covered: NDArray[np.bool_], points: int, is_seen: bool) -> None:
        height, width = covered.shape
        self.points, self.is_seen = points, is_seen
        self.texture = float_target(context.gl, (width, height))
        self.framebuffer = context.gl.framebuffer([self.texture])
        self.mask = context.gl.texture((width, height), 1, covered.astype(np.uint8) * np.uint8(255), alignment=1)
        padded = np.pad(covered, ((0, -height % TILE), (0, -width % TILE)))
        self.covered = padded.reshape(padded.shape[0] // TILE, TILE, -1, TILE).swapaxes(1, 2)
        self.is_bare: NDArray[np.bool_] = np.logical_not(self.covered.any(axis=(2, 3)))

    def release(self) -> None:
        for thing in (self.framebuffer, self.texture, self.mask):
            thing.release()
