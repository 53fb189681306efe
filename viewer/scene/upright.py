"""Turns a scene so that another of its axes points upwards: models from CAD and 3D printing have +Z there."""

from __future__ import annotations

from dataclasses import replace
from typing import Literal, get_args

import numpy as np

from ..errors import UsageError
from .curves import Curves
from .light import Light
from .rig import Nodes, Rig
from .scene import Scene

Up = Literal["x", "y", "z", "-x", "-y", "-z"]

_AXES = {"x": ("-y", "x", "z"), "y": ("x", "y", "z"), "z": ("x", "z", "-y"),
         "-x": ("y", "-x", "z"), "-y": ("x", "-y", "-z"), "-z": ("x", "-z", "y")}
"""What the new axes are of the old ones. A turn by a quarter about X keeps the right side right; of a model that lies
along X it is one about Z, which keeps the front in front."""


def up_matrix(up: str) -> np.ndarray:
    """The turn (4, 4) float64 that takes the axis `up` to +Y. Raises UsageError if that is no axis."""
    if up not in get_args(Up):
        raise UsageError(f"up={up!r}: it must be one of {', '.join(get_args(Up))}")
    matrix = np.eye(4)
    for row, axis in enumerate(_AXES[up]):
        matrix[row, :3] = 0.0
        matrix[row, "xyz".index(axis[-1])] = -1.0 if axis.startswith("-") else 1.0
    return matrix


def upright(scene: Scene, up: str) -> Scene:
    """`scene` turned about the origin so that its axis `up` points upwards, +Y; its environment stays as it is.

    Models, lights, cameras and animations turn alike, by whole numbers and without rounding. Raises UsageError.
    """
    turn = up_matrix(up)
    if up == "y":
        return scene
    curves = {id(each): _turned_curves(each, turn) for each in scene.curves}
    return replace(
        scene,
        instances=tuple(replace(each, transform=turn @ each.transform) for each in scene.instances),
        lights=tuple(_turned_light(each, turn) for each in scene.lights),
        cameras=tuple(replace(each, pose=turn @ each.pose) for each in scene.cameras),
        volumes=tuple(replace(each, index_to_world=turn @ each.index_to_world) for each in scene.volumes),
        curves=tuple(curves[id(each)] for each in scene.curves),
        rig=None if scene.rig is None else _turned_rig(scene.rig, turn, curves))


def _turned_light(light: Light, turn: np.ndarray) -> Light:
    position, direction = ((turn[:3, :3] @ vector).tolist() for vector in (light.position, light.direction))
    return replace(light, position=tuple(position), direction=tuple(direction))


def _turned_curves(curves: Curves, turn: np.ndarray) -> Curves:
    return replace(curves, points=curves.points @ turn[:3, :3].T.astype(np.float32))


def _turned_rig(rig: Rig, turn: np.ndarray, curves: dict[int, Curves]) -> Rig:
    """The rig with a node above all roots, which turns them. `curves` are the turned ones, by those at rest."""
    nodes, root = rig.nodes, len(rig.nodes.parents)
    turned = Nodes(
        np.append(np.where(nodes.parents < 0, root, nodes.parents), -1), np.append(nodes.depth + 1, 0),
        np.append(nodes.translations, np.zeros((1, 3)), axis=0),
        np.append(nodes.rotations, [[0.0, 0.0, 0.0, 1.0]], axis=0), np.append(nodes.scales, np.ones((1, 3)), axis=0),
        nodes.matrices | {root: turn}, np.append(nodes.visible, True))
    return replace(rig, nodes=turned, curves=tuple(
        replace(moving, at_rest=curves.get(id(moving.at_rest)) or _turned_curves(moving.at_rest, turn))
        for moving in rig.curves))
