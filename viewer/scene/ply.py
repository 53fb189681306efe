"""PLY, ASCII and binary in either byte order, with the properties that scanners and modellers write."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np

from ..errors import InputError
from .files import path_inside, read_file
from .mtl import PLAIN
from .ply_elements import Element, read_elements
from .raw_mesh import RawMesh, RawModel, colored, cut_polygons, linear_colors, textured
from .texture_image import MESH_FORMATS, TextureImage, open_texture_image

_COLORS = (("red", "green", "blue", "alpha"), ("r", "g", "b", "a"),
           ("diffuse_red", "diffuse_green", "diffuse_blue", "diffuse_alpha"))
_UVS = (("texture_u", "texture_v"), ("u", "v"), ("s", "t"), ("texture_s", "texture_t"))


def read_ply(path: Path, data: bytes, warnings: list[str]) -> RawModel:
    """Meshes of faces and edges; points where there are neither. Raises InputError as `read_elements` does, and about
    what makes no mesh."""
    elements, textures = read_elements(path, data)
    unread = [name for name, e in elements.items() if e.count and name not in ("vertex", "face", "edge")]
    warnings += [f"element {name[:40]}: not supported; it is left out" for name in unread]

    vertex = elements.get("vertex")
    positions = vertex.columns(("x", "y", "z")) if vertex is not None else None
    if vertex is None or positions is None:
        raise InputError(path, "header", "there is no element vertex with x, y and z")
    colors = _colors(vertex, warnings)
    uvs = next((columns for columns in map(vertex.columns, _UVS) if columns is not None), None)
    base = RawMesh(path.stem, positions.astype(np.float64), "points", None, vertex.columns(("nx", "ny", "nz")), uvs,
                   colors, colored(PLAIN, colors))
    faces = _faces(path, base, elements["face"], warnings) if "face" in elements else None
    edges = _edges(path, base, elements["edge"]) if "edge" in elements else None
    images: list[TextureImage] = []
    if faces is not None and faces.uvs is not None and textures:
        if len(textures) > 1:
            warnings.append(f"{len(textures)} texture files; only {textures[0][:80]!r} is used")
        try:
            texture = path_inside(path, textures[0].replace("\\", "/"), "")
            images.append(open_texture_image(read_file(texture), str(texture), MESH_FORMATS))
            faces = replace(faces, material=textured(PLAIN, images[0]), colors=None)
        except InputError as error:
            warnings.append(f"{error.problem}; it is left out")
    return RawModel([mesh for mesh in (faces, edges) if mesh is not None] or [base], images)


def _colors(element: Element, warnings: list[str]) -> np.ndarray | None:
    """(count, 4) linear colours or None. Integers are full at their type's largest number."""
    for names in _COLORS:
        columns = element.columns(names) if names[3] in element.scalars else element.columns(names[:3])
        if columns is not None:
            return linear_colors(columns, {"u1": 255.0, "u2": 65535.0}.get(element.kind(names[0])), warnings)
    return None


def _faces(path: Path, base: RawMesh, element: Element, warnings: list[str]) -> RawMesh | None:
    """The faces as triangles, or None where there are none. Colours and texture coordinates of faces come first."""
    if not element.count:
        return None
    name = next((name for name in ("vertex_indices", "vertex_index") if name in element.lists), None)
    if name is None:
        raise InputError(path, "element face", "there is no list vertex_indices")
    values, sizes = element.lists[name]
    corners = _vertex_numbers(path, "face", values, np.repeat(np.arange(len(sizes)), sizes), len(base.positions))
    kept, face = cut_polygons(base.positions, corners, sizes, warnings)
    if not len(kept):
        return None
    mesh = replace(base, topology="triangles", indices=corners[kept])
    uvs, uv_sizes = element.lists.get("texcoord", (None, None))
    if uvs is not None and uv_sizes is not None:
        has_uvs = uv_sizes == 2 * sizes
        if not has_uvs.all():
            warnings.append("texcoord: some faces have none, or not two numbers for each corner; all are left out")
            uvs = None
    colors = _colors(element, warnings) if base.colors is None else None
    if uvs is None and colors is None:
        return mesh
    mesh = replace(mesh.picked(corners[kept]), indices=None)
    if uvs is not None:
        mesh = replace(mesh, uvs=uvs.reshape(-1, 2)[kept].astype(np.float64))
    if colors is not None:
        colors = np.repeat(colors[face], 3, axis=0)
        mesh = replace(mesh, colors=colors, material=colored(PLAIN, colors))
    return mesh


def _edges(path: Path, base: RawMesh, element: Element) -> RawMesh | None:
    ends = element.columns(("vertex1", "vertex2"))
    if ends is None or not len(ends):
        return None
    edge = np.repeat(np.arange(len(ends)), 2)
    indices = _vertex_numbers(path, "edge", ends.reshape(-1), edge, len(base.positions))
    return replace(base, topology="lines", indices=indices)


def _vertex_numbers(path: Path, what: str, values: np.ndarray, owner: np.ndarray, count: int) -> np.ndarray:
    """The values as integers. Raises InputError about one that is not the number of a vertex."""
    wrong = ~((values >= 0) & (values < count))
    if wrong.any():
        at = int(wrong.argmax())
        raise InputError(path, f"{what} {owner[at]}", f"vertex {values[at]:.15g} of {count}, which count from 0")
    return values.astype(np.int64)
