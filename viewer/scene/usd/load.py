"""Loads USD as a Scene."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from ...base.apart import Apart, ApartError, Arrays
from ...errors import InputError, UsageError
from ..curves import CurveKind, Curves
from ..material import Material
from ..mesh_formats import scene_of
from ..mtl import PLAIN
from ..raw_mesh import RawMesh, RawModel, colored, cut_polygons
from ..scene import Scene
from .materials import Materials, transformed

_SECONDS, _SECONDS_PER_BYTE = 60.0, 1e-5
_BYTES, _BYTES_PER_BYTE = 1 << 31, 60
apart = Apart()
"""A process of its own: OpenUSD takes more address space than the other decoders may."""


def load_usd(path: Path, data: bytes) -> Scene:
    """Read a .usd, .usda, .usdc or .usdz file with all layers that it names, at its first moment.

    Meshes with UsdPreviewSurface, and BasisCurves, in metres with +Y up. Raises InputError for a file that is broken,
    has nothing to draw, or asks for layers outside of its folder.
    """
    size = len(data)
    try:
        arrays = apart.call("viewer.scene.usd.stage:read", b"", _SECONDS + _SECONDS_PER_BYTE * size,
                            _BYTES + _BYTES_PER_BYTE * size, path=str(path.absolute()),
                            folder=str(path.parent.resolve()))
    except ApartError as error:
        raise InputError(path, "", f"cannot be read as USD: it {error}") from error
    told = json.loads(arrays["json"].tobytes())
    warnings: list[str] = told["warnings"]
    materials = Materials(path, told["materials"], warnings)
    meshes, curves = [], []
    for number, part in enumerate(told["parts"]):
        own = {name: arrays[f"{number}.{name}"] for name in part["arrays"]}
        if part["kind"] == "mesh":
            meshes.append(_mesh(part, own, materials, warnings))
        else:
            curves.append(_curves(path, part, own, materials))
    facts: dict[str, object] = {"format": "USD"}
    if not meshes and curves:
        return Scene(path.stem, curves=tuple(curves), warnings=tuple(warnings), facts=facts)
    scene = scene_of(path, "usd", RawModel(meshes, materials.images), warnings)
    return replace(scene, curves=tuple(curves))


def _mesh(part: dict[str, Any], arrays: Arrays, materials: Materials, warnings: list[str]) -> RawMesh:
    points, corners, sizes = arrays["points"], arrays["corners"], arrays["sizes"]
    triangles, _ = cut_polygons(points, corners, sizes, warnings)
    indices = corners[triangles].reshape(-1, 3)
    if part["is_left"]:
        indices = indices[:, ::-1]
    uvs, colors = arrays.get("uvs"), arrays.get("colors")
    if part["material"] is None:
        material, uv = colored(PLAIN, colors), None
    else:
        material, uv = materials.of(part["material"], uvs is not None)
        colors = None
    material = replace(material, double_sided=material.double_sided or part["is_two_sided"])
    return RawMesh(part["name"], points, "triangles", indices.ravel(), arrays.get("normals"),
                   uvs if uvs is None or uv is None else transformed(uvs, uv), colors, material)


def _curves(path: Path, part: dict[str, Any], arrays: Arrays, materials: Materials) -> Curves:
    colors = arrays.get("colors")
    if colors is None and part["material"] is not None:
        material: Material = materials.of(part["material"], has_uvs=False)[0]
        colors = np.broadcast_to(np.array(material.base_color[:3]), arrays["points"].shape)
    kind: CurveKind = part["kind"]
    strands = len(arrays["offsets"]) - 1
    try:
        return Curves(part["name"], arrays["points"], arrays["radii"], arrays["offsets"],
                      np.full(strands, part["is_closed"]), kind, None if colors is None else np.clip(colors, 0, 1))
    except UsageError as error:
        raise InputError(path, part["name"], str(error)) from error
