"""A scene of arrays, or of an object of trimesh: `viewer.scene`."""

from __future__ import annotations

from dataclasses import replace
from os import PathLike, fspath
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from ..base.expect import expect, expect_path
from ..errors import UsageError
from .arrays import scene_array
from .material import Material
from .mesh_formats import assembled
from .mtl import PLAIN
from .raw_mesh import RawMesh, colored, linear_colors
from .scene import MAX_EXTENT, Scene
from .upright import up_matrix, upright

_ROUNDING = 1e-3
"""How far a colour may be beyond 0 and 1: it has been interpolated or converted."""


def make_scene(vertices: Any, faces: ArrayLike | None = None, *, normals: ArrayLike | None = None,
               uvs: ArrayLike | None = None, colors: ArrayLike | None = None, material: Material | None = None,
               name: str = "scene", environment: str | PathLike[str] | None = "studio", up: str = "y") -> Scene:
    """A scene of one mesh, or of a `trimesh.Trimesh`, `PointCloud` or `Scene` in place of `vertices`.

    `vertices` (N, 3) are positions, and `faces` (M, 3) the numbers of the corners of triangles, counter-clockwise seen
    from outside; without faces the vertices are points. `normals` (N, 3) may have any length; without them, normals are
    computed, and sharp edges stay sharp. `uvs` (N, 2) are texture coordinates, v upwards as in OBJ. `colors` are of
    vertices, (N, 3 or 4), or of faces, (M, 3 or 4): sRGB if they are uint8 or uint16, linear and from 0 to 1 if they
    are floats. Arrays may have any type of numbers, and may be lists. `material` is grey by default, or white with
    `colors`.

    `environment` and `up` are as in `viewer.load`. Objects of trimesh have their own texture coordinates, colours and
    materials, of which the base colour with its image, metalness and roughness are used; a `material` replaces them.
    Their normals are computed again.

    Raises UsageError for arrays of other shapes, for numbers that are not finite, and for faces with vertices that do
    not exist.
    """
    from .environment_files import load_environment

    up_matrix(up)  # an error about it comes first
    expect(material, (Material, type(None)), "material", "a Material")
    expect(name, str, "name", "text")
    if environment is not None:
        expect_path(environment, "environment")
    given = {"faces": faces, "normals": normals, "uvs": uvs, "colors": colors}
    warnings: list[str] = []
    if not isinstance(vertices, np.ndarray) and any(kind.__module__.partition(".")[0] == "trimesh"
                                                    for kind in type(vertices).__mro__):
        from .from_trimesh import meshes_of

        extra = [key for key, value in given.items() if value is not None]
        if extra:
            raise UsageError(f"{extra[0]}: a {type(vertices).__name__} of trimesh has its own")
        meshes = meshes_of(vertices, warnings)
    else:
        meshes = [_mesh(vertices, name, **given)]
    if material is not None:
        meshes = [replace(mesh, material=material) for mesh in meshes]
    spec = environment if environment is None else fspath(environment)
    made = assembled(name, "arrays", meshes)
    if not np.abs(made.bounds).max() < MAX_EXTENT:
        raise UsageError(f"vertices: the model has coordinates beyond {MAX_EXTENT:g}, which cannot be drawn")
    return upright(replace(made, warnings=tuple(warnings), environment=load_environment(spec)), up)


def _mesh(vertices: Any, name: str, faces: Any, normals: Any, uvs: Any, colors: Any) -> RawMesh:
    positions = scene_array(vertices, "vertices", np.float64, None, 3)
    count, corners = len(positions), None
    if not count:
        raise UsageError("vertices: there are none")
    if faces is not None:
        corners = scene_array(faces, "faces", np.uint32, None, 3)
        if not len(corners):
            raise UsageError("faces: there are none; without `faces` the vertices are points")
        if corners.max() >= count:
            face = int(corners.max(axis=1).argmax())
            raise UsageError(f"faces[{face}] is {corners[face].tolist()}, but there are {count} vertices")
    mesh = RawMesh(name, positions, "points" if corners is None else "triangles",
                   None if corners is None else corners.ravel())
    if normals is not None:
        given = scene_array(normals, "normals", np.float64, count, 3)
        largest = np.abs(given).max(axis=1, keepdims=True)  # without it squares of their lengths may overflow
        mesh = replace(mesh, normals=given / np.where(largest > 0, largest, 1))
    if uvs is not None:
        mesh = replace(mesh, uvs=scene_array(uvs, "uvs", np.float64, count, 2))
    return mesh if colors is None else with_colors(mesh, colors)


def with_colors(mesh: RawMesh, colors: Any) -> RawMesh:
    """The mesh with `colors` of its vertices or of its faces, see `make_scene`."""
    count, faces = len(mesh.positions), 0 if mesh.indices is None else len(mesh.indices) // 3
    array = np.asarray(colors) if isinstance(colors, (np.ndarray, list, tuple)) else colors
    found = np.shape(array)
    columns = 4 if len(found) == 2 and found[1] == 4 else 3
    of_faces = len(found) == 2 and found[0] == faces != count
    values = scene_array(array, "colors", np.float64, faces if of_faces else count, columns)
    dtype = np.asarray(array).dtype
    if dtype.kind == "u" and dtype.itemsize <= 2:  # in any order of bytes
        linear = linear_colors(values, np.iinfo(dtype).max)
    elif dtype.kind in "iu" and values.size and values.max() > 1:
        raise UsageError(f"colors: {found} {dtype}: whole numbers above 1 are of uint8 or uint16")
    else:
        if values.size and values.min() < -_ROUNDING:
            raise UsageError("colors: a colour is not negative")
        if values.size and values.max() > 1 + _ROUNDING:
            raise UsageError(f"colors: floats are from 0 to 1, and one is {values.max():g}; make those up to 255 uint8")
        linear = np.ones((len(values), 4), np.float32)
        linear[:, :columns] = values.clip(0, 1)
    if of_faces and mesh.indices is not None:  # each triangle gets corners of its own
        linear = np.repeat(linear, 3, axis=0)
        mesh = replace(mesh.picked(mesh.indices), indices=None)
    return replace(mesh, colors=linear, material=colored(PLAIN, linear))
