"""Reads mesh primitives: their attributes at rest, with missing normals and tangents computed, and how they deform."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from ..deform import Deformation, MorphTarget, influences
from ..frames import split_for_tangents, with_flat_normals, with_repaired_normals
from ..material import Material
from ..mesh import ELEMENT_SIZES, Mesh, Topology
from ..schema import MAPS, needs_tangents, tangent_texture
from . import draco
from .accessors import Accessors
from .element import Element
from .textures import MAX_UV_SETS
from .topology import MODES
from .vertices import Vertices

_ATTRIBUTES = {"POSITION": ("VEC3",), "NORMAL": ("VEC3",), "TANGENT": ("VEC4",), "COLOR_0": ("VEC3", "VEC4"),
               **{f"TEXCOORD_{k}": ("VEC2",) for k in range(MAX_UV_SETS)}}
MAX_INFLUENCE_SETS = 64
"""The most pairs of JOINTS_n and WEIGHTS_n, four influences each. glTF sets no limit; files have one or two."""


def read_primitive(accessors: Accessors, primitive: Element, name: str, material: int, looks: Sequence[Material],
                   weights: Sequence[float], joints: int) -> tuple[Mesh, Deformation | None] | None:
    """One primitive at rest, and how it deforms, if it does; None, with a warning, if it contains nothing to draw.

    `weights` are those of its morph targets; a target of weight 0 is not read. `joints` is the number of its skin's
    joints, 0 without a skin. `looks` are the materials that the variants of the file give it.
    """
    attributes = primitive.object("attributes")
    mode = primitive.integer("mode", 4)
    if mode not in MODES:
        raise primitive.error(f"{mode} is not a primitive mode", "mode")
    if "POSITION" not in attributes:
        primitive.warn("there are no positions; nothing is drawn", "attributes")
        return None
    accessors, mode = draco.decoded(accessors, primitive, mode)
    vertices = Vertices(accessors, primitive, mode)
    values = {key: vertices.floats(attributes, key, *_ATTRIBUTES[key]) for key in _ATTRIBUTES if key in attributes}
    deformation = _deformation(primitive, vertices, values, weights, joints)
    topology = MODES[mode][1]
    positions, indices = finite_part(attributes, values["POSITION"], vertices.indices, topology)
    if not len(positions if indices is None else indices):
        primitive.warn("there are too few vertices; nothing is drawn")
        return None
    mesh = Mesh(name, positions, material, topology, indices,
                _unit(values.get("NORMAL")), _unit_tangents(values.get("TANGENT")), _uvs(values, vertices.count),
                vertex_colors(attributes, values["COLOR_0"]) if "COLOR_0" in values else None)
    mesh = _with_uv_sets(mesh, looks, primitive)
    if mesh.topology == "triangles":
        mesh, deformation = _complete(mesh, looks, primitive, deformation)
    return mesh, deformation


def finite_part(attributes: Element, positions: np.ndarray, indices: np.ndarray | None,
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


def _deformation(primitive: Element, vertices: Vertices, values: dict[str, np.ndarray], weights: Sequence[float],
                 joint_count: int) -> Deformation | None:
    items = primitive.array("targets")
    if len(weights) > len(items):
        primitive.warn(f"{len(weights)} weights for {len(items)} targets; surplus weights are not used", "targets")
    targets = tuple(_target(target, vertices, values) if weight else MorphTarget()
                    for target, weight in zip(items, weights))
    joints, influence = None, None
    if joint_count:
        joints, influence = read_influences(primitive.object("attributes"), vertices, joint_count)
    return Deformation(targets, joints, influence) if joint_count or (any(weights) and targets) else None


def _target(target: Element, vertices: Vertices, values: dict[str, np.ndarray]) -> MorphTarget:
    """The differences of the attributes that the primitive has. What is not finite adds nothing."""
    def read(key: str) -> np.ndarray | None:
        if key not in values or key not in target:
            return None
        # Deltas of tangents have no w (glTF 2.0, 3.7.2.2); deltas of colours may have no alpha.
        delta = vertices.floats(target, key, *(("VEC3",) if key == "TANGENT" else _ATTRIBUTES[key]))
        bad = ~np.isfinite(delta).all(axis=1)
        if not bad.any():
            return delta
        target.warn(f"{np.count_nonzero(bad)} values are not finite; they add nothing", key)
        return np.where(bad[:, None], np.float32(0), delta)

    return MorphTarget(read("POSITION"), read("NORMAL"), read("TANGENT"),
                       tuple(read(f"TEXCOORD_{k}") for k in range(MAX_UV_SETS)), read("COLOR_0"))


def read_influences(attributes: Element, vertices: Vertices, joint_count: int) -> tuple[np.ndarray, np.ndarray]:
    """The joints and the weights of each vertex, (K, N) of both, of all sets that the primitive has."""
    sets = [k for k in range(MAX_INFLUENCE_SETS) if f"JOINTS_{k}" in attributes]
    joints = np.concatenate([vertices.raw(attributes, f"JOINTS_{k}", "VEC4") for k in sets], axis=1)
    weights = np.concatenate([vertices.floats(attributes, f"WEIGHTS_{k}", "VEC4") for k in sets], axis=1)
    if joints.dtype.kind != "u" or not np.isfinite(weights).all():
        raise attributes.error("joints must be unsigned integers and weights finite", "JOINTS_0")
    if joints.max() >= joint_count:
        raise attributes.error(f"joint {joints.max()}, but the skin has {joint_count}", "JOINTS_0")
    return influences(joints, weights)


def _uvs(values: dict[str, np.ndarray], count: int) -> tuple[np.ndarray, ...]:
    sets = [values.get(f"TEXCOORD_{k}") for k in range(MAX_UV_SETS)]
    while sets and sets[-1] is None:
        sets.pop()
    return tuple(np.zeros((count, 2), np.float32) if uv is None else np.nan_to_num(uv) for uv in sets)


def vertex_colors(attributes: Element, colors: np.ndarray) -> np.ndarray:
    """Linear RGBA in 0..1 of COLOR_0. NaN is 0, with a warning."""
    if bad := np.count_nonzero(~np.isfinite(colors).all(axis=1)):
        attributes.warn(f"{bad} colours are not finite; NaN is read as 0, infinity as 1", "COLOR_0")
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


def _with_uv_sets(mesh: Mesh, looks: Sequence[Material], primitive: Element) -> Mesh:
    """The mesh with zeros for the UV sets that its material uses and it does not have."""
    textures = [source.texture(material) for material in looks for source in MAPS.values()]
    needed = max((texture.uv_set + 1 for texture in textures if texture), default=0)
    missing = needed - len(mesh.uvs)
    if missing <= 0:
        return mesh
    primitive.warn(f"the material needs TEXCOORD_{needed - 1}, which is missing; 0, 0 is used", "attributes")
    return replace(mesh, uvs=mesh.uvs + (np.zeros((len(mesh.positions), 2), np.float32),) * missing)


def _complete(mesh: Mesh, looks: Sequence[Material], primitive: Element,
              deformation: Deformation | None) -> tuple[Mesh, Deformation | None]:
    """The triangle mesh with normals, and with tangents if its material needs them; and how its vertices deform."""
    if mesh.normals is None:
        # Normals must be flat then, and the file's tangents must be ignored (glTF 2.0, 3.7.2.1).
        if deformation is not None:
            deformation = replace(deformation, is_faceted=True)
            deformation = deformation if mesh.indices is None else deformation.picked(mesh.indices)
        mesh = with_flat_normals(mesh)
    else:
        bad = ~(np.abs(np.einsum("ij,ij->i", mesh.normals, mesh.normals) - 1) < 0.1)
        if bad.any():
            problem = f"{np.count_nonzero(bad)} normals are zero or not finite; smooth normals replace them"
            primitive.warn(problem, "attributes.NORMAL")
            mesh = with_repaired_normals(mesh, bad)
    material = next(filter(needs_tangents, looks), None)
    if material is None:
        return replace(mesh, tangents=None), deformation
    if mesh.tangents is not None and (np.abs(np.linalg.norm(mesh.tangents[:, :3], axis=1) - 1) < 0.1).all():
        return mesh, deformation
    mesh, source = split_for_tangents(mesh, tangent_texture(material))
    if deformation is not None and source is not None:
        deformation = deformation.picked(source)
    if mesh.tangents is None:
        primitive.warn("anisotropy needs tangents or texture coordinates; it is left out", "attributes")
    return mesh, deformation
