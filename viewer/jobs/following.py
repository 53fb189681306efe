"""What follows a picture, for the layer motion: the scene at the next time, and its camera then."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace
from typing import TYPE_CHECKING, Any

from ..scene.camera import Camera
from ..scene.scene import Scene
from .assemble import find_animation, make_camera, pose
from .film import DEFAULT_FPS, film_camera, film_frames

if TYPE_CHECKING:
    from ..raster.layers import Following


def make_following(options: dict[str, Any]) -> Callable[[Scene, Camera], Following] | None:
    """What follows a scene that the options show by a camera, one frame later; None if nothing moves or no layer needs
    it. A still picture with a turntable is the first frame of that film."""
    moves = any(options[name] is not None for name in ("turntable", "animation", "time"))
    if "motion" not in options["aov"] or not moves:
        return None

    def following(scene: Scene, camera: Camera) -> Following:
        model = scene.name
        if options["turntable"] is not None:
            frames = film_frames(model, scene, options)
            frame = frames[1] if len(frames) > 1 else replace(frames[0], turn=math.tau)
            shown = frame.of(scene)
            return shown, film_camera(model, scene, frames, options)(shown, frame)
        time = (options["time"] or 0.0) + 1 / (options["fps"] or DEFAULT_FPS)
        shown = pose(model, scene, time, find_animation(model, scene, options["animation"]))
        return shown, camera if options["camera"] is None else make_camera(model, shown, options)

    return following


def first_camera(model: str, scene: Scene, options: dict[str, Any]) -> Camera:
    """The camera of a turntable's first frame. Raises as `film_frames` and `film_camera`."""
    frames = film_frames(model, scene, options)
    return film_camera(model, scene, frames, options)(scene, frames[0])
