"""What `render` is asked for, as plain data, so that this process or another can do it."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any


@dataclass(frozen=True)
class RenderJob:
    """What all models have in common: the `options` of the command line. With `chooses` the method is chosen for each
    picture, and with `measure` each pass is timed, which waits for its end."""

    options: dict[str, Any]
    chooses: bool = False
    measure: bool = False


@dataclass(frozen=True)
class RenderTask:
    """One model with all its views: the file `model`, that of its picture, and that of the map of its error.

    With `samples` it is these of one path-traced picture alone, and with `frames` these of one film. Of several views
    each has a picture of its own: with the view's label for {view} in the names, or after them. A view without a label
    is called "view" there.
    """

    model: str
    output: Path
    error_map: Path | None = None
    samples: range | None = None
    frames: range | None = None

    def picture(self, label: str = "") -> Path:
        """The file of the picture of the view `label`."""
        return _of_view(self.output, label)

    def map_of_error(self, label: str) -> Path | None:
        """The file of the map of that picture's error; None if there shall be none."""
        return None if self.error_map is None else _of_view(self.error_map, label)


def _of_view(path: Path, label: str) -> Path:
    if "{view}" in str(path):
        return Path(str(path).replace("{view}", label or "view"))
    return path.with_stem(f"{path.stem}_{label}") if label else path
