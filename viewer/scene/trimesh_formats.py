"""Mesh formats that are read by trimesh: XYZ, and those of the optional packages `pbr-viewer[formats]`."""

from __future__ import annotations

import io
import logging
import zipfile
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from ..base.quiet import without_warnings
from ..errors import InputError
from .files import path_inside, read_file
from .mtl import PLAIN
from .raw_mesh import RawMesh, RawModel, colored, linear_colors, textured
from .texture_image import MESH_FORMATS, TextureImage, open_texture_image

_NOT_BY_TRIMESH = {"glb", "gltf", "obj", "off", "ply", "stl", "stl_ascii"}
_ARCHIVES = {"zip", "bz2", "tar.bz2", "tar.gz"}
OPTIONAL = {"3mf", "dae", "zae", "3dxml", "xaml"}
"""Formats that need the packages of the extra `formats`."""
_MOST_UNPACKED = 1 << 31


def trimesh_formats() -> set[str]:
    """The file extensions, without dot, that are left to trimesh."""
    from trimesh.exchange.load import mesh_formats

    return set(mesh_formats()) - _NOT_BY_TRIMESH - _ARCHIVES


def read_by_trimesh(path: Path, data: bytes, kind: str, warnings: list[str]) -> RawModel:
    """A mesh for each instance. Raises InputError if trimesh cannot read the file."""
    with _as_input_error(path, kind):
        import trimesh

        _check_archive(path, data)

        files = _Files(path, warnings)
        loaded = trimesh.load_scene(io.BytesIO(data), file_type=kind, process=False,
                                    resolver=files)  # type: ignore[arg-type]  # trimesh calls only `get`
        meshes = []
        for node in loaded.graph.nodes_geometry:
            transform, name = loaded.graph[node]
            name = str(name)
            title = path.stem if name.startswith("geometry") else Path(name).name
            mesh = _mesh(path, title, loaded.geometry[name], np.array(transform, np.float64), files)
            if mesh is not None:
                meshes.append(mesh)
        return RawModel(meshes, files.images)


def _check_archive(path: Path, data: bytes) -> None:
    """Raises InputError about a zip file, as 3MF and ZAE are, of a few kilobytes that declares gigabytes."""
    if zipfile.is_zipfile(io.BytesIO(data)):
        size = sum(item.file_size for item in zipfile.ZipFile(io.BytesIO(data)).infolist())
        if size > _MOST_UNPACKED:
            raise InputError(path, "", f"unpacks to {size} bytes; the limit is {_MOST_UNPACKED}")


class _Files:
    """Gives trimesh the other files that it asks for, from the model's folder."""

    def __init__(self, path: Path, warnings: list[str]) -> None:
        self.path, self.warnings = path, warnings
        self.contents: dict[str, bytes] = {}
        self.images: list[TextureImage] = []

    def get(self, name: str) -> bytes:
        """The content of another file; trimesh calls this."""
        try:
            self.contents[name] = read_file(path_inside(self.path, name.replace("\\", "/"), ""))
        except InputError as error:
            self.warnings.append(f"{error.problem}; it is left out")
            raise FileNotFoundError(name) from error
        return self.contents[name]

    __getitem__ = get


def _mesh(path: Path, name: str, geometry: Any, transform: np.ndarray, files: _Files) -> RawMesh | None:
    """The mesh of a trimesh.Trimesh or PointCloud; None if it is empty."""
    positions = np.asarray(geometry.vertices, np.float64) @ transform[:3, :3].T + transform[:3, 3]
    faces = getattr(geometry, "faces", None)
    if faces is None:
        colors = _colors(getattr(geometry, "colors", None), len(positions))
        return RawMesh(name, positions, "points", colors=colors, material=colored(PLAIN, colors)) \
            if len(positions) else None
    corners = np.asarray(faces).ravel()
    if not len(corners):
        return None
    if corners.min() < 0 or corners.max() >= len(positions):
        raise InputError(path, name, f"a face has a vertex number that is not in 0..{len(positions) - 1}")
    visual = geometry.visual
    uvs: Any = getattr(visual, "uv", None)
    if np.shape(uvs) != (len(positions), 2):
        uvs = None
    # trimesh computes missing normals on access; only normals that are already in its cache come from the file.
    normals = geometry.vertex_normals if "vertex_normals" in geometry._cache else None
    if normals is not None:
        normals = normals @ np.linalg.pinv(transform[:3, :3])
    mesh = RawMesh(name, positions, "triangles", corners, normals, uvs)
    if visual.kind == "face":
        mesh = replace(mesh.picked(corners), indices=None, normals=None)
        colors = _colors(np.repeat(visual.face_colors, 3, axis=0), len(corners))
    else:
        colors = _colors(visual.vertex_colors, len(positions)) if visual.kind == "vertex" else None
    if uvs is not None and len(files.contents) == 1:
        # It has no material of its own here, but perhaps the one picture that the file named.
        (file, data), = files.contents.items()
        files.images[:] = [open_texture_image(data, str(path.parent / file), MESH_FORMATS)]
        return replace(mesh, material=textured(PLAIN, files.images[0]))
    factor = getattr(getattr(visual, "material", None), "baseColorFactor", None)
    if factor is not None:  # of COLLADA, as 8-bit sRGB
        color = linear_colors(np.asarray(factor)[None], 255)
        return replace(mesh, material=replace(colored(PLAIN, color), base_color=tuple(color[0].tolist())))
    return replace(mesh, colors=colors, material=colored(PLAIN, colors))


def _colors(rgba: np.ndarray | None, count: int) -> np.ndarray | None:
    """8-bit sRGB with linear alpha, (N, 3 or 4), to (N, 4) float32 linear; None for arrays of another type or shape."""
    rgba = None if rgba is None else np.asarray(rgba)
    if rgba is None or rgba.shape not in ((count, 3), (count, 4)) or rgba.dtype != np.uint8:
        return None
    return linear_colors(rgba, 255)


@contextmanager
def _as_input_error(path: Path, kind: str) -> Iterator[None]:
    """Turn any exception from trimesh into an InputError, and suppress its log and warnings."""
    log = logging.getLogger("trimesh")
    level = log.level
    log.setLevel(logging.CRITICAL + 1)
    try:
        with without_warnings():
            yield
    except InputError:
        raise
    except Exception as error:  # for a broken file trimesh's readers raise exceptions of any type
        is_of_code = isinstance(error, (AttributeError, LookupError, TypeError))  # whose words are about no file
        text = "it is broken" if is_of_code else str(error) or type(error).__name__
        raise InputError(path, "", f"cannot be read as {kind.upper()}: {text[:200]}") from error
    finally:
        log.setLevel(level)
