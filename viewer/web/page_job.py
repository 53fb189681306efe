"""`pbr-viewer page`: takes the pictures of a page, and writes it."""

from __future__ import annotations

import math
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from ..base.atomic import atomic_write
from ..base.messages import say
from ..base.progress import Progress
from ..base.signals import Stopped
from ..errors import UsageError
from ..gpu.context import open_context
from ..jobs.directions import directions_of
from ..jobs.film import Frame, film_camera
from ..jobs.makers import make_picture_maker
from ..jobs.picture_maker import RenderRequest
from ..plan.warnings import sample_warnings
from ..quality import Quality
from ..scene.camera import Camera
from ..scene.scene import Scene
from ..settings import Settings
from .turning import MOST_PIXELS, Turn, encoded, turning_page

MOST_PICTURES = 1000


def check_page_options(path: Path, options: dict[str, Any]) -> None:
    """Raises UsageError for options that have no effect, or contradict each other."""
    if path.suffix.lower() not in (".html", ".htm"):
        raise UsageError(f"-o {path}: the name of a page must end in .html")
    for name in ("eye", "camera"):
        if options[name] is not None:
            raise UsageError(f"--{name} has no effect on a page, whose camera turns about the model; there is --orbit")
    columns, rows = options["frames"]
    if columns * rows > MOST_PICTURES:
        raise UsageError(f"--frames {columns}x{rows}: a page has at most {MOST_PICTURES} pictures")
    if max(options["size"]) > MOST_PIXELS:
        raise UsageError(f"--size {options['size'][0]}x{options['size'][1]}: pictures of a page have at most "
                         f"{MOST_PIXELS} pixels along a side")


def write_page(model: str, path: Path, scene: Scene, settings: Settings, quality: Quality,
               options: dict[str, Any]) -> None:
    """Write the page of `scene`, the file `model`, to `path`, whole or not at all.

    A signal to stop raises Stopped. Raises also ContextError, InputError, OutputError.
    """
    direction, (columns, rows) = directions_of(options)[0], options["frames"]
    degrees = (round(math.degrees(angle), 9) for angle in (direction.azimuth, direction.elevation))
    turn = Turn.of(columns, rows, *degrees)
    cameras = _cameras(model, scene, turn, options)
    quiet, known, pictures, lost = options["quiet"], scene.all_warnings, [], list[str]()
    with open_context(options["backend"]) as context, Progress(turn.count, enabled=not quiet) as progress:
        maker = make_picture_maker(RenderRequest(
            lambda: context, settings, options["size"], (), not options["no_cache"], measure=False, quality=quality))
        for number, camera in enumerate(cameras):
            progress.step(f"{path.name}: picture {number + 1} of {turn.count}")
            image = maker.make(scene, camera, path, progress)
            if maker.stopped is not None:
                raise Stopped(maker.stopped)
            pictures.append(encoded(image, options["webp_quality"]))
            lost += [line for line in sample_warnings(maker.stats) if line not in lost]
    page = turning_page(scene.name, turn, pictures, options["size"], _about(turn, settings, quality, options))
    with atomic_write(path) as temporary:
        temporary.write_text(page, encoding="utf-8")
    if not quiet:
        for warning in [*(line for line in scene.all_warnings if line not in known), *lost]:
            say(f"{model}: warning: {warning}")
        width, height = options["size"]
        size = f"{len(page) / 1e6:.1f} MB" if len(page) >= 1e6 else f"{len(page) / 1e3:.0f} kB"
        say(f"{path}: {turn.count} pictures of {width}x{height}, {size}")


def _cameras(model: str, scene: Scene, turn: Turn, options: dict[str, Any]) -> list[Camera]:
    """All of them look at one point from one distance, at which the model fits into each picture."""
    target = scene.center if options["target"] is None else np.array(options["target"])
    frames = [Frame(model, None, None, angle) for angle in turn.turns]

    def take(distance: tuple[float, ...]) -> list[Camera]:
        cameras = []
        for elevation in turn.elevations:
            orbit = (turn.azimuth, elevation, *distance)
            camera = film_camera(model, scene, frames, options | {"target": tuple(target), "orbit": (orbit,),
                                                                  "view": None})
            cameras += [camera(scene, frame) for frame in frames]
        return cameras

    distance = directions_of(options)[0].distance
    if distance is not None:
        return take((distance,))
    fitting = take(())
    if options["ortho"]:
        height = max(camera.height for camera in fitting if camera.height is not None)
        return [replace(camera, height=height) for camera in fitting]
    return take((max(float(np.linalg.norm(camera.eye - target)) for camera in fitting),))


def _about(turn: Turn, settings: Settings, quality: Quality, options: dict[str, Any]) -> str:
    width, height = options["size"]
    how = f"mode {settings.mode}" + (f", quality {quality}" if settings.mode == "pbr" else "")
    return f"{turn.count} pictures of {width} × {height}, {how}, made by pbr-viewer"
