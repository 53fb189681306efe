"""What was measured, kept on disk as it comes, so that nothing is measured twice."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from ...base.atomic import make_folder, write_json
from ...errors import InputError
from ...image.image import Image


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
        make_folder(folder)

    def picture_path(self, name: str) -> Path:
        return self.folder / f"{name}.exr"

    def load(self, name: str, key: str) -> Record | None:
        """What was kept under this name for this very key; None where that is nothing, or is not as it was written."""
        try:
            kept = json.loads((self.folder / f"{name}.json").read_text(encoding="utf-8"))
            if kept["key"] != key or kept.pop("seal") != self._seal(name, kept):
                return None
            return Record(Image.open(self.picture_path(name)).linear, kept["facts"], kept["seconds"])
        except (OSError, ValueError, KeyError, TypeError, InputError):
            return None

    def save(self, name: str, key: str, record: Record) -> None:
        """Raises OutputError. The figures are written last: they vouch for the picture."""
        (self.folder / f"{name}.json").unlink(missing_ok=True)
        Image.from_linear(record.picture).save(self.picture_path(name))
        kept = {"key": key, "seconds": record.seconds, "facts": record.facts}
        write_json(self.folder / f"{name}.json", {**kept, "seal": self._seal(name, kept)})

    def _seal(self, name: str, kept: Mapping[str, Any]) -> str:
        """Of the picture and its figures: what was cut short or changed since is not taken for what was measured."""
        state = hashlib.blake2b(self.picture_path(name).read_bytes(), digest_size=12)
        state.update(json.dumps(kept, sort_keys=True).encode())
        return state.hexdigest()
