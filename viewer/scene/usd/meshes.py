"""Meshes of a stage as arrays in the space of the prim; runs in the other process."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import Any

import numpy as np
from pxr import Usd, UsdGeom, UsdShade

Arrays = dict[str, np.ndarray]
_BY_CORNER = (UsdGeom.Tokens.uniform, UsdGeom.Tokens.faceVarying)


def read_mesh(prim: Usd.Prim, time: Usd.TimeCode,
              uv_name: Callable[[str], str]) -> Iterator[tuple[str, Arrays, bool]]:
    """The pieces of a mesh, each with the path of its material ("" for none), its arrays, and whether it is a
    subdivision surface.

    `points` (N, 3), `corners` (C,) their numbers, `sizes` (F,) of the faces, and if there are such `normals`, `uvs` and
    `colors` (linear, with opacity) for each point, or, if one of them is by face or corner, for each corner: then
    `points` are so, too. `uv_name` says the name of the texture coordinates of a material. Raises ValueError for arrays
    that do not fit together.
    """
    mesh = UsdGeom.Mesh(prim)
    points = _floats(mesh.GetPointsAttr().Get(time), 3)
    sizes = np.asarray(mesh.GetFaceVertexCountsAttr().Get(time) or (), np.int64)
    corners = np.asarray(mesh.GetFaceVertexIndicesAttr().Get(time) or (), np.int64)
    place = prim.GetPath()
    if sizes.min(initial=0) < 0 or sizes.sum() != len(corners):
        raise ValueError(f"has at {place} faceVertexCounts for {sizes.sum()} corners, and {len(corners)} "
                         "faceVertexIndices")
    if corners.min(initial=0) < 0 or corners.max(initial=-1) >= len(points):
        raise ValueError(f"has at {place} a number in faceVertexIndices that is not in 0..{len(points) - 1}")
    holes = np.asarray(mesh.GetHoleIndicesAttr().Get(time) or (), np.int64)
    solid = np.ones(len(sizes), bool)
    solid[holes[(holes >= 0) & (holes < len(sizes))]] = False
    is_subdivided = mesh.GetSubdivisionSchemeAttr().Get(time) != UsdGeom.Tokens.none
    bound, _ = UsdShade.MaterialBindingAPI(prim).ComputeBoundMaterial()
    rest = solid.copy()
    parts = []
    for subset in UsdShade.MaterialBindingAPI(prim).GetMaterialBindSubsets():
        faces = np.asarray(subset.GetIndicesAttr().Get(time) or (), np.int64)
        faces = faces[(faces >= 0) & (faces < len(sizes))]
        of_subset, _ = UsdShade.MaterialBindingAPI(subset.GetPrim()).ComputeBoundMaterial()
        parts.append((_path(of_subset) or _path(bound), np.intersect1d(faces, np.flatnonzero(rest))))
        rest[faces] = False
    parts.append((_path(bound), np.flatnonzero(rest)))
    for material, faces in parts:
        if len(faces):
            found = _attributes(mesh, time, uv_name(material))
            has_normals = any(name == "normals" for name, _, _ in found)
            yield material, _piece(points, sizes, corners, faces, found), is_subdivided and not has_normals


def _path(material: UsdShade.Material) -> str:
    return str(material.GetPath()) if material else ""


def _attributes(mesh: UsdGeom.Mesh, time: Usd.TimeCode, uv_name: str) -> list[tuple[str, np.ndarray, str]]:
    """Name, values (N, K) and interpolation of what the mesh has."""
    found = []
    primvars = UsdGeom.PrimvarsAPI(mesh)
    normals = primvars.GetPrimvar("normals")  # goes before the attribute
    if normals and normals.HasAuthoredValue():
        found.append(("normals", _floats(normals.ComputeFlattened(time), 3), normals.GetInterpolation()))
    elif mesh.GetNormalsAttr().HasAuthoredValue():
        found.append(("normals", _floats(mesh.GetNormalsAttr().Get(time), 3), mesh.GetNormalsInterpolation()))
    for name, key, columns in (("uvs", uv_name, 2), ("colors", "displayColor", 3), ("opacity", "displayOpacity", 1)):
        primvar = primvars.FindPrimvarWithInheritance(key)
        if primvar and primvar.HasAuthoredValue():
            found.append((name, _floats(primvar.ComputeFlattened(time), columns), primvar.GetInterpolation()))
    return found


def _piece(points: np.ndarray, sizes: np.ndarray, corners: np.ndarray, faces: np.ndarray,
           found: list[tuple[str, np.ndarray, str]]) -> Arrays:
    """The arrays of some faces. Attributes whose length does not fit are left out."""
    is_of = np.repeat(np.isin(np.arange(len(sizes)), faces), sizes)
    used = corners[is_of]
    by_corner = any(interpolation in _BY_CORNER for _, _, interpolation in found)
    source, renumbered = (used, np.arange(len(used))) if by_corner else np.unique(used, return_inverse=True)
    arrays: Arrays = {"points": points[source], "corners": renumbered.astype(np.int64), "sizes": sizes[faces]}
    for name, values, interpolation in found:
        if interpolation == UsdGeom.Tokens.constant and len(values):
            arrays[name] = np.broadcast_to(values[0], (len(source), values.shape[1]))
        elif interpolation == UsdGeom.Tokens.uniform and len(values) == len(sizes):
            arrays[name] = np.repeat(values, sizes, axis=0)[is_of]
        elif interpolation == UsdGeom.Tokens.faceVarying and len(values) == len(corners):
            arrays[name] = values[is_of]
        elif interpolation in (UsdGeom.Tokens.vertex, UsdGeom.Tokens.varying) and len(values) == len(points):
            arrays[name] = values[source]
    opacity = arrays.pop("opacity", None)
    if "colors" in arrays:
        alpha = np.ones((len(source), 1)) if opacity is None else opacity
        arrays["colors"] = np.concatenate([arrays["colors"], alpha], axis=1)
    return arrays


def _floats(values: Any, columns: int) -> np.ndarray:
    """(N, columns) float64; none of the values where they are of another kind."""
    try:
        return np.asarray(() if values is None else values, np.float64).reshape(-1, columns)
    except (TypeError, ValueError):
        return np.zeros((0, columns))
