"""From a file to a Scene, whatever its format."""

from __future__ import annotations

import struct
from os import PathLike
from pathlib import Path

import numpy as np

from ..errors import InputError
from .files import read_file
from .gltf import load_gltf
from .scene import Scene

MAX_EXTENT = 1e18
"""Its square must fit a float32, in which shaders compute distances."""

_SIGNATURES = {b"glTF": "gltf", b"ply\n": "ply", b"ply\r": "ply", b"OFF": "off", b"solid ": "stl"}


def load_scene(path: str | PathLike[str], scene_index: int | None = None) -> Scene:
    """Read a model by what it is before what it is called; `scene_index` picks one of a glTF's scenes.

    Raises InputError for files that are missing, empty, of no known format or broken. No environment is loaded.
    """
    path = Path(path)
    data = read_file(path)
    kind = _format(path, data)
    # Numbers that overflow are found by checks of their own, not by numpy's warnings on stderr.
    with np.errstate(all="ignore"):
        if kind == "gltf":
            scene = load_gltf(path, data, scene_index)
        else:
            from .mesh_formats import load_mesh_file

            scene = load_mesh_file(path, data, kind)
        if not np.abs(scene.bounds).max() < MAX_EXTENT:
            raise InputError(path, "", f"the model reaches beyond {MAX_EXTENT:g}; nothing that large can be drawn")
    return scene


def _format(path: Path, data: bytes) -> str:
    """"gltf", or trimesh's name of another format."""
    if not data:
        raise InputError(path, "", "the file is empty")
    for signature, kind in _SIGNATURES.items():
        if data.startswith(signature):
            return kind
    suffix = path.suffix.lower().lstrip(".")
    if suffix in ("gltf", "glb") or data[:64].lstrip(b"\xef\xbb\xbf \t\r\n").startswith(b"{"):
        return "gltf"
    if len(data) >= 84 and len(data) == 84 + 50 * struct.unpack_from("<I", data, 80)[0]:
        return "stl"
    from .mesh_formats import mesh_formats

    known = mesh_formats()
    if suffix not in known:
        names = ", ".join(sorted({"gltf", "glb"} | known))
        raise InputError(path, "", f"not a model in a format that is known here ({names})")
    return suffix
