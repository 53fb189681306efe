"""Finds the models of a folder."""

from __future__ import annotations

import os
from pathlib import Path

MODEL_ENDINGS = frozenset((".gltf", ".glb", ".obj", ".off", ".ply", ".stl", ".xyz", ".3mf", ".dae", ".step", ".stp",
                           ".usd", ".usda", ".usdc", ".usdz", ".vdb", ".vol", ".hair", ".bcc", ".curves"))
"""What models end in. An .npz may be a volume, but layers and tables are commoner, so it has to be named."""


def models_in(folder: Path) -> list[Path]:
    """The models of a folder and of those inside of it, in the order of their names; what begins with a dot is
    hidden."""
    found = []
    for place, folders, files in os.walk(folder):
        folders[:] = sorted(name for name in folders if not name.startswith("."))
        found += [Path(place, name) for name in sorted(files)
                  if not name.startswith(".") and os.path.splitext(name)[1].lower() in MODEL_ENDINGS]
    return found
