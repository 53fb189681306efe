"""The views of a model: each is a camera, and a picture of its own."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from ..scene.camera import Camera
from ..scene.scene import Scene
from .assemble import make_camera
from .directions import directions_of


@dataclass(frozen=True)
class View:
    """`label` stands in the name of the picture's file; "" if it is the only one."""

    label: str
    camera: Camera


def views_of(model: str, scene: Scene, options: dict[str, Any]) -> tuple[View, ...]:
    """The views that the options ask for. Raises as `make_camera`."""
    if options["camera"] is not None or options["eye"] is not None:
        return (View("", make_camera(model, scene, options)),)
    return tuple(View(direction.label, make_camera(model, scene, options, direction))
                 for direction in directions_of(options))
