"""Lines with the attribute _RADIUS, which are curves. glTF has no attribute of its own for the radius of lines."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..curves import Curves
from ..moving_curves import Strands
from .accessors import Accessors
from .element import Element
from .primitives import finite_part, read_influences, vertex_colors
from .topology import MODES
from .vertices import Vertices

RADIUS = "_RADIUS"


def is_curves(primitive: Element) -> bool:
    attributes = primitive.object("attributes")
    mode = primitive.integer("mode", 4)
    return RADIUS in attributes and "POSITION" in attributes and mode in MODES and MODES[mode][1] == "lines"


@dataclass(frozen=True, eq=False)
class Lines:
    """The strands of a primitive as it stands in the file. `offsets` and `closed` are those of `Curves`; `material` is
    the number of its material, -1 for none, and `tint` the linear RGB of that."""

    primitive: Element
    strands: Strands
    offsets: np.ndarray
    closed: np.ndarray
    material: int
    tint: tuple[float, ...]


def read_lines(accessors: Accessors, primitive: Element, materials: list[Element], joint_count: int) -> Lines | None:
    """The lines of a primitive of which `is_curves`; None, with a warning, if there are too few vertices. `joint_count`
    is the number of its skin's joints, 0 without a skin.

    Lines that share a vertex of the file, the last of one and the first of the next, are one strand. The colour of
    many fibres together is that of the vertices times the material's base colour, where the file has either.
    """
    attributes = primitive.object("attributes")
    vertices = Vertices(accessors, primitive, primitive.integer("mode", 4))
    positions = vertices.floats(attributes, "POSITION", "VEC3")
    radii = vertices.floats(attributes, RADIUS, "SCALAR")[:, 0]
    bad = ~((radii >= 0) & np.isfinite(radii))
    if bad.any():
        worst = int(bad.argmax())
        raise attributes.error(f"vertex {worst}: {radii[worst]:g} is no radius", RADIUS)
    positions, indices = finite_part(attributes, positions, vertices.indices, "lines")
    indices = np.arange(len(positions), dtype=np.uint32) if indices is None else indices
    pairs = indices[:len(indices) // 2 * 2].reshape(-1, 2)
    if "targets" in primitive:
        primitive.warn("the targets of curves are left out", "targets")
    if not len(pairs) or not radii.any():
        primitive.warn("there are too few vertices, or all radii are 0; nothing is drawn")
        return None
    order, offsets, closed = _strands(pairs)
    joints = weights = None
    if joint_count:
        joints, weights = (values[:, order] for values in read_influences(attributes, vertices, joint_count))
    colors = None
    if "COLOR_0" in attributes:
        colors = vertex_colors(attributes, vertices.floats(attributes, "COLOR_0", "VEC3", "VEC4"))[order, :3]
    material: int = primitive.index("material", len(materials), -1)
    return Lines(primitive, Strands(positions[order], radii[order], joints, weights, colors), offsets, closed, material,
                 _tint(materials[material]) if material >= 0 else (1.0,) * 3)


def _strands(pairs: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """The vertices of strands, one after the other, with `offsets` and `closed` of Curves, from pairs of vertices."""
    begins = np.append(True, pairs[1:, 0] != pairs[:-1, 1])
    first = np.flatnonzero(begins)
    count = np.diff(np.append(first, len(pairs)))
    closed = (pairs[first, 0] == pairs[first + count - 1, 1]) & (count >= 3)
    offsets = np.concatenate([[0], np.cumsum(count + ~closed)])
    order = np.empty(offsets[-1], np.intp)
    ends = offsets[1:][~closed] - 1
    is_end = np.zeros(len(order), bool)
    is_end[ends] = True
    order[~is_end] = pairs[:, 0]
    order[ends] = pairs[(first + count - 1)[~closed], 1]
    return order, offsets, closed


def _tint(material: Element) -> tuple[float, ...]:
    surface = material.object("pbrMetallicRoughness")
    if "baseColorTexture" in surface:
        surface.warn("curves are drawn without textures", "baseColorTexture")
    return surface.vector("baseColorFactor", 4, (1.0,) * 4, 0.0, 1.0)[:3]


def placed(accessors: Accessors, lines: Lines, name: str, matrices: np.ndarray, copies: int) -> Curves:
    """So many copies in the world, under the matrices that `Strands.moved` takes."""
    count = len(lines.strands.points)
    if copies > 1:
        accessors.claim(lines.primitive, (copies - 1) * count, f"{copies} copies of {count} points of curves")
    points, radii = lines.strands.moved(matrices)
    offsets = (lines.offsets[None, :-1] + count * np.arange(copies)[:, None]).ravel()
    is_plain = lines.material < 0 and lines.strands.colors is None
    return Curves(name, points, radii, np.append(offsets, copies * count), np.tile(lines.closed, copies),
                  colors=None if is_plain else lines.strands.tinted(lines.tint, copies))
