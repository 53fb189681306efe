"""The layers in which transmissive surfaces are drawn, so that they show each other.

The picture so far is copied before each layer, and seen through it. A layer has what does not overlap on the screen. A
thin wall with two sides that is no plane is drawn twice, what faces away before what faces the camera, so that a hollow
ball has the tint of both, at the price of one more copy. What faces away is placed at the farthest corner of its box,
all else at the nearest: the order is right for what stands apart, or inside of another. Peeling layers off by depth
(Everitt 2001) would also order what is intertwined, but has to draw all surfaces for each layer twice.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal, get_args

import numpy as np

from ..plan.model import THIN_WALLED, Draw
from ..scene.frame import Frame
from ..scene.mesh import Mesh

MOST_LAYERS = 8
"""The farthest surfaces share the first layer where there would be more."""
_MOST_WALLS = 256
"""Of more in the picture, all share one layer: to sort them would take longer than to draw them."""

Side = Literal["all", "back", "front"]
SIDES: tuple[Side, ...] = get_args(Side)


@dataclass(frozen=True)
class Wall:
    """The triangles of a draw, or those of them that turn one side to the camera."""

    draw: Draw
    side: Side = "all"


def layers_of(draws: Sequence[Draw], frame: Frame) -> list[list[Wall]]:
    """The walls of transmissive draws, the farthest layer first, in each in the order of `draws`."""
    scene = frame.scene
    walls: list[Wall] = []
    depths: list[float] = []
    rectangles: list[np.ndarray] = []
    for draw in draws:
        corners = scene.corners[list(draw.instances or (draw.instance,))].reshape(-1, 3)
        depth = (corners - frame.camera.eye) @ frame.camera.forward
        sides: list[tuple[Side, float]] = [("all", depth.min())]
        if draw.transmits == THIN_WALLED and draw.surface.double_sided and not _is_plane(scene.meshes[draw.mesh]):
            sides = [("back", depth.max()), ("front", depth.min())]
        for side, place in sides:
            walls.append(Wall(draw, side))
            depths.append(place)
            rectangles.append(_rectangle(corners, frame))
    if len(walls) > _MOST_WALLS:
        return [[Wall(draw) for draw in draws]]
    numbers = _numbers(np.array(depths), np.array(rectangles).reshape(-1, 4))
    numbers = np.maximum(numbers - max(int(numbers.max(initial=0)) + 1 - MOST_LAYERS, 0), 0)
    return [[wall for wall, number in zip(walls, numbers, strict=True) if number == k]
            for k in range(int(numbers.max(initial=-1)) + 1)]


def _numbers(depths: np.ndarray, rectangles: np.ndarray) -> np.ndarray:
    """The layer of each of N walls: one more than that of any farther wall that it overlaps, (N,) int."""
    order = np.argsort(-depths, kind="stable")
    numbers = np.zeros(len(order), int)
    for k, wall in enumerate(order):
        farther = order[:k]
        low, high = rectangles[wall, :2], rectangles[wall, 2:]
        overlaps = (rectangles[farther, :2] < high).all(axis=1) & (rectangles[farther, 2:] > low).all(axis=1)
        numbers[wall] = (numbers[farther][overlaps] + 1).max(initial=0)
    return numbers


def _rectangle(corners: np.ndarray, frame: Frame) -> np.ndarray:
    """What a box may cover of the screen: the lowest x and y and the highest, (4,), normalised device coordinates."""
    relative = (corners - frame.camera.eye) / frame.unit
    clip = np.concatenate([relative, np.ones((len(relative), 1))], axis=1) @ frame.view_projection.T
    if (clip[:, 3] <= 0).any():
        return np.array([-1.0, -1.0, 1.0, 1.0])
    points = np.clip(clip[:, :2] / clip[:, 3:], -1, 1)
    return np.concatenate([points.min(axis=0), points.max(axis=0)])


def _is_plane(mesh: Mesh) -> bool:
    """Whether its box has no depth along an axis, so that it turns one side to the camera."""
    low, high = np.asarray(mesh.bounds)
    return bool(((high - low) <= 1e-6 * (high - low).max()).any())
