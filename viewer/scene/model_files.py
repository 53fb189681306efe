"""Finds the models of a folder."""

from __future__ import annotations

import os
from collections.abc import Iterator
from contextlib import suppress
from pathlib import Path

MODEL_ENDINGS = frozenset((".gltf", ".glb", ".obj", ".off", ".ply", ".stl", ".xyz", ".3mf", ".dae", ".step", ".stp",
                           ".usd", ".usda", ".usdc", ".usdz", ".vdb", ".vol", ".hair", ".bcc", ".curves"))
"""What models end in. An .npz may be a volume, but layers and tables are commoner, so it has to be named."""


def models_in(folder: Path) -> list[Path]:
    """The models of a folder and of those inside of it, also behind symbolic links, in the order of their names; what
    begins with a dot is hidden."""
    return list(_models(folder, frozenset()))


def _models(folder: Path, above: frozenset[str]) -> Iterator[Path]:
    """`above` are the real paths of the folders that this one is in, to which a link may lead back."""
    real = os.path.realpath(folder)
    if real in above:
        return
    with suppress(OSError):
        names = sorted(name for name in os.listdir(folder) if not name.startswith("."))
        folders = {name for name in names if os.path.isdir(folder / name)}
        for name in names:
            if name not in folders and os.path.splitext(name)[1].lower() in MODEL_ENDINGS:
                yield folder / name
        for name in names:
            if name in folders:
                yield from _models(folder / name, above | {real})
