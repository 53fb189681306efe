"""Loads OBJ, PLY, STL, OFF and all other formats that trimesh reads as a Scene."""

from __future__ import annotations

import io
import logging
import re
import warnings
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from ..errors import InputError
from .color import srgb_to_linear
from .files import path_inside, read_file
from .frames import picked, with_creased_normals, with_flat_normals, with_tangents
from .material import AlphaMode, Material, Texture
from .mesh import Mesh
from .mtl import PLAIN, MaterialLibrary
from .scene import Instance, Scene
from .schema import needs_tangents, tangent_texture
from .texture_image import MESH_FORMATS, open_texture_image

if TYPE_CHECKING:
    import trimesh

_OTHER_READERS = {"glb", "gltf"}
_ARCHIVES = {"zip", "bz2", "tar.bz2", "tar.gz"}
_LINEAR = srgb_to_linear(np.arange(256) / 255).astype(np.float32)


def mesh_formats() -> set[str]:
    """The file extensions, without dot, of the formats that are read through trimesh."""
    from trimesh.exchange.load import mesh_formats

    return set(mesh_formats()) - _OTHER_READERS - _ARCHIVES


def load_mesh_file(path: Path, data: bytes, kind: str) -> Scene:
    """Read `data`, the content of `path`, as the format `kind`, one of `mesh_formats()`. Units are not converted.

    Textures and material files are read only from the model's folder; a missing one is left out with a warning. Raises
    InputError if trimesh cannot read the file or it contains nothing to draw.
    """
    _check_counts(path, data, kind)
    with _as_input_error(path, kind):
        import trimesh

        reader = _Reader(path, data, kind)
        loaded = trimesh.load_scene(io.BytesIO(reader.data), file_type=kind, process=False,
                                    resolver=reader)  # type: ignore[arg-type]  # trimesh calls only `get`
        return reader.scene(loaded)


class _Reader:
    """Converts what trimesh has loaded to a Scene, and gives trimesh the other files that it asks for."""

    def __init__(self, path: Path, data: bytes, kind: str) -> None:
        self.path, self.kind = path, kind
        self.warnings: list[str] = []
        self.materials: list[Material] = []
        self.meshes: list[Mesh] = []
        self._library = MaterialLibrary(path, self.warnings)
        self._assets: dict[str, bytes] = {}
        self.data = self._prepare_obj(data) if kind == "obj" else data

    def _prepare_obj(self, data: bytes) -> bytes:
        if b"mtllib" in data:
            for line in re.findall(rb"^[ \t]*mtllib[ \t]+(.+)", data, re.MULTILINE):
                self._library.add(line.decode("utf-8", "replace").strip())
        return _absolute_indices(data) if re.search(rb"^f[^\n-]*-", data, re.MULTILINE) else data

    def get(self, name: str) -> bytes:
        """The content of another file; trimesh calls this."""
        if self.kind == "obj":
            # MaterialLibrary has read the materials; trimesh needs only their names, to keep the faces apart.
            return "".join(f"newmtl {name}\nd 1\n" for name in self._library.materials).encode()
        try:
            self._assets[name] = read_file(path_inside(self.path, name.replace("\\", "/"), ""))
        except InputError as error:
            self.warnings.append(f"{error.problem}; it is left out")
            raise FileNotFoundError(name) from error
        return self._assets[name]

    __getitem__ = get

    def scene(self, loaded: trimesh.Scene) -> Scene:
        numbers = {}
        for name, geometry in loaded.geometry.items():
            title = self.path.stem if name.startswith("geometry") else Path(name).name
            mesh = self._mesh(title, geometry)
            if mesh is not None:
                numbers[name] = len(self.meshes)
                self.meshes.append(mesh)
        instances = []
        for node in loaded.graph.nodes_geometry:
            transform, name = loaded.graph[node]
            if name in numbers:
                instances.append(Instance(numbers[name], np.array(transform, np.float64), Path(str(node)).name))
        if not instances:
            raise InputError(self.path, "", "the file contains nothing to draw")
        images = [{"name": image.name, "format": image.format, "width": image.width, "height": image.height,
                   "bits": image.bits} for image in self._library.images]
        facts = {"format": self.kind.upper(), "meshes": len(self.meshes), "materials": len(self.materials),
                 "images": images}
        return Scene(self.path.stem, tuple(self.meshes), tuple(self.materials), tuple(instances),
                     warnings=tuple(self.warnings), facts=facts)

    def _mesh(self, name: str, geometry: Any) -> Mesh | None:
        """The mesh of a trimesh.Trimesh or PointCloud; None if it is empty."""
        positions = np.asarray(geometry.vertices, np.float64)
        if not np.isfinite(positions).all():
            raise InputError(self.path, name, "the positions must be finite numbers")
        faces = getattr(geometry, "faces", None)
        if faces is None:
            colors = _vertex_colors(getattr(geometry, "colors", None), len(positions))
            return Mesh(name, positions.astype(np.float32), self._add(PLAIN, colors), "points", colors=colors) \
                if len(positions) else None
        faces = np.asarray(faces)
        if not len(faces):
            return None
        if faces.min() < 0 or faces.max() >= len(positions):
            raise InputError(self.path, name, f"a face has a vertex number that is not in 0..{len(positions) - 1}")
        visual = geometry.visual
        uv = getattr(visual, "uv", None)
        uvs: tuple[np.ndarray, ...] = ()
        if uv is not None and np.shape(uv) == (len(positions), 2):
            # In trimesh and these formats v points upwards; in a Mesh it points downwards, as in glTF.
            uvs = ((np.nan_to_num(np.asarray(uv, np.float64)) * (1, -1) + (0, 1)).astype(np.float32),)
        colors = _vertex_colors(visual.vertex_colors, len(positions)) if visual.kind == "vertex" else None
        mesh = Mesh(name, positions.astype(np.float32), 0, "triangles", faces.ravel().astype(np.uint32), uvs=uvs,
                    colors=colors)
        if visual.kind == "face":
            mesh = replace(picked(mesh, faces.ravel()), indices=None,
                           colors=_vertex_colors(np.repeat(visual.face_colors, 3, axis=0), faces.size))
        # trimesh computes missing normals on access; only normals that are already in its cache come from the file.
        given = geometry.vertex_normals if "vertex_normals" in geometry._cache else None
        mesh = self._with_normals(mesh, None if mesh.indices is None else given)
        mesh = replace(mesh, material=self._material(visual, mesh))
        material = self.materials[mesh.material]
        return with_tangents(mesh, tangent_texture(material)) if needs_tangents(material) else mesh

    def _with_normals(self, mesh: Mesh, given: np.ndarray | None) -> Mesh:
        if given is not None and len(given) == len(mesh.positions):
            length = np.linalg.norm(given, axis=1, keepdims=True)
            if (length > 0).all() and np.isfinite(length).all():
                return replace(mesh, normals=(given / length).astype(np.float32))
        # STL files are faceted.
        return with_flat_normals(mesh) if self.kind == "stl" else with_creased_normals(mesh)

    def _material(self, visual: object, mesh: Mesh) -> int:
        name = getattr(getattr(visual, "material", None), "name", None)
        material = self._library.materials.get(" ".join(str(name).split()))
        if material is None:
            return self._add(self._plain(visual, mesh), mesh.colors)
        if not mesh.uvs:
            material = replace(material, base_color_texture=None, normal_texture=None, emissive_texture=None)
        return self._add(material, None)

    def _plain(self, visual: object, mesh: Mesh) -> Material:
        """The material of a mesh without one. If the file refers to exactly one picture, that is its base colour."""
        if self.kind == "obj" or not mesh.uvs or len(self._assets) != 1:
            return PLAIN
        (name, data), = self._assets.items()
        image = open_texture_image(data, str(self.path.parent / name), MESH_FORMATS)
        return replace(PLAIN, base_color=(1.0, 1.0, 1.0, 1.0), base_color_texture=Texture(image))

    def _add(self, material: Material, colors: np.ndarray | None) -> int:
        """Add a material and return its index. Vertex colours replace its base colour, and make it blend if any is
        translucent."""
        if colors is not None:
            # Alpha 254/255 comes from rounding and does not mean a translucent surface.
            mode: AlphaMode = "blend" if colors[:, 3].min() < 0.99 else "opaque"
            material = replace(material, base_color=(1.0, 1.0, 1.0, 1.0), alpha_mode=mode)
        if material not in self.materials:
            self.materials.append(material)
        return self.materials.index(material)


def _vertex_colors(rgba: np.ndarray | None, count: int) -> np.ndarray | None:
    """8-bit sRGB with linear alpha, (N, 3 or 4), to (N, 4) float32 linear; None for arrays of another type or shape."""
    rgba = None if rgba is None else np.asarray(rgba)
    if rgba is None or rgba.shape not in ((count, 3), (count, 4)) or rgba.dtype != np.uint8:
        return None
    out = np.ones((count, 4), np.float32)
    out[:, :3] = _LINEAR[rgba[:, :3]]
    if rgba.shape[1] == 4:
        out[:, 3] = rgba[:, 3] / np.float32(255)
    return out


def _absolute_indices(data: bytes) -> bytes:
    """An OBJ file with its negative indices, which count back from the current line, replaced by absolute ones.

    trimesh would count them back from the end of the file.
    """
    counts = {b"v": 0, b"vt": 0, b"vn": 0}
    order = (b"v", b"vt", b"vn")
    lines = data.replace(b"\\\r\n", b" ").replace(b"\\\n", b" ").split(b"\n")
    for k, line in enumerate(lines):
        words = line.split()
        if not words:
            continue
        if words[0] in counts:
            counts[words[0]] += 1
        elif words[0] == b"f" and b"-" in line:
            for w, word in enumerate(words[1:], 1):
                parts = word.split(b"/")
                for p, part in enumerate(parts[:3]):
                    if part.startswith(b"-"):
                        parts[p] = b"%d" % (counts[order[p]] + int(part) + 1)
                words[w] = b"/".join(parts)
            lines[k] = b" ".join(words)
    return b"\n".join(lines)


def _check_counts(path: Path, data: bytes, kind: str) -> None:
    """Reject a PLY file that declares more elements than it has bytes, before memory for them is allocated."""
    if kind != "ply":
        return
    end = data.find(b"end_header")
    if end < 0:
        raise InputError(path, "header", "there is no end_header")
    for name, count in re.findall(rb"^element[ \t]+(\S+)[ \t]+(\d+)", data[:end], re.MULTILINE):
        if int(count[:20]) > len(data) - end:
            name = name.decode("ascii", "replace")[:20]
            problem = f"{count[:20].decode()} are declared in a file of {len(data)} bytes"
            raise InputError(path, f"element {name}", problem)


@contextmanager
def _as_input_error(path: Path, kind: str) -> Iterator[None]:
    """Turn any exception from trimesh into an InputError, and suppress its log and warnings."""
    log = logging.getLogger("trimesh")
    level = log.level
    log.setLevel(logging.CRITICAL + 1)
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            yield
    except InputError:
        raise
    except Exception as error:  # for a broken file trimesh's readers raise exceptions of any type
        text = str(error) or type(error).__name__
        raise InputError(path, "", f"cannot be read as {kind.upper()}: {text[:200]}") from error
    finally:
        log.setLevel(level)
