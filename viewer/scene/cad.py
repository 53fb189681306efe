"""Reads STEP (ISO 10303-21), solids of CAD bounded by curved faces, as triangles."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

from ..base.apart import Apart, ApartError
from ..errors import InputError
from .gltf import load_gltf
from .material import Material
from .mtl import PLAIN
from .scene import Scene

_SECONDS, _SECONDS_PER_BYTE = 60.0, 2e-5
_BYTES, _BYTES_PER_BYTE = 1 << 30, 200
apart = Apart()
"""A process of its own: Open CASCADE takes more address space than the other decoders may."""


def load_cad(path: Path, data: bytes) -> Scene:
    """Read `data`, the content of `path`, as STEP, by Open CASCADE in another process (`pbr-viewer[cad]`).

    Lengths are converted to metres, by the unit that the file names; its axes are left as they are. Files that it
    refers to are not read. Raises InputError for a file that is broken or has no faces.
    """
    try:
        made = apart.call("viewer.scene.decoders:step", data, _SECONDS + _SECONDS_PER_BYTE * len(data),
                          _BYTES + _BYTES_PER_BYTE * len(data))
    except ApartError as error:
        raise InputError(path, "", f"cannot be read as STEP: it {error}") from error
    scene = load_gltf(path, made["bytes"].tobytes())
    if not scene.meshes:
        raise InputError(path, "", "the file contains nothing to draw")
    materials = tuple(_material(material) for material in scene.materials)
    return replace(scene, materials=materials, facts={**scene.facts, "format": "STEP"})


def _material(material: Material) -> Material:
    """STEP has colours alone; what has none is glTF's default material here."""
    color = material.base_color if material.name else PLAIN.base_color
    return replace(PLAIN, name=material.name, base_color=color, alpha_mode=material.alpha_mode)
