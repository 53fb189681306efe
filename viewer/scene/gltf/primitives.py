"""Reads mesh primitives: their attributes, with the pose applied and missing normals and tangents computed."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from ..frames import with_flat_normals, with_repaired_normals, with_tangents
from ..material import Material
from ..mesh import Mesh, Topology
from ..schema import MAPS, needs_tangents, tangent_texture
from . import deform
from .accessors import Accessors
from .element import Element
from .textures import MAX_UV_SETS
from .topology import ELEMENT_SIZES, MODES
from .vertices import Vertices

_ATTRIBUTES = {"POSITION": ("VEC3",), "NORMAL": ("VEC3",), "TANGENT": ("VEC4",), "COLOR_0": ("VEC3", "VEC4"),
               **{f"TEXCOORD_{k}": ("VEC2",) for k in range(MAX_UV_SETS)}}


@dataclass(frozen=True)
class Pose:
    """The deformation of a mesh: morph weights, and the joint matrices (J, 4, 4) of a skin."""

    weights: tuple[float, ...] = ()
    joints: np.ndarray | None = None


def read_primitive(accessors: Accessors, primitive: Element, name: str, material: int, materials: list[Material],
                   pose: Pose) -> Mesh | None:
    """One primitive in its pose; None, with a warning, if it contains nothing to draw."""
    attributes = primitive.object("attributes")
    mode = primitive.integer("mode", 4)
    if mode not in MODES:
        raise primitive.error(f"{mode} is not a primitive mode", "mode")
    if "POSITION" not in attributes:
        primitive.warn("there are no positions; nothing is drawn", "attributes")
        return None
    vertices = Vertices(accessors, primitive, mode)
    values = {key: vertices.floats(attributes, key, *_ATTRIBUTES[key]) for key in _ATTRIBUTES if key in attributes}
    _morph(primitive, vertices, values, pose.weights)
    topology, indices = MODES[mode][1], vertices.indices
    if pose.joints is not None:
        sides = _skin(attributes, vertices, values, pose.joints)
        if topology == "triangles":
            indices = deform.rewound(vertices.count, indices, sides)
    positions, indices = _finite_part(attributes, values["POSITION"], indices, topology)
    mesh = Mesh(name, positions, material, topology, indices,
                _unit(values.get("NORMAL")), _unit_tangents(values.get("TANGENT")), _uvs(values, vertices.count),
                _colors(values.get("COLOR_0")))
    if not mesh.element_count:
        primitive.warn("there are too few vertices; nothing is drawn")
        return None
    mesh = _with_uv_sets(mesh, materials[material], primitive)
    return _complete(mesh, materials[material], primitive) if mesh.topology == "triangles" else mesh


def _finite_part(attributes: Element, positions: np.ndarray, indices: np.ndarray | None,
                 topology: Topology) -> tuple[np.ndarray, np.ndarray | None]:
    """Positions that are all finite, and the indices without the triangles, lines or points that were not."""
    bad = ~np.isfinite(positions).all(axis=1)
    if not bad.any():
        return positions, indices
    if indices is None:
        indices = np.arange(len(positions), dtype=np.uint32)
    elements = indices.reshape(-1, ELEMENT_SIZES[topology])
    whole = ~bad[elements].any(axis=1)
    if not whole.all():
        problem = f"{np.count_nonzero(~whole)} of {len(whole)} {topology} are not at finite positions"
        attributes.warn(f"{problem}; they are left out", "POSITION")
    return np.where(bad[:, None], np.float32(0), positions), elements[whole].ravel()


def _morph(primitive: Element, vertices: Vertices, values: dict[str, np.ndarray], weights: tuple[float, ...]) -> None:
    targets = primitive.array("targets")
    if len(weights) > len(targets):
        primitive.warn(f"{len(weights)} weights for {len(targets)} targets; surplus weights are not used", "targets")
    active = [(target, weight) for target, weight in zip(targets, weights) if weight]
    for key, base in values.items():
        moved = [(target, weight) for target, weight in active if key in target]
        if moved:
            # Deltas of tangents have no w (glTF 2.0, 3.7.2.2); deltas of colours may have no alpha.
            kinds = ("VEC3",) if key == "TANGENT" else _ATTRIBUTES[key]
            deltas = [vertices.floats(target, key, *kinds) for target, _ in moved]
            values[key] = deform.morph(base, deltas, [weight for _, weight in moved])


def _skin(attributes: Element, vertices: Vertices, values: dict[str, np.ndarray], matrices: np.ndarray) -> np.ndarray:
    """Put the vertices where their joints take them; -1 for each vertex that they mirror and 1 for the others, (N,)."""
    sets = [k for k in range(2) if f"JOINTS_{k}" in attributes]
    joints = np.concatenate([vertices.raw(attributes, f"JOINTS_{k}", "VEC4") for k in sets], axis=1)
    weights = np.concatenate([vertices.floats(attributes, f"WEIGHTS_{k}", "VEC4") for k in sets], axis=1)
    if joints.dtype.kind != "u" or not np.isfinite(weights).all():
        raise attributes.error("joints must be unsigned integers and weights finite", "JOINTS_0")
    if joints.max() >= len(matrices):
        raise attributes.error(f"joint {joints.max()}, but the skin has {len(matrices)}", "JOINTS_0")
    blend = deform.blend_matrices(joints, weights, matrices)
    sides = deform.blend_sides(blend)
    values["POSITION"] = deform.skin_positions(values["POSITION"], blend)
    if "NORMAL" in values:
        values["NORMAL"] = deform.skin_normals(values["NORMAL"], blend)
    if "TANGENT" in values:
        tangents = values["TANGENT"].copy()
        tangents[:, :3] = deform.skin_directions(tangents[:, :3], blend)
        tangents[:, 3] *= sides
        values["TANGENT"] = tangents
    return sides


def _uvs(values: dict[str, np.ndarray], count: int) -> tuple[np.ndarray, ...]:
    sets = [values.get(f"TEXCOORD_{k}") for k in range(MAX_UV_SETS)]
    while sets and sets[-1] is None:
        sets.pop()
    return tuple(np.zeros((count, 2), np.float32) if uv is None else np.nan_to_num(uv) for uv in sets)


def _colors(colors: np.ndarray | None) -> np.ndarray | None:
    """Linear RGBA in 0..1."""
    if colors is None:
        return None
    rgba = np.ones((len(colors), 4), np.float32)
    rgba[:, :colors.shape[1]] = np.clip(np.nan_to_num(colors), 0, 1)
    return rgba


def _unit(normals: np.ndarray | None) -> np.ndarray | None:
    """The normals at unit length. Non-finite vectors become zero; `_complete` replaces zeros."""
    if normals is None:
        return None
    normals = np.where(np.isfinite(normals).all(axis=1)[:, None], normals, np.float32(0))
    length = np.sqrt(np.einsum("ij,ij->i", normals, normals))[:, None]
    return normals / np.where(length > 0, length, 1)


def _unit_tangents(tangents: np.ndarray | None) -> np.ndarray | None:
    if tangents is None or not np.isfinite(tangents).all():
        return None
    out = np.empty_like(tangents)
    out[:, :3] = _unit(tangents[:, :3])
    out[:, 3] = np.where(tangents[:, 3] < 0, -1, 1)
    return out


def _with_uv_sets(mesh: Mesh, material: Material, primitive: Element) -> Mesh:
    """The mesh with zeros for the UV sets that its material uses and it does not have."""
    textures = [source.texture(material) for source in MAPS.values()]
    needed = max((texture.uv_set + 1 for texture in textures if texture), default=0)
    missing = needed - len(mesh.uvs)
    if missing <= 0:
        return mesh
    primitive.warn(f"the material needs TEXCOORD_{needed - 1}, which is missing; 0, 0 is used", "attributes")
    return replace(mesh, uvs=mesh.uvs + (np.zeros((len(mesh.positions), 2), np.float32),) * missing)


def _complete(mesh: Mesh, material: Material, primitive: Element) -> Mesh:
    """The triangle mesh with normals, and with tangents if its material needs them."""
    if mesh.normals is None:
        # Normals must be flat then, and the file's tangents must be ignored (glTF 2.0, 3.7.2.1).
        mesh = with_flat_normals(mesh)
    else:
        bad = ~(np.abs(np.einsum("ij,ij->i", mesh.normals, mesh.normals) - 1) < 0.1)
        if bad.any():
            problem = f"{np.count_nonzero(bad)} normals are zero or not finite; smooth normals replace them"
            primitive.warn(problem, "attributes.NORMAL")
            mesh = with_repaired_normals(mesh, bad)
    if not needs_tangents(material):
        return replace(mesh, tangents=None)
    if mesh.tangents is not None and (np.abs(np.linalg.norm(mesh.tangents[:, :3], axis=1) - 1) < 0.1).all():
        return mesh
    mesh = with_tangents(mesh, tangent_texture(material))
    if mesh.tangents is None:
        primitive.warn("anisotropy needs tangents or texture coordinates; it is left out", "attributes")
    return mesh
