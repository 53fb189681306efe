"""Loads a model, a volume or curves of any supported format as a Scene."""

from __future__ import annotations

import struct
from os import PathLike
from pathlib import Path

import numpy as np

from ..errors import InputError, UsageError
from .files import read_file
from .gltf import load_gltf
from .scene import MAX_EXTENT, Scene

_SIGNATURES = {b"glTF": "gltf", b"ply\n": "ply", b"ply\r": "ply", b"OFF": "off", b"solid ": "stl",
               b" BDV\0\0\0\0": "vdb", b"VOL": "vol", b"HAIR": "hair", b"BCC": "bcc"}

VOLUME_FORMATS = ("vdb", "npz", "vol")
CURVE_FORMATS = ("hair", "bcc", "curves")


def load_scene(path: str | PathLike[str], scene: int | str | None = None, variant: str | None = None) -> Scene:
    """Load a file of a model, volumes or curves. `scene` selects one of the scenes of a glTF file by its number or
    name, by default the file's default scene; `variant` selects one of the file's choices of materials.

    The content determines the format; the file's extension is used only if the content does not. No environment is
    loaded. Raises InputError for files that are missing, empty, broken or of an unknown format, or that have no such
    scene or variant.
    """
    path = Path(path)
    data = read_file(path)
    kind = _format(path, data)
    # Explicit checks find numbers that overflow; numpy would also print warnings.
    with np.errstate(all="ignore"):
        if kind == "gltf":
            loaded = load_gltf(path, data, scene)
        elif scene not in (None, 0):
            raise InputError(path, "", f"there is no scene {scene!r}; only glTF has several")
        elif kind in VOLUME_FORMATS:
            from .volume_files import load_volume_file

            loaded = load_volume_file(path, data, kind)
        elif kind in CURVE_FORMATS:
            from .curve_files import load_curve_file

            loaded = load_curve_file(path, data, kind)
        else:
            from .mesh_formats import load_mesh_file

            loaded = load_mesh_file(path, data, kind)
        if not np.abs(loaded.bounds).max() < MAX_EXTENT:
            raise InputError(path, "", f"the model has coordinates beyond {MAX_EXTENT:g}, which cannot be drawn")
    if variant is None:
        return loaded
    try:
        return loaded.with_variant(variant)
    except UsageError as error:
        raise InputError(path, "variants" if loaded.variants else "", str(error)) from error


def _format(path: Path, data: bytes) -> str:
    """The file's format: "gltf", one of VOLUME_FORMATS or CURVE_FORMATS, or trimesh's name of another one."""
    if not data:
        raise InputError(path, "", "the file is empty")
    for signature, kind in _SIGNATURES.items():
        if data.startswith(signature):
            return kind
    suffix = path.suffix.lower().lstrip(".")
    if suffix in VOLUME_FORMATS + CURVE_FORMATS:
        return suffix
    if suffix in ("gltf", "glb") or data[:64].lstrip(b"\xef\xbb\xbf \t\r\n").startswith(b"{"):
        return "gltf"
    if len(data) >= 84 and len(data) == 84 + 50 * struct.unpack_from("<I", data, 80)[0]:
        return "stl"
    from .mesh_formats import mesh_formats
    from .trimesh_formats import OPTIONAL

    known = mesh_formats()
    if suffix in OPTIONAL - known:
        raise InputError(path, "", f"{suffix.upper()} needs packages that are not installed: "
                                   "pip install 'pbr-viewer[formats]'")
    if suffix not in known:
        names = ", ".join(sorted({"gltf", "glb", *VOLUME_FORMATS, *CURVE_FORMATS} | known))
        raise InputError(path, "", f"is not a model in a supported format ({names})")
    return suffix
