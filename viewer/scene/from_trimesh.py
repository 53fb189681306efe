"""Meshes of trimesh's objects in memory. Files that trimesh reads for us go through `trimesh_formats.py`."""

from __future__ import annotations

import io
from dataclasses import replace
from typing import Any

import numpy as np

from ..errors import UsageError
from .arrays import scene_array, scene_numbers
from .from_arrays import with_colors
from .material import Material, Texture
from .mtl import PLAIN
from .raw_mesh import RawMesh, linear_colors
from .texture_image import MESH_FORMATS, open_texture_image

_LEFT_OUT = ("normalTexture", "metallicRoughnessTexture", "emissiveTexture", "occlusionTexture")
"""Of a PBRMaterial, with which the file that it came from is to be loaded itself."""
_MODES = ("1", "L", "LA", "I", "I;16", "P", "RGB", "RGBA")
"""Of images that PNG can store; others are converted."""


def meshes_of(thing: Any, warnings: list[str]) -> list[RawMesh]:
    """The meshes of a `trimesh.Trimesh`, a `PointCloud`, or of all nodes of a `Scene`, in the world. What is left out
    is added to `warnings`. Raises UsageError."""
    import trimesh

    if not isinstance(thing, trimesh.Scene):
        found = [("mesh", thing, np.eye(4))]
    else:
        found = [(str(node), thing.geometry[name], scene_array(matrix, f"{node}: its matrix", np.float64, 4, 4))
                 for node in thing.graph.nodes_geometry for matrix, name in [thing.graph[node]]]
    meshes = []
    for name, geometry, matrix in found:
        if not isinstance(geometry, (trimesh.Trimesh, trimesh.PointCloud)):
            warnings.append(f"{name}: a {type(geometry).__name__} of trimesh is not drawn; it is left out")
        elif len(geometry.vertices):
            meshes.append(_mesh(name, geometry, matrix, warnings))
    if not meshes:
        raise UsageError(f"the {type(thing).__name__} of trimesh has nothing to draw"
                         + "".join(f": {line}" for line in warnings[:1]))
    return meshes


def _mesh(name: str, geometry: Any, matrix: np.ndarray, warnings: list[str]) -> RawMesh:
    vertices = scene_array(np.asarray(geometry.vertices), f"{name}.vertices", np.float64, None, 3)
    positions = vertices @ matrix[:3, :3].T + matrix[:3, 3]
    faces = getattr(geometry, "faces", None)
    if faces is None:
        points = RawMesh(name, positions, "points")
        colors = getattr(geometry, "colors", None)
        return points if colors is None or np.shape(colors)[:1] != (len(positions),) else with_colors(points, colors)
    corners = scene_array(np.asarray(faces), f"{name}.faces", np.uint32, None, 3)
    if not len(corners) or corners.max() >= len(positions):
        raise UsageError(f"{name}.faces: there are none, or one has a corner that is not in 0..{len(positions) - 1}")
    if np.linalg.det(matrix[:3, :3]) < 0:  # mirrored: the other way round
        corners = corners[:, ::-1]
    mesh, visual = RawMesh(name, positions, "triangles", corners.ravel()), geometry.visual
    if visual.kind == "face":
        return with_colors(mesh, np.asarray(visual.face_colors))
    if visual.kind == "vertex":
        return with_colors(mesh, np.asarray(visual.vertex_colors))
    if visual.kind != "texture":
        return mesh
    uvs = visual.uv
    if np.shape(uvs) == (len(positions), 2):
        mesh = replace(mesh, uvs=scene_array(np.asarray(uvs), f"{name}.visual.uv", np.float64, len(positions), 2))
    return replace(mesh, material=_material(name, visual.material, mesh.uvs is not None, warnings))


def _material(name: str, given: Any, has_uvs: bool, warnings: list[str]) -> Material:
    """Of a PBRMaterial as glTF has it, its defaults included; of a SimpleMaterial its colour and image."""
    title = str(getattr(given, "name", None) or "")
    if hasattr(given, "baseColorFactor"):
        factor = given.baseColorFactor
        color = (1.0,) * 4 if factor is None else tuple((np.asarray(factor, np.float64) / 255).tolist())
        metallic, roughness = (_share(name, given, key) for key in ("metallicFactor", "roughnessFactor"))
        material = Material(name=title, base_color=color, metallic=metallic, perceptual_roughness=roughness,
                            double_sided=bool(given.doubleSided))
        if given.emissiveFactor is not None:
            red, green, blue = scene_numbers(given.emissiveFactor, f"{name}: its emissiveFactor", 3)
            material = replace(material, emissive=(red, green, blue))
        image = given.baseColorTexture
        if given.alphaMode in ("BLEND", "MASK"):
            material = replace(material, alpha_mode="blend" if given.alphaMode == "BLEND" else "mask",
                               alpha_cutoff=0.5 if given.alphaCutoff is None else float(given.alphaCutoff))
        lost = [key for key in _LEFT_OUT if getattr(given, key) is not None]
        if lost:
            warnings.append(f"{name}: its material is without {', '.join(lost)}; viewer.load reads files with them")
    else:
        image, color = getattr(given, "image", None), PLAIN.base_color
        if image is not None and has_uvs:
            color = 1.0, 1.0, 1.0, 1.0
        elif getattr(given, "diffuse", None) is not None:
            color = tuple(linear_colors(np.asarray(given.diffuse)[None], 255)[0].tolist())
        material = replace(PLAIN, name=title, base_color=color)
    if image is None:
        return material
    if not has_uvs:
        warnings.append(f"{name}: it has no texture coordinates for its image, which is left out")
        return material
    encoded = io.BytesIO()
    (image if image.mode in _MODES else image.convert("RGB")).save(encoded, "PNG", compress_level=1)
    picture = open_texture_image(encoded.getvalue(), f"{name}: image", MESH_FORMATS)
    return replace(material, base_color_texture=Texture(picture))


def _share(name: str, given: Any, key: str) -> float:
    """A factor of a PBRMaterial. Raises UsageError for what is not from 0 to 1."""
    value = getattr(given, key)
    (share,) = scene_numbers((1.0 if value is None else value,), f"{name}: its {key}", 1)
    if not 0 <= share <= 1:
        raise UsageError(f"{name}: its {key} is {share:g}, not from 0 to 1")
    return share
