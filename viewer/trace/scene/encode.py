"""Writes a scene's triangles and materials to the scene buffer, and the switches of the programs that read them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from ...base.counted import counted
from ...material.fold import without_constant_maps
from ...material.use import metalness
from ...scene.material import TRANSMISSION
from ...scene.mesh import Mesh
from ...scene.scene import Scene
from ...scene.schema import MAPS, PATH_TRACED, SWITCHED
from ...scene.texture_image import TextureImage
from ..layout import (
    FLAG_DOUBLE_SIDED,
    FLAG_MIRRORED,
    FLAG_PANE,
    FLAG_SEE_THROUGH,
    FLAG_THIN,
    FLAG_UNLIT,
    INSTANCE_TEXELS,
    vertex_layout,
)
from .atlas import Page
from .clearance import clearance_texels, has_clearance
from .deep_media import deep_media, deep_texels
from .geometry import TraceGeometry, TraceInstance, TraceMesh
from .glass import glass_switches
from .materials import MapUse, TraceMaterial, map_texels, material_texels
from .scene_buffer import SceneBufferBuilder


def geometry_switches(scene: Scene, geometry: TraceGeometry, everything: bool = False) -> dict[str, int]:
    """The defines that say which features the scene has; with `everything`, all of them are on."""
    materials = geometry.materials
    color = [use for m in materials for use in m.color_maps]
    data = [texture for m in materials for texture in m.data_textures]
    textures = [use.texture for use in color] + data
    has_normal_map = any(m.normal_maps for m in materials)
    features = [m.features for m in materials]
    switches = {
        "HAS_TEXTURES": bool(textures),
        "HAS_COLOR_MAPS": bool(color),
        "HAS_DATA_MAPS": bool(data),
        "HAS_NORMAL_MAP": has_normal_map,
        "HAS_TANGENT": has_normal_map or any(
            f[feature.switch] for f in features for feature in SWITCHED if feature.needs_tangents),
        "HAS_UV1": any(texture.uv_set == 1 for texture in textures),
        "HAS_UV_TRANSFORM": any(texture.transform is not None for texture in textures),
        "HAS_COLOR": any(scene.meshes[mesh.source].colors is not None for mesh in geometry.meshes),
        **{feature.switch: any(f[feature.switch] for f in features) for feature in PATH_TRACED},
        "HAS_SEE_THROUGH": any(instance.see_through for instance in geometry.instances),
        "HAS_UNLIT": any(m.material.unlit for m in materials),
        "HAS_VOLUME": len(geometry.media) > 1 or geometry.scatters,
    }
    switches[TRANSMISSION.switch] = transmits(geometry)
    return {name: int(value or everything) for name, value in switches.items()} | {
        "HAS_SCATTERING": int(geometry.scatters),  # other random numbers: `everything` would be another picture with it
        "HAS_PANES": int(geometry.has_panes),
        "HAS_NESTED": int(bool(geometry.indices)),
        "HAS_GRIDS": int(geometry.has_grids),
        "HAS_CLEARANCE": int(has_clearance(geometry)),
        "HAS_DEEP_MEDIA": int(bool(deep_media(geometry))),
        "HAS_FOG": 0 if geometry.fog is None else 1 + geometry.fog.thins,
        "HAS_CURVES": int(geometry.curves is not None),
        "HAS_FIBRE_COLORS": int(geometry.curves is not None and geometry.curves.colors is not None),
        "METALNESS": 2 if everything else _metalness(materials)} | glass_switches(materials)


def transmits(geometry: TraceGeometry) -> bool:
    """Whether light gets into some solid or through some wall, so that paths may have a medium inside."""
    return geometry.scatters or any(
        m.features[TRANSMISSION.switch] or (m.transmits_diffusely and not m.is_thin) for m in geometry.materials)


def _metalness(materials: Sequence[TraceMaterial]) -> int:
    """0 if all materials are dielectric, 1 if all are metal, else 2 (shaders/bsdf/surface.glsl)."""
    values = {metalness(m.material) for m in materials if not m.material.unlit}
    return values.pop() if len(values) == 1 else 2


def unused_maps(scene: Scene, geometry: TraceGeometry) -> list[str]:
    """Lines for the user about maps of the materials in use that are not decoded."""
    number = {instance.material: scene.meshes[scene.instances[instance.source].mesh].material
              for instance in geometry.instances}
    sampled = {(number[k], texture.image) for k, m in enumerate(geometry.materials)
               for texture in (*(use.texture for use in m.color_maps), *m.data_textures)}
    surfaces = {k: (scene.materials[k], without_constant_maps(scene.materials[k])) for k in set(number.values())}
    named = [(k, MAPS[name].texture(plain)) for k, (_, plain) in surfaces.items() for name in MAPS]
    idle = sum(texture is not None and (k, texture.image) not in sampled for k, texture in named)
    constant = sum(MAPS[name].texture(m) != MAPS[name].texture(plain)
                   for m, plain in surfaces.values() for name in MAPS)
    lines = [f"{counted(constant, 'material map')} of one colour: folded into factors"] * bool(constant)
    if not idle:
        return lines
    them = "them" if idle > 1 else "it"
    return [*lines, f"{counted(idle, 'material map')}, not decoded: no path depends on {them}"]


def add_geometry(
    buffer: SceneBufferBuilder, scene: Scene, geometry: TraceGeometry, switches: Mapping[str, int]
) -> None:
    """Append the sections instances, triangles, vertices and, if the scene has them, media and fog."""
    first_triangle = np.cumsum([0] + [len(mesh.triangles) for mesh in geometry.meshes])
    first_vertex = np.cumsum([0] + [len(mesh.positions) for mesh in geometry.meshes])
    instances = np.zeros((len(geometry.instances), INSTANCE_TEXELS, 4), np.uint32)
    for row, instance in zip(instances, geometry.instances):
        row[:3] = np.asarray(instance.transform, np.float32).view(np.uint32)
        emitter = instance.first_emitter & 0xFFFFFFFF  # -1 in two's complement
        row[3] = first_triangle[instance.mesh], first_vertex[instance.mesh], instance.material, emitter
        row[4, :2] = _flags(instance, geometry), instance.medium
    buffer.add("instances", instances.reshape(-1, 4))
    triangles = np.zeros((first_triangle[-1], 4), np.uint32)
    for first, mesh in zip(first_triangle, geometry.meshes):
        triangles[first:first + len(mesh.triangles), :3] = mesh.triangles
    buffer.add("triangles", triangles)
    layout = vertex_layout(switches)
    vertices = np.zeros((first_vertex[-1], layout["VERTEX_TEXELS"], 4), np.float32)
    for first, mesh in zip(first_vertex, geometry.meshes):
        _fill_vertices(vertices[first:first + len(mesh.positions)], mesh, scene.meshes[mesh.source], switches, layout)
    buffer.add("vertices", vertices.reshape(-1, 4))
    if switches["HAS_VOLUME"]:
        buffer.add("media", _media_texels(geometry))
    if switches["HAS_DEEP_MEDIA"]:
        buffer.add("deep_media", deep_texels(geometry))
    if switches["HAS_CLEARANCE"] or switches["HAS_DEEP_MEDIA"]:
        buffer.add("clearance", clearance_texels(geometry))
    if geometry.fog is not None:
        buffer.add("fog", geometry.fog.texels())


def _media_texels(geometry: TraceGeometry) -> np.ndarray:
    """The records of shaders/media/medium.glsl."""
    texels = np.zeros((len(geometry.media), 3, 4), np.float32)
    texels[:, 0, :3] = np.array([medium.sigma_t for medium in geometry.media]) * geometry.unit
    texels[:, 0, 3] = [medium.phase for medium in geometry.media]
    texels[:, 1, :3] = [medium.albedo for medium in geometry.media]
    texels[list(geometry.open_media), 1, 3] = 1.0
    if geometry.indices:
        texels[:, 2, :2] = geometry.indices
    return texels[:, [True, geometry.scatters, bool(geometry.indices)]].reshape(-1, 4)


def add_materials(
    buffer: SceneBufferBuilder, geometry: TraceGeometry, color_pages: Mapping[TextureImage, Page],
    data_pages: Mapping[TextureImage, Page],
) -> None:
    """Append the sections materials and maps; the arguments have the places of the images in the atlases."""
    materials, maps = [np.zeros((0, 4), np.uint32)], [np.zeros((0, 4), np.uint32)]

    def add(uses: tuple[MapUse, ...], pages: Mapping[TextureImage, Page]) -> int:
        """Append records of maps; returns the number of the first one."""
        first = len(maps) - 1
        maps.extend(map_texels(use.texture, use.roles, pages[use.texture.image]) for use in uses)
        return first

    for material in geometry.materials:
        normals = [-1 if texture is None else add((MapUse(texture, 0),), data_pages)
                   for texture in (material.normal_map, material.clearcoat_normal_map)]
        color, data = add(material.color_maps, color_pages), add(material.data_maps, data_pages)
        materials.append(material_texels(material, color, data, *normals))
    buffer.add("materials", np.concatenate(materials))
    buffer.add("maps", np.concatenate(maps))


def _flags(instance: TraceInstance, geometry: TraceGeometry) -> int:
    material = geometry.materials[instance.material]
    return (FLAG_SEE_THROUGH * instance.see_through | FLAG_MIRRORED * instance.is_mirrored
            | FLAG_DOUBLE_SIDED * material.material.double_sided | FLAG_UNLIT * material.material.unlit
            | FLAG_THIN * material.is_thin | FLAG_PANE * material.is_pane)


def _fill_vertices(
    out: np.ndarray, mesh: TraceMesh, source: Mesh, switches: Mapping[str, int], layout: Mapping[str, int]
) -> None:
    """Fill `out`, (N, texels, 4) zeros. A missing normal or tangent stays 0."""
    out[:, 0, :3] = mesh.positions
    if source.normals is not None:
        out[:, 1, :3] = source.normals
    if source.uvs:
        out[:, :2, 3] = source.uvs[0]
    if switches["HAS_TANGENT"] and source.tangents is not None:
        out[:, layout["VERTEX_TANGENT"]] = source.tangents
    if switches["HAS_UV1"] and len(source.uvs) > 1:
        out[:, layout["VERTEX_UV1"], :2] = source.uvs[1]
    if switches["HAS_COLOR"]:
        out[:, layout["VERTEX_COLOR"]] = 1 if source.colors is None else source.colors
