"""Names for pictures that are saved from a view."""

from __future__ import annotations

from pathlib import Path


def free_path(folder: Path, name: str) -> Path:
    """The first of `name-1.png`, `name-2.png`, ... that does not exist in `folder`. Characters that some file system
    does not allow become `_`."""
    stem = "".join(c if c.isalnum() or c in "-_. " else "_" for c in name).strip(" .") or "picture"
    number = 1
    while (path := folder / f"{stem}-{number}.png").exists():
        number += 1
    return path
