"""From a file to a Scene, whatever its format."""

from __future__ import annotations

from os import PathLike
from pathlib import Path

import numpy as np

from ..errors import InputError
from .gltf import load_gltf
from .scene import Scene

MAX_EXTENT = 1e18
"""Its square must fit a float32, in which shaders compute distances."""


def load_scene(path: str | PathLike[str], scene_index: int | None = None) -> Scene:
    """Read a model by what it is, not by what it is called; `scene_index` picks one of a glTF's scenes.

    Raises InputError for files that are missing, empty, of no known format or broken. No environment is loaded.
    """
    path = Path(path)
    scene = load_gltf(path, scene_index)
    if not np.abs(scene.bounds).max() < MAX_EXTENT:
        raise InputError(path, "", f"the model reaches beyond {MAX_EXTENT:g}; nothing that large can be drawn")
    return scene
