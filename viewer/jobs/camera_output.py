"""Where the cameras of pictures are written."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from ..base.messages import say
from ..errors import UsageError
from ..scene.camera_file import write_frames
from ..scene.upright import up_matrix
from .film import is_film
from .outputs import model_names
from .views import camera_frames

Record = Mapping[str, object]


def camera_files(models: Sequence[str], output: str | None, paths: Sequence[Path],
                 options: Mapping[str, Any]) -> dict[str, Path]:
    """The file for the cameras of each model, which may be one for all; none without `output`.

    Raises UsageError for a name that is no such file's, and for films among the `paths` of the pictures.
    """
    if output is None:
        return {}
    films = [path for path in paths if is_film(path, dict(options))]
    if films:
        raise UsageError(f"--write-cameras with -o {films[0]}: it writes the cameras of pictures, not of films")
    if output.endswith(("/", "\\")) or Path(output).is_dir():
        files = [Path(output) / f"{name}.json" for name in model_names(models)]
    else:
        files = [Path(output.replace("{name}", name)) for name in model_names(models)]
    for file in files:
        if file.suffix.lower() != ".json":
            raise UsageError(f"--write-cameras {file}: the name of a file of cameras must end in .json; that of a "
                             "folder in /")
    return dict(zip(models, files, strict=True))


def write_camera_files(files: Mapping[str, Path], records: Sequence[Record], options: Mapping[str, Any]) -> None:
    """Write the cameras that the records of pictures tell of, to the files of their models. A view of a sheet has no
    picture of its own that could be named. Raises OutputError."""
    frames: dict[Path, list[Any]] = {file: [] for file in files.values()}
    for record in records:
        cameras = record.get("cameras")
        if isinstance(cameras, list):
            picture = Path(str(record["output"])) if options["sheet"] is None else None
            depth = picture if "depth" in options["aov"] else None
            frames[files[str(record["model"])]] += [(camera, picture, depth) for camera in cameras]
    turn = None if options["up"] == "y" else up_matrix(options["up"])
    for file, found in frames.items():
        if found:
            write_frames(file, found, turn)


def warn_of_cameras(options: Mapping[str, Any]) -> None:
    """Say once, and not for each model, what of --cameras is not drawn. Raises InputError for a file that cannot be
    used."""
    if options["cameras"] is not None:
        _, warnings = camera_frames(dict(options))
        for line in () if options["quiet"] else warnings:
            say(f"warning: {line}")
