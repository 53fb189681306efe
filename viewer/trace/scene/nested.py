"""Solids of glass that touch or overlap, such as water in a tumbler: which of them is where two are.

Schmidt and Budge 2002, "Simple Nested Dielectrics in Ray Traced Images", give each solid a priority: where solids
overlap, the highest one displaces the others. glTF has none. Here the solid that encloses less volume has the higher
one, so that ice and bubbles are in water and not the other way round, whatever their indices. Where solids overlap, the
numbers of their media are in this order, so that the highest one that a path is inside of is the medium that it is in
(shaders/media/nesting.glsl). Solids of one glass that displace equally many others in a chain have one number, since no
path can be in two of them: a path carries more media, the fewer numbers there are.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from ...scene.material import DISPERSION
from ..kinds import BOUNDARY, GLASS
from .geometry import TraceGeometry, TraceInstance
from .grown import grown

GROWTH = 1 / 16384
"""In tracer units: four times as far as paths step off a surface (shaders/trace/offset_origin.glsl)."""


def with_priorities(geometry: TraceGeometry) -> TraceGeometry:
    """`geometry` with numbers of media in order of priority and with `indices`, if boxes of solids of glass overlap.
    Otherwise the same object.

    Instances of one glass that may overlap are parts of one solid, which need not be closed alone. Solids that touch
    are grown by `GROWTH` and more, the higher the priority, so that they overlap: the order in which a ray meets faces
    that coincide would depend on rounding.
    """
    solids = [k for k, instance in enumerate(geometry.instances) if geometry.materials[instance.material].is_solid]
    is_glass = np.array([geometry.instances[k].kind is GLASS for k in solids], bool)
    if is_glass.sum() < 2:
        return geometry
    boxes = np.array([_box(geometry, geometry.instances[k]) for k in solids])
    pairs = _overlapping(boxes)
    if not is_glass[pairs].all(axis=1).any():
        return geometry
    optics = [_optics(geometry, geometry.instances[k]) for k in solids]
    body = _joined(len(solids), [(a, b) for a, b in pairs.tolist() if optics[a] == optics[b]])
    volume = np.zeros(len(solids))
    np.add.at(volume, body, [_signed_volume(geometry, geometry.instances[k]) for k in solids])
    bodies = sorted(set(body), key=lambda k: (-abs(volume[k]), k))
    level = _levels(bodies, [(body[a], body[b]) for a, b in pairs.tolist()])
    kinds = dict.fromkeys(sorted(((level[k], *optics[k]) for k in bodies), key=lambda kind: kind[0]))
    number = {kind: rank + 1 for rank, kind in enumerate(kinds)}
    is_touched = set(pairs.ravel().tolist())
    meshes, instances = list(geometry.meshes), [replace(i, medium=0) for i in geometry.instances]
    for place, k in enumerate(solids):
        instance = replace(instances[k], medium=number[level[body[place]], *optics[place]])
        if place in is_touched:
            instance = replace(instance, mesh=len(meshes))
            meshes.append(grown(geometry.meshes[geometry.instances[k].mesh], instance.transform,
                                instance.is_mirrored, GROWTH * level[body[place]]))
        instances[k] = instance
    used = sorted({instance.mesh for instance in instances})
    place_of = {mesh: k for k, mesh in enumerate(used)}
    instances = [replace(instance, mesh=place_of[instance.mesh]) for instance in instances]
    media = [geometry.media[medium] for _, medium, *_ in kinds]
    indices = [(1.0, 0.0), *((ior, dispersion) for _, _, ior, dispersion, _ in kinds)]
    return replace(geometry, meshes=[meshes[k] for k in used], instances=instances, indices=tuple(indices),
                   media=(geometry.media[0], *media), depth=_depth(boxes, pairs, np.array(body)))


def _optics(geometry: TraceGeometry, instance: TraceInstance) -> tuple[int, float, float, bool]:
    """What makes two solids the same glass: the medium inside, its index and dispersion, and whether light is bent."""
    material = geometry.materials[instance.material].material
    is_glass = instance.kind is GLASS
    dispersion = material.dispersion if is_glass and DISPERSION.is_on(material) else 0.0
    return instance.medium, material.ior if is_glass else 1.0, dispersion, instance.kind is BOUNDARY


def _box(geometry: TraceGeometry, instance: TraceInstance) -> NDArray[np.float64]:
    """The least and the greatest coordinates, (2, 3), and a little more."""
    mesh = geometry.meshes[instance.mesh]
    corners = mesh.positions.astype(np.float64) @ instance.transform[:, :3].T + instance.transform[:, 3]
    return np.array([corners.min(axis=0) - GROWTH, corners.max(axis=0) + GROWTH])


def _overlapping(boxes: NDArray[np.float64]) -> NDArray[np.intp]:
    """The pairs of boxes, (N, 2, 3), that overlap, (pairs, 2): along x by sorting, then one by one."""
    order = np.argsort(boxes[:, 0, 0], kind="stable")
    low, high = boxes[order, 0], boxes[order, 1]
    last = np.searchsorted(low[:, 0], high[:, 0], side="right")
    found = []
    for k in range(len(boxes)):
        others = np.arange(k + 1, last[k])
        meets = (low[others] <= high[k]).all(axis=1) & (high[others] >= low[k]).all(axis=1)
        found.append(np.stack([np.full(meets.sum(), order[k]), order[others[meets]]], axis=1))
    return np.concatenate(found)


def _depth(boxes: NDArray[np.float64], pairs: NDArray[np.intp], body: NDArray[np.intp]) -> int:
    """How many bodies lie in one another at most, by the boxes of their parts: what is in a tumbler counts as in its
    glass."""
    both = np.concatenate([pairs, pairs[:, ::-1]])
    outer, inner = boxes[both[:, 0]], boxes[both[:, 1]]
    is_in = (outer[:, 0] <= inner[:, 0]).all(axis=1) & (outer[:, 1] >= inner[:, 1]).all(axis=1)
    around = np.unique(body[both[is_in]], axis=0)
    around = around[around[:, 0] != around[:, 1]]
    return 1 + int(np.bincount(around[:, 1], minlength=1).max())


def _joined(count: int, pairs: Sequence[tuple[int, int]]) -> list[int]:
    """For each of `count` things the first of the group that pairs connect it to."""
    group = list(range(count))

    def first(k: int) -> int:
        while group[k] != k:
            group[k] = group[group[k]]
            k = group[k]
        return k

    for pair in pairs:
        a, b = (first(k) for k in pair)
        group[max(a, b)] = min(a, b)
    return [first(k) for k in range(count)]


def _signed_volume(geometry: TraceGeometry, instance: TraceInstance) -> float:
    """What closed triangles enclose, negative if their fronts face inwards: the divergence theorem."""
    mesh = geometry.meshes[instance.mesh]
    a, b, c = np.moveaxis(mesh.positions.astype(np.float64)[mesh.triangles], 1, 0)
    volume = np.einsum("ij,ij->", a, np.cross(b, c)) / 6
    return float(volume * abs(np.linalg.det(instance.transform[:, :3])))


def _levels(bodies: Sequence[int], pairs: Sequence[tuple[int, int]]) -> dict[int, int]:
    """For each of `bodies`, the lowest priority first, one more than the greatest level of those that it displaces."""
    rank = {body: place for place, body in enumerate(bodies)}
    level = dict.fromkeys(bodies, 1)
    for low, high in sorted(sorted((rank[a], rank[b])) for a, b in pairs if a != b):
        level[bodies[high]] = max(level[bodies[high]], level[bodies[low]] + 1)
    return level
