"""What a film shows: the time and the turn of each frame, and a camera that all of them fit into."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from ..errors import InputError, UsageError
from ..image.film import FILM_FORMATS
from ..scene.camera import DEFAULT_FOV, Camera
from ..scene.scene import Scene
from .assemble import find_animation, make_camera, pose, why_no_animations
from .directions import directions_of

DEFAULT_FPS = 25.0
MAX_FRAMES = 36_000
_FITTED = 36
"""The most frames that the camera is fitted to, evenly spaced. Between two of 36 views of a turn, 10 degrees apart, a
silhouette grows by 1 / cos 5 degrees, or 0.4 %, and the camera leaves 5 % free."""


@dataclass(frozen=True)
class Frame:
    """`time` is that of `animation`, both None if the scene stands still; `turn` is how far the camera has turned.
    `model` is the file, for errors."""

    model: str
    animation: int | None
    time: float | None
    turn: float

    def of(self, scene: Scene) -> Scene:
        if self.animation is None or self.time is None:
            return scene
        return pose(self.model, scene, self.time, self.animation)


def is_film(path: Path, options: dict[str, Any]) -> bool:
    """Whether a film is asked for: by its ending, or, for .webp, by what moves."""
    plays = options["animation"] is not None and options["time"] is None
    moves = options["turntable"] is not None or options["fps"] is not None or plays
    suffix = path.suffix.lower()
    return suffix in FILM_FORMATS and (suffix != ".webp" or moves)


def check_film_options(paths: Sequence[Path], options: dict[str, Any], chooses: bool) -> None:
    """Raises UsageError for options that have no effect, or contradict each other."""
    from ..image.film import check_film

    for path in paths:
        if is_film(path, options):
            check_film(path, options["size"])
            if len(directions_of(options)) > 1:
                raise UsageError(f"-o {path}: a film has one --view or --orbit")
            if chooses:
                raise UsageError(f"-o {path}: a method is chosen for pictures only; give a --mode")
        elif "motion" in options["aov"] and options["turntable"] is not None and len(directions_of(options)) > 1:
            raise UsageError("--turntable with the layer motion has one --view or --orbit")
        elif "motion" not in options["aov"] and (options["turntable"] is not None or options["fps"] is not None):
            option = "--turntable" if options["turntable"] is not None else "--fps"
            raise UsageError(f"{option} with -o {path}: a film ends in one of {', '.join(FILM_FORMATS)}")
    fixed = [name for name in ("eye", "camera") if options[name] is not None]
    if options["turntable"] is not None and fixed:
        raise UsageError(f"--turntable and --{fixed[0]} cannot be used together")


def film_frames(model: str, scene: Scene, options: dict[str, Any]) -> list[Frame]:
    """The frames of a film of `scene`, the file `model`.

    A turntable turns once in as many frames as it says, over and over the animation if one is asked for. Otherwise the
    animation plays once. Raises InputError if nothing moves, if it is over at --time, or for more than MAX_FRAMES.
    """
    count, fps, start = options["turntable"], options["fps"] or DEFAULT_FPS, options["time"] or 0.0
    number, name, duration = None, "", 0.0
    if options["animation"] is not None or count is None:
        if options["animation"] is None and not scene.animations:
            none = "none that can be played" if why_no_animations(scene) else "none"
            raise InputError(model, "animations", f"there are {none}, so nothing moves; --turntable N turns the model")
        number = find_animation(model, scene, options["animation"])
        name, duration = scene.animations[number].name, scene.animations[number].duration
    if count is None:
        if start > 0 and start >= duration:
            problem = f"--time {start:g}: {name!r} is over by then; it takes {duration:g} s"
            raise InputError(model, "animations", problem)
        length = (duration - start) * fps
        if length > MAX_FRAMES:
            problem = f"{duration:g} s at {fps:g} frames a second are more than {MAX_FRAMES} frames"
            raise InputError(model, "animations", problem)
        return [Frame(model, number, start + k / fps, 0.0) for k in range(max(round(length), 1))]
    times = [start + k / fps for k in range(count)]
    if duration > 0:
        times = [time % duration for time in times]
    return [Frame(model, number, None if number is None else time, math.tau * k / count)
            for k, time in enumerate(times)]


def film_camera(model: str, scene: Scene, frames: Sequence[Frame],
                options: dict[str, Any]) -> Callable[[Scene, Frame], Camera]:
    """The camera of each frame, from the frame's scene. Without --camera it looks at one point, from one distance at
    which all frames fit into the picture. Raises as `make_camera`."""
    if options["camera"] is not None:
        return lambda shown, frame: make_camera(model, shown, options)
    chosen = [frames[k] for k in np.unique(np.linspace(0, len(frames) - 1, _FITTED).astype(int))]
    shown = [(frame.of(scene), frame.turn) for frame in chosen]
    target = options["target"]
    if target is None:
        bounds = np.stack([posed.bounds for posed, _ in shown])
        target = (bounds[:, 0].min(axis=0) + bounds[:, 1].max(axis=0)) / 2
    options = options | {"target": tuple(target)}
    if options["eye"] is not None:
        fixed = make_camera(model, scene, options)
        return lambda shown, frame: fixed
    fov = DEFAULT_FOV if options["fov"] is None else math.radians(options["fov"])
    direction = directions_of(options)[0]
    azimuth, elevation, distance = direction.azimuth, direction.elevation, direction.distance
    height = None
    if distance is None:
        columns, rows = options["size"]
        cameras = [posed.framing_camera(columns / rows, azimuth + turn, elevation, fov, target,
                                        orthographic=options["ortho"]) for posed, turn in shown]
        distance = max(float(np.linalg.norm(camera.eye - target)) for camera in cameras)
        height = max((camera.height for camera in cameras if camera.height is not None), default=None)
    elif options["ortho"]:
        height = Camera.orbit(target, distance, fov_y=fov).orthographic(distance).height
    return lambda shown, frame: replace(Camera.orbit(target, distance, azimuth + frame.turn, elevation, fov),
                                        height=height)


@dataclass(frozen=True)
class Film:
    """The frames of a film, and the camera of each."""

    frames: Sequence[Frame]
    camera: Callable[[Scene, Frame], Camera]
    fps: float


def make_film(model: str, path: Path, scene: Scene, options: dict[str, Any]) -> Film | None:
    """The film of `scene` for the file `path`; None if that is to be a picture. Raises as the functions above."""
    if not is_film(path, options):
        return None
    frames = film_frames(model, scene, options)
    return Film(frames, film_camera(model, scene, frames, options), options["fps"] or DEFAULT_FPS)
