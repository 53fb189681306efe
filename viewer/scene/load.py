"""Loads a model, a volume or curves of any supported format as a Scene."""

from __future__ import annotations

import struct
from importlib.util import find_spec
from os import PathLike
from pathlib import Path

import numpy as np

from ..errors import InputError, UsageError
from .environment_files import FORMATS as ENVIRONMENT_FORMATS
from .files import read_file
from .gltf import load_gltf
from .scene import MAX_EXTENT, Scene

_SIGNATURES = {b"glTF": "gltf", b"ply\n": "ply", b"ply\r": "ply", b"OFF": "off", b"solid ": "stl",
               b" BDV\0\0\0\0": "vdb", b"VOL": "vol", b"HAIR": "hair", b"BCC": "bcc", b"ISO-10303-21": "step"}

VOLUME_FORMATS = ("vdb", "npz", "vol")
CURVE_FORMATS = ("hair", "bcc", "curves")
CAD_FORMATS = ("step", "stp")
USD_FORMATS = ("usd", "usda", "usdc", "usdz")
_PACKAGES = dict.fromkeys(CAD_FORMATS, ("cascadio", "cad")) | dict.fromkeys(USD_FORMATS, ("pxr", "usd"))
"""The package that a format needs, and the extra that brings it."""


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
        elif kind in CAD_FORMATS:
            from .cad import load_cad

            loaded = load_cad(path, data)
        elif kind in USD_FORMATS:
            from .usd.load import load_usd

            loaded = load_usd(path, data)
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


def optional_formats() -> set[str]:
    """The formats whose packages are there, though not everywhere."""
    return {kind for kind, (package, _) in _PACKAGES.items() if find_spec(package) is not None}


def _format(path: Path, data: bytes) -> str:
    """The file's format, whose packages are there: "gltf", one of those above, or trimesh's name of another one."""
    kind = _found_format(path, data)
    package, extra = _PACKAGES.get(kind, (None, ""))
    if package is not None and find_spec(package) is None:
        raise _missing(path, kind, extra)
    return kind


def _missing(path: Path, kind: str, extra: str) -> InputError:
    return InputError(path, "", f"{kind.upper()} needs packages that are not installed: "
                                f"pip install 'pbr-viewer[{extra}]'")


def _found_format(path: Path, data: bytes) -> str:
    if not data:
        raise InputError(path, "", "the file is empty")
    for signature, kind in _SIGNATURES.items():
        if data.startswith(signature):
            return kind
    suffix = path.suffix.lower().lstrip(".")
    if suffix in (*VOLUME_FORMATS, *CURVE_FORMATS, *_PACKAGES):
        return suffix
    if suffix in ("gltf", "glb") or data[:64].lstrip(b"\xef\xbb\xbf \t\r\n").startswith(b"{"):
        return "gltf"
    if len(data) >= 84 and len(data) == 84 + 50 * struct.unpack_from("<I", data, 80)[0]:
        return "stl"
    from .mesh_formats import mesh_formats
    from .trimesh_formats import OPTIONAL

    known = mesh_formats()
    if suffix in OPTIONAL - known:
        raise _missing(path, suffix, "formats")
    if f".{suffix}" in ENVIRONMENT_FORMATS:
        raise InputError(path, "", "is a picture, not a model; to light a model with it, give it with --env, or in "
                                   "Python as environment=")
    if suffix not in known:
        names = ", ".join(sorted({"gltf", "glb", *VOLUME_FORMATS, *CURVE_FORMATS, *_PACKAGES} | known))
        raise InputError(path, "", f"is not a model in a supported format ({names})")
    return suffix
