"""The views of a model: each is a camera, and a picture of its own."""

from __future__ import annotations

import os
from dataclasses import dataclass
from functools import lru_cache
from typing import Any

from ..scene.camera import Camera
from ..scene.camera_file import CameraFrame, read_camera_file
from ..scene.scene import Scene
from .assemble import make_camera
from .directions import directions_of
from .following import first_camera


@dataclass(frozen=True)
class View:
    """`label` stands in the name of the picture's file, if there are several; "" if it has none. `size` is (width,
    height) of the picture in pixels, and `title` stands on sheets."""

    label: str
    camera: Camera
    size: tuple[int, int]
    title: str = ""


def camera_frames(options: dict[str, Any]) -> tuple[tuple[CameraFrame, ...], tuple[str, ...]]:
    """What `read_camera_file` makes of the file of --cameras, which is read again only if it has changed: all models
    have the same, and there may be many thousand frames. Raises InputError."""
    path = options["cameras"]
    try:
        stat = os.stat(path)
    except (OSError, ValueError):
        return read_camera_file(path, options["size"])  # which says what is wrong
    return _read_once(path, options["size"], (stat.st_dev, stat.st_ino, stat.st_mtime_ns, stat.st_size))


@lru_cache(maxsize=1)
def _read_once(path: str, size: tuple[int, int],
               stamp: tuple[int, ...]) -> tuple[tuple[CameraFrame, ...], tuple[str, ...]]:
    return read_camera_file(path, size)


def views_of(model: str, scene: Scene, options: dict[str, Any]) -> tuple[View, ...]:
    """The views that the options ask for. Raises as `make_camera`, and InputError for a file of cameras."""
    size = options["size"]
    if options["cameras"] is not None:
        frames, _ = camera_frames(options)
        return tuple(View(frame.camera.name, frame.camera, size if options["has_size"] else frame.size,
                          frame.camera.name) for frame in frames)
    if options["turntable"] is not None:
        return (View("", first_camera(model, scene, options), size),)
    if options["camera"] is not None or options["eye"] is not None:
        return (View("", make_camera(model, scene, options), size),)
    return tuple(View(direction.label, make_camera(model, scene, options, direction), size, direction.title)
                 for direction in directions_of(options))
