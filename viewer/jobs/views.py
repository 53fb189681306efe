"""The views of a model: each is a camera, and a picture of its own."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from ..scene.camera import Camera
from ..scene.camera_file import read_camera_file
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


def views_of(model: str, scene: Scene, options: dict[str, Any]) -> tuple[View, ...]:
    """The views that the options ask for. Raises as `make_camera`, and InputError for a file of cameras."""
    size = options["size"]
    if options["cameras"] is not None:
        frames, _ = read_camera_file(options["cameras"], size)
        return tuple(View(frame.camera.name, frame.camera, size if options["has_size"] else frame.size,
                          frame.camera.name) for frame in frames)
    if options["turntable"] is not None:
        return (View("", first_camera(model, scene, options), size),)
    if options["camera"] is not None or options["eye"] is not None:
        return (View("", make_camera(model, scene, options), size),)
    return tuple(View(direction.label, make_camera(model, scene, options, direction), size, direction.title)
                 for direction in directions_of(options))
