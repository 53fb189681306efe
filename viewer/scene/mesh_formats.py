"""Loads OBJ, PLY, STL, OFF and all other formats that trimesh reads as a Scene."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np

from ..errors import InputError
from .material import Material
from .obj import read_obj
from .off import read_off
from .ply import read_ply
from .raw_mesh import RawMesh, RawModel, finished, finite_part, shared_center
from .scene import Instance, Scene
from .stl import read_stl
from .texture_image import TextureImage
from .trimesh_formats import read_by_trimesh, trimesh_formats

_READERS: dict[str, Callable[[Path, bytes, list[str]], RawModel]] = {
    "obj": read_obj, "off": read_off, "ply": read_ply, "stl": read_stl, "stl_ascii": read_stl}


def mesh_formats() -> set[str]:
    """The file extensions, without dot, that are read here."""
    return set(_READERS) | trimesh_formats()


def load_mesh_file(path: Path, data: bytes, kind: str) -> Scene:
    """Read `data`, the content of `path`, as the format `kind`, one of `mesh_formats()`. Units are not converted.

    Textures and material files are read only from the model's folder; a missing one is left out with a warning. A model
    far from the origin is placed there by its instances, since positions are float32 and transforms float64. Raises
    InputError if the file cannot be read or contains nothing to draw.
    """
    warnings: list[str] = []
    reader = _READERS.get(kind)
    return scene_of(path, kind, reader(path, data, warnings) if reader else read_by_trimesh(path, data, kind, warnings),
                    warnings)


def scene_of(path: Path, kind: str, model: RawModel, warnings: list[str]) -> Scene:
    """The scene of what a reader has found in `path`. Raises InputError if that is nothing to draw."""
    parts = [part for mesh in model.meshes for part in [finite_part(mesh, warnings)] if part is not None]
    if not parts:
        problem = "; ".join(["the file contains nothing to draw", *warnings[:1]])
        raise InputError(path, "", problem)
    return replace(assembled(path.stem, kind.upper(), parts, model.images), warnings=tuple(warnings))


def assembled(name: str, kind: str, parts: Sequence[RawMesh], images: Sequence[TextureImage] = ()) -> Scene:
    """A scene of meshes whose positions are finite. Those far from the origin are placed there by their instances,
    since positions are float32 and transforms float64."""
    center = shared_center(parts)
    transform = np.eye(4)
    transform[:3, 3] = center
    materials: list[Material] = []
    meshes = []
    for part in parts:
        if part.material not in materials:
            materials.append(part.material)
        meshes.append(finished(part, center, materials.index(part.material)))
    instances = tuple(Instance(k, transform, mesh.name) for k, mesh in enumerate(meshes))
    told = [{"name": image.name, "format": image.format, "width": image.width, "height": image.height,
             "bits": image.bits} for image in images]
    facts = {"format": kind, "meshes": len(meshes), "materials": len(materials), "images": told}
    return Scene(name, tuple(meshes), tuple(materials), instances, facts=facts)
