"""What `render --tell-error` takes, and where its maps go."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

from ..errors import UsageError
from ..settings import Settings
from .film import is_film
from .outputs import Outputs, output_paths

_MAPS = (".exr", ".png")


def check_tell_error(settings: Settings, options: dict[str, Any], paths: Sequence[Path], chooses: bool) -> None:
    """Raises UsageError if the error cannot be told of these pictures."""
    if options["tell_error"] is None:
        if options["error_map"] is not None:
            raise UsageError("--error-map needs --tell-error")
        return
    if chooses:
        raise UsageError("--tell-error with --time-budget or --error: these tell an error themselves")
    if settings.mode == "path":
        raise UsageError("--tell-error is for pictures of the real-time modes; --mode path has no error but noise, "
                         "which --stats tells")
    settings.check_told("--tell-error")
    films = [path for path in paths if is_film(path, options)]
    if films:
        raise UsageError(f"--tell-error with -o {films[0]}: it tells the error of pictures, not of films")


def map_paths(models: Sequence[str], output: str | None) -> Outputs:
    """The files of the maps of the error, one for each model or none, as `output_paths`."""
    if output is None:
        return Outputs((), ())
    is_folder = output.endswith(("/", "\\")) or Path(output).is_dir()
    if not is_folder and Path(output).suffix.lower() not in _MAPS:
        raise UsageError(f"--error-map {output}: the name of a map must end in {' or '.join(_MAPS)}; that of a folder "
                         "in /")
    return output_paths(models, output, "--error-map")
