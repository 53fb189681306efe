"""Fog as the tracer has it: medium 0, in the ball about the scene where media are, beside the boxes of volumes."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from ...scene.fog import Fog
from ...scene.scene import Scene

_STEEPEST = 1e12
"""Bound on scale heights in a tracer unit, so that float32 holds them and their products."""


@dataclass(frozen=True, eq=False)
class TraceFog:
    """Where the fog is thinner than at the height `base`: in tracer space, above it, by a factor of e over a scale
    height; and not at all in `boxes`, (N, 3, 4), which are matrices from tracer space to the unit cube of each volume.

    `inverse_height` is 1 / scale height, 0 for a fog that does not thin out.
    """

    base: float
    inverse_height: float
    boxes: NDArray[np.float64]

    @property
    def thins(self) -> bool:
        """Whether it thins out with height."""
        return self.inverse_height > 0

    def texels(self) -> NDArray[np.float32]:
        """The section `fog` of the scene buffer (shaders/media/fog_way.glsl)."""
        first = np.array([[self.base, self.inverse_height, len(self.boxes), 0]])
        return np.concatenate([first, self.boxes.reshape(-1, 4)]).astype(np.float32)

    def length(self, origins: NDArray, directions: NDArray, start: NDArray, end: NDArray) -> NDArray:
        """The lengths at the density of the base that have the optical depths of rays, (N, 3), from `start` to `end`,
        (N,) each, which are in the ball; directions have unit length."""
        origins, directions, start, end = (np.asarray(a, np.float64) for a in (origins, directions, start, end))
        places = [np.broadcast_to(start, end.shape), np.maximum(start, end)]
        spans = [np.clip(span, *places) for box in self.boxes for span in (_box_span(box, origins, directions),)]
        cuts = np.sort(np.stack([*places, *(side for span in spans for side in span)]), axis=0)
        total = np.zeros(len(origins))
        for low, high in pairwise(cuts):
            middle = (low + high) / 2
            is_free = ~np.any([(enter < middle) & (middle < leave) for enter, leave in spans], axis=0)
            y0, y1 = ((origins[:, 1] + t * directions[:, 1] - self.base) * self.inverse_height for t in (low, high))
            total += is_free * (high - low) * (mean_density(y0, y1) if self.thins else 1.0)
        return total


def trace_fog(scene: Scene, fog: Fog) -> TraceFog:
    """`fog` about `scene`, in tracer space."""
    boxes = np.zeros((len(scene.volumes), 3, 4))
    for box, volume in zip(boxes, scene.volumes, strict=True):
        to_world = volume.index_to_world.copy()
        to_world[:3, 3] -= scene.center
        to_world[:3] /= scene.radius
        to_index = np.linalg.inv(to_world)[:3]
        to_index[:, 3] += 0.5
        box[:] = to_index / np.array(volume.density.shape[::-1])[:, None]
    return TraceFog((fog.base - float(scene.center[1])) / scene.radius,
                    min(scene.radius / fog.scale_height, _STEEPEST), boxes)


def mean_density(y0: NDArray, y1: NDArray) -> NDArray:
    """The mean of exp(-max(y, 0)) between heights, which are in scale heights above the base."""
    low, high = np.minimum(y0, y1), np.maximum(y0, y1)
    below = np.clip(-low / np.maximum(high - low, 1e-300), 0, 1)
    low = np.maximum(low, 0)
    x = np.maximum(high - low, 1e-300)
    return np.where(high <= 0, 1.0, below + (1 - below) * np.exp(-low) * -np.expm1(-x) / x)


def _box_span(box: NDArray, origins: NDArray, directions: NDArray) -> tuple[NDArray, NDArray]:
    """Where rays enter and leave the unit cube of a box, (N,) each; of rays that miss it these are the same."""
    start = origins @ box[:, :3].T + box[:, 3]
    slope = directions @ box[:, :3].T
    slope = np.where(np.abs(slope) < 1e-30, 1e-30, slope)
    a, b = -start / slope, (1 - start) / slope
    enter = np.minimum(a, b).max(axis=1)
    return enter, np.maximum(np.maximum(a, b).min(axis=1), enter)
