"""Measurements on disk, each written when it is done, so that none is repeated."""

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
    """A picture, (H, W, 4) float32 linear radiance, its measurements, and the `seconds` that measuring took."""

    picture: np.ndarray
    facts: dict[str, Any] = field(default_factory=dict)
    seconds: float = 0.0


class Store:
    """Records in `folder`, each as NAME.exr and NAME.json, which holds the key of what the record depends on.

    The folder is made if it is missing, but not the folder above it. Raises OutputError.
    """

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        make_folder(folder)

    def picture_path(self, name: str) -> Path:
        return self.folder / f"{name}.exr"

    def load(self, name: str, key: str) -> Record | None:
        """The record with this name and key; None if there is none, or if it was changed since it was written."""
        try:
            kept = json.loads((self.folder / f"{name}.json").read_text(encoding="utf-8"))
            if kept["key"] != key or kept.pop("seal") != self._seal(name, kept):
                return None
            return Record(Image.open(self.picture_path(name)).linear, kept["facts"], kept["seconds"])
        except (OSError, ValueError, KeyError, TypeError, InputError):
            return None

    def save(self, name: str, key: str, record: Record) -> None:
        """Raises OutputError. NAME.json is written last: without it the picture does not count."""
        (self.folder / f"{name}.json").unlink(missing_ok=True)
        Image.from_linear(record.picture).save(self.picture_path(name))
        kept = {"key": key, "seconds": record.seconds, "facts": record.facts}
        write_json(self.folder / f"{name}.json", {**kept, "seal": self._seal(name, kept)})

    def _seal(self, name: str, kept: Mapping[str, Any]) -> str:
        """A checksum of the picture and its measurements, which shows if a file is incomplete or was changed."""
        state = hashlib.blake2b(self.picture_path(name).read_bytes(), digest_size=12)
        state.update(json.dumps(kept, sort_keys=True).encode())
        return state.hexdigest()
