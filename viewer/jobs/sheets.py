"""Sheets: several views of a model in one picture, or a picture of each of several models."""

from __future__ import annotations

import math
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from ..errors import UsageError
from ..image.image import WRITABLE
from ..image.sheet import sheet_size
from ..scene.scene import Scene
from .directions import Direction, directions_of
from .film import Frame, film_camera, is_film
from .views import View, views_of

CELL = (320, 320)
"""The size of each picture of a sheet, unless there is a --size."""
_ALONE = ("aov", "tell_error", "error_map", "turntable", "fps")
_SIDES = {0: "front", 90: "right", 180: "back", 270: "left"}


def is_contact_sheet(models: Sequence[str], output: str, options: dict[str, Any]) -> bool:
    """Whether all models have their pictures in one file, and not each a sheet of its own."""
    is_one = "{name}" not in output and not output.endswith(("/", "\\")) and not Path(output).is_dir()
    return options["sheet"] is not None and len(models) > 1 and is_one


def check_sheet(models: Sequence[str], output: str, options: dict[str, Any], stats: str | None) -> None:
    """Raises UsageError for what does not go with --sheet, and for more models or views than it has places."""
    columns, rows = options["sheet"]
    given = [name.replace("_", "-") for name in _ALONE if options[name]]
    if given:
        raise UsageError(f"--{given[0]} and --sheet cannot be used together")
    count = len(directions_of(options))
    if is_contact_sheet(models, output, options):
        if Path(output).suffix.lower() not in WRITABLE or _is_no_picture(Path(output), options):
            raise UsageError(f"-o {output}: a sheet is a picture as displayed: .png, .jpg or .webp")
        for name, file in (("write-cameras", options["write_cameras"]), ("stats", stats)):
            if file is not None:
                raise UsageError(f"--{name} and a sheet of several models cannot be used together; it can with "
                                 "pictures in a folder")
        if count > 1 or options["cameras"] is not None:
            raise UsageError(f"-o {output}: a sheet of several models has one view of each; -o {Path(output).stem}/ "
                             "makes a sheet for each model")
        if len(models) > columns * rows:
            raise UsageError(f"--sheet {columns}x{rows}: {len(models)} models need at least "
                             f"{columns}x{math.ceil(len(models) / columns)}")
        sheet_size(len(models), columns, options["size"])
        return
    for name in ("eye", "camera"):
        if options[name] is not None:
            raise UsageError(f"--{name} and a sheet of views cannot be used together; --orbit says where it begins")
    _check_count(count, options)
    sheet_size(columns * rows, columns, options["size"])


def check_sheet_paths(paths: Sequence[Path], options: dict[str, Any]) -> None:
    """Raises UsageError for files of sheets that are no pictures as displayed."""
    for path in paths:
        if _is_no_picture(path, options):
            raise UsageError(f"-o {path}: a sheet is a picture as displayed: .png, .jpg or .webp")


def sheet_views(model: str, scene: Scene, options: dict[str, Any]) -> tuple[View, ...]:
    """The views of a sheet of one model: those that are asked for, or as many as it has places, all around the model
    from one distance. Raises as `views_of`, and UsageError for too many."""
    given = directions_of(options)
    if options["cameras"] is not None or len(given) > 1:
        views = views_of(model, scene, options)
        _check_count(len(views), options)
        return views
    start = given[0] if options["view"] or options["orbit"] else Direction("", "", 0.0, given[0].elevation)
    degrees = math.degrees(start.azimuth), math.degrees(start.elevation)
    orbit = degrees if start.distance is None else (*degrees, start.distance)
    count = math.prod(options["sheet"])
    frames = [Frame(model, None, None, math.tau * k / count) for k in range(count)]
    camera = film_camera(model, scene, frames, options | {"view": None, "orbit": (orbit,)})
    return tuple(View("", camera(scene, frame), options["size"], _title(degrees[0] + math.degrees(frame.turn)))
                 for frame in frames)


def _title(azimuth: float) -> str:
    whole = round(azimuth, 6) % 360
    return _SIDES.get(int(whole), "") * (whole == int(whole)) or f"{whole:g}°"


def _check_count(count: int, options: dict[str, Any]) -> None:
    columns, rows = options["sheet"]
    if count > columns * rows:
        raise UsageError(f"--sheet {columns}x{rows}: {count} views need at least "
                         f"{columns}x{math.ceil(count / columns)}")


def _is_no_picture(path: Path, options: dict[str, Any]) -> bool:
    return path.suffix.lower() in (".exr", ".npz") or is_film(path, options)
