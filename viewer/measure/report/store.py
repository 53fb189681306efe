"""What was measured, kept on disk as it comes, so that nothing is measured twice."""

from __future__ import annotations

import json
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from ...atomic import write_json
from ...errors import InputError, OutputError
from ...image import Image


@dataclass(frozen=True, eq=False)
class Record:
    """A picture, (H, W, 4) float32 linear radiance, and what was found about it; `seconds` is what finding it took."""

    picture: np.ndarray
    facts: dict[str, Any] = field(default_factory=dict)
    seconds: float = 0.0


class Store:
    """Records in `folder`, each as NAME.exr and NAME.json, which holds the key under which it is valid.

    The folder is made where it is missing, but not the one above that. Raises OutputError.
    """

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        try:
            folder.mkdir(exist_ok=True)
        except FileNotFoundError as error:
            raise OutputError(f"{folder}: there is no folder {folder.parent}") from error
        except OSError as error:
            raise OutputError(f"{folder}: cannot be made: {error.strerror}") from error

    def picture_path(self, name: str) -> Path:
        return self.folder / f"{name}.exr"

    def load(self, name: str, key: str) -> Record | None:
        """What was kept under this name for this very key; None where that is nothing, or cannot be read."""
        try:
            kept = json.loads((self.folder / f"{name}.json").read_text(encoding="utf-8"))
            if kept["key"] != key:
                return None
            return Record(Image.open(self.picture_path(name)).linear, kept["facts"], kept["seconds"])
        except (OSError, ValueError, KeyError, TypeError, InputError):
            return None

    def save(self, name: str, key: str, record: Record) -> None:
        """Raises OutputError. The figures are written last: they vouch for the picture."""
        (self.folder / f"{name}.json").unlink(missing_ok=True)
        Image.from_linear(record.picture).save(self.picture_path(name))
        write_json(self.folder / f"{name}.json", {"key": key, "seconds": record.seconds, "facts": record.facts})
