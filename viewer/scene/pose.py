"""A scene at a time: works out what an animation moves, and shares everything else."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from ..errors import InputError, UsageError
from .animation import Animation, Target
from .camera import Camera
from .curves import Curves
from .light import RANGES, Light
from .mesh import Mesh
from .posed_materials import plain, posed_materials
from .rig import Deformed, Nodes, Rig, camera_pose, compose, light_direction
from .scene import MAX_EXTENT, Instance, Scene

_SHAPE = "deformed by"
"""The attribute of a posed scene with what each of its deformed meshes was made from."""
_STRANDS = "curves moved by"
"""The same of its curves: the bytes of their matrices and colours."""


@dataclass(frozen=True)
class _Made:
    """What a deformed mesh was made from: the weights, and the bytes of its joints' matrices."""

    weights: tuple[float, ...]
    joints: bytes


def posed(scene: Scene, animation: Animation, time: float) -> Scene:
    """`scene` at `time` seconds of `animation`; see `Scene.at`."""
    rig = scene.rig
    if rig is None:
        return scene
    if len(rig.instances) != len(scene.instances) or max(rig.deformed, default=-1) >= len(scene.meshes):
        raise UsageError("the scene has other instances or meshes than those that its animations move")
    values = rig.at_rest | animation.at(time)
    try:
        with np.errstate(all="ignore"):
            world = _world(rig.nodes, values)
            hidden = _hidden(rig.nodes, values)
            meshes, made = _meshes(scene, rig, values, world)
            curves, moved_by = _curves(scene, rig, values, world, hidden)
            changes: dict[str, Any] = {
                "meshes": meshes, "curves": curves, "instances": _instances(scene, rig, world, hidden),
                "materials": posed_materials(scene, values), "lights": _lights(scene, rig, world, values, hidden),
                "cameras": _cameras(scene, rig, world, values)}
            changes = {name: value for name, value in changes.items() if value is not getattr(scene, name)}
            moved = replace(scene, **changes) if changes else scene
            if changes.keys() & {"meshes", "instances", "curves"} and not np.abs(moved.bounds).max() < MAX_EXTENT:
                raise UsageError(f"it has coordinates beyond {MAX_EXTENT:g}")
    except UsageError as error:
        raise InputError(scene.name, f"animation {animation.name!r}",
                         f"at {time:g} s the model cannot be drawn: {error}") from error
    moved.__dict__[_SHAPE], moved.__dict__[_STRANDS] = made, moved_by
    return moved


def _world(nodes: Nodes, values: dict[Target, np.ndarray]) -> np.ndarray:
    """Each node's matrix to the world, (N, 4, 4)."""
    tracks = [target for target in values if target.kind == "node" and target.name in _PROPERTIES]
    if not tracks:
        return nodes.world(nodes.at_rest)
    moved = np.array(sorted({target.number for target in tracks}))
    place = {int(node): k for k, node in enumerate(moved)}
    parts = {"translation": nodes.translations[moved], "rotation": nodes.rotations[moved],
             "scale": nodes.scales[moved]}
    for target in tracks:
        parts[target.name][place[target.number]] = values[target]
    local = nodes.at_rest.copy()
    local[moved] = compose(parts["translation"], parts["rotation"], parts["scale"])
    world = nodes.world(local)
    if not np.isfinite(world).all():
        raise UsageError("the transformation of a node overflows")
    return world


_PROPERTIES = ("translation", "rotation", "scale")


def _meshes(scene: Scene, rig: Rig, values: dict[Target, np.ndarray],
            world: np.ndarray) -> tuple[tuple[Mesh, ...], dict[int, _Made]]:
    """The meshes, and what those were made from that deform."""
    before: dict[int, _Made] = scene.__dict__.get(_SHAPE, {})
    made, meshes = {}, list(scene.meshes)
    for number, deformed in rig.deformed.items():
        weights = _weights(deformed, values)
        joints = b"" if deformed.skin is None else world[deformed.skin.joints].tobytes()
        made[number] = _Made(weights, joints)
        if made[number] != before.get(number):
            meshes[number] = deformed.at(weights, world)
    return (scene.meshes if made == before else tuple(meshes)), made


def _curves(scene: Scene, rig: Rig, values: dict[Target, np.ndarray], world: np.ndarray,
            hidden: np.ndarray) -> tuple[tuple[Curves, ...], dict[int, bytes]]:
    """The curves, and the bytes of the matrices that moved them and of the colours that tinted them."""
    if len(scene.curves) < len(rig.curves):  # some were taken away
        return scene.curves, {}
    before: dict[int, bytes] = scene.__dict__.get(_STRANDS, {})
    made, curves = {}, list(scene.curves)
    for number, moving in enumerate(rig.curves):
        matrices = moving.mover.matrices(world, hidden)
        color = values.get(Target("material", moving.material, "base_color"))
        tint = None if color is None else np.clip(color[:3], 0.0, 1.0)
        made[number] = matrices.tobytes() + (b"" if tint is None else tint.tobytes())
        if made[number] != before.get(number):
            curves[number] = moving.at(matrices, tint)
    return (scene.curves if all(a is b for a, b in zip(curves, scene.curves)) else tuple(curves)), made


def _instances(scene: Scene, rig: Rig, world: np.ndarray, hidden: np.ndarray) -> tuple[Instance, ...]:
    wanted = rig.transforms(world, hidden)
    moved = np.flatnonzero((wanted != scene.transforms).any(axis=(1, 2)))
    if not len(moved):
        return scene.instances
    instances = list(scene.instances)
    for k in moved:
        instances[k] = replace(instances[k], transform=wanted[k])
    return tuple(instances)


def _hidden(nodes: Nodes, values: dict[Target, np.ndarray]) -> np.ndarray:
    visible = nodes.visible.copy()
    for target, value in values.items():
        if target.kind == "node" and target.name == "visible":
            visible[target.number] = value[0] >= 0.5
    return nodes.hidden(visible)


def _weights(deformed: Deformed, values: dict[Target, np.ndarray]) -> tuple[float, ...]:
    value = values.get(Target("node", deformed.node, "weights"))
    weights = list(deformed.weights) if value is None else value.tolist()
    weights += [0.0] * (len(deformed.deformation.targets) - len(weights))
    for k in range(len(weights)):
        single = values.get(Target("node", deformed.node, f"weights[{k}]"))
        weights[k] = weights[k] if single is None else float(single[0])
    return tuple(weights)


def _lights(scene: Scene, rig: Rig, world: np.ndarray, values: dict[Target, np.ndarray],
            hidden: np.ndarray) -> tuple[Light, ...]:
    lights = list(scene.lights)
    if len(lights) < len(rig.lights):  # some were taken away
        return scene.lights
    for k, (node, item) in enumerate(zip(rig.lights, rig.light_items, strict=True)):
        x, y, z = world[node, :3, 3].tolist()
        changes = _changes("light", item, values)
        changes |= {"intensity": 0.0} if hidden[node] else {}
        if "intensity" in changes:
            changes["intensity"] = max(changes["intensity"], 0.0)
        if "color" in changes:
            changes["color"] = tuple(max(channel, 0.0) for channel in changes["color"])
        if "range" in changes:
            changes["range"] = changes["range"] if changes["range"] > 0 else None
        if "inner_cone" in changes or "outer_cone" in changes:
            changes |= _cone({"inner_cone": lights[k].inner_cone, "outer_cone": lights[k].outer_cone} | changes)
        lights[k] = replace(lights[k], position=(x, y, z), direction=light_direction(world[node]), **changes)
    return scene.lights if tuple(lights) == scene.lights else tuple(lights)


def _cone(values: dict[str, Any]) -> dict[str, float]:
    """The cone of `values` as KHR_lights_punctual allows it: 0 <= inner < outer <= pi / 2."""
    outer = min(max(values["outer_cone"], 1e-4), RANGES["outer_cone"][1])
    return {"outer_cone": outer, "inner_cone": min(max(values["inner_cone"], 0.0), outer * (1 - 1e-4))}


def _cameras(scene: Scene, rig: Rig, world: np.ndarray, values: dict[Target, np.ndarray]) -> tuple[Camera, ...]:
    cameras = list(scene.cameras)
    if len(cameras) < len(rig.cameras):
        return scene.cameras
    for k, (node, item) in enumerate(zip(rig.cameras, rig.camera_items, strict=True)):
        camera, pose, changes = cameras[k], camera_pose(world[node]), _changes("camera", item, values)
        if "near" in changes:
            changes["near"] = changes["near"] if changes["near"] > 0 else None
        if not 0 < changes.get("fov_y", 1.0) < math.pi:  # which would show nothing
            del changes["fov_y"]
        height = 2 * abs(changes.pop("ymag", 0.0))
        changes |= {"height": height} if height > 0 else {}
        if any(getattr(camera, name) != value for name, value in changes.items()) or (pose != camera.pose).any():
            cameras[k] = replace(camera, pose=pose, **changes)
    return scene.cameras if all(a is b for a, b in zip(cameras, scene.cameras)) else tuple(cameras)


def _changes(kind: str, number: int, values: dict[Target, np.ndarray]) -> dict[str, Any]:
    """The values of a light or a camera by the names of their fields, as numbers and tuples."""
    return {target.name: plain(value) for target, value in values.items()
            if target.kind == kind and target.number == number}
