"""The layers in which transmissive surfaces are drawn, so that they show each other.

The picture so far is copied before each layer, and seen through it. A layer has what does not overlap on the screen. A
thin wall with two sides that is no plane is drawn twice, what faces away before what faces the camera, so that a hollow
ball has the tint of both, at the price of one more copy. What faces away is placed at its farthest point, all else at
the nearest: the order is right for what stands apart, or inside of another. Peeling layers off by depth
(Everitt 2001) would also order what is intertwined, but has to draw all surfaces for each layer twice.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal, get_args

import numpy as np

from ..plan.glass_walls import MOST_WALLS, has_two_walls
from ..plan.model import Draw
from ..scene.frame import Frame
from ..scene.scene import Scene

MOST_LAYERS = 8
"""The farthest surfaces share the first layer where there would be more."""

_AXES = np.stack([f(np.arange(16) * np.pi / 16) for f in (np.cos, np.sin)], axis=1)
"""Directions on the screen along which two walls overlap if they do, (16, 2)."""

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
    outlines: list[np.ndarray] = []
    for draw in draws:
        points = _points(draw, scene)
        depth = (points - frame.camera.eye) @ frame.camera.forward
        sides: list[tuple[Side, float]] = [("all", depth.min())]
        if has_two_walls(draw, scene.meshes[draw.mesh]):
            sides = [("back", depth.max()), ("front", depth.min())]
        outline = _outline(points, frame)
        for side, place in sides:
            walls.append(Wall(draw, side))
            depths.append(place)
            outlines.append(outline)
    if len(walls) > MOST_WALLS:
        return [[Wall(draw) for draw in draws]]
    numbers = _numbers(np.array(depths), np.array(outlines).reshape(-1, 2, len(_AXES)))
    numbers = np.maximum(numbers - max(int(numbers.max(initial=0)) + 1 - MOST_LAYERS, 0), 0)
    return [[wall for wall, number in zip(walls, numbers, strict=True) if number == k]
            for k in range(int(numbers.max(initial=-1)) + 1)]


def _numbers(depths: np.ndarray, outlines: np.ndarray) -> np.ndarray:
    """The layer of each of N walls: one more than that of any farther wall that it overlaps, (N,) int."""
    order = np.argsort(-depths, kind="stable")
    numbers = np.zeros(len(order), int)
    for k, wall in enumerate(order):
        farther = order[:k]
        low, high = outlines[wall]
        overlaps = ((outlines[farther, 0] < high) & (outlines[farther, 1] > low)).all(axis=1)
        numbers[wall] = (numbers[farther][overlaps] + 1).max(initial=0)
    return numbers


def _points(draw: Draw, scene: Scene) -> np.ndarray:
    """Points about what is drawn: the outermost of a mesh, of many instances the corners of their boxes, (P, 3)."""
    if draw.instances:
        return scene.corners[list(draw.instances)].reshape(-1, 3)
    transform = scene.instances[draw.instance].transform
    return scene.meshes[draw.mesh].outermost @ transform[:3, :3].T + transform[:3, 3]


def _outline(points: np.ndarray, frame: Frame) -> np.ndarray:
    """What the hull of points (P, 3) covers of the screen: the lowest and highest place along each of _AXES, (2, K),
    in halves of the picture's height."""
    relative = (points - frame.camera.eye) / frame.unit
    clip = np.concatenate([relative, np.ones((len(relative), 1))], axis=1) @ frame.view_projection.T
    if (clip[:, 3] <= 0).any():
        return np.array([[-np.inf], [np.inf]]) * np.ones(len(_AXES))
    places = clip[:, :2] / clip[:, 3:] * (frame.size[0] / frame.size[1], 1.0) @ _AXES.T
    return np.stack([places.min(axis=0), places.max(axis=0)])
