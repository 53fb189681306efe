"""Meshes: triangles, lines or points, with arrays of vertex attributes."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property
from typing import Literal, get_args

import numpy as np

from ..base.expect import expect, expect_index
from ..errors import UsageError
from .arrays import HoldsArrays, scene_array

Topology = Literal["triangles", "lines", "points"]
ELEMENT_SIZES: dict[Topology, int] = {"triangles": 3, "lines": 2, "points": 1}
"""How many corners one of them has."""
_DIRECTIONS = 64
_CHUNK = 1 << 14
"""Vertices per piece."""


@dataclass(frozen=True, eq=False, repr=False)
class Mesh(HoldsArrays):
    """Geometry with one material, drawn by one call. Readers convert strips, fans and loops to one of three topologies.

    `positions` (N, 3) float32, finite. `normals` (N, 3) float32 of unit length, or None (for points and lines).
    `tangents` (N, 4) float32 with w = +-1, or None. `uvs`: up to two (N, 2) float32 arrays, v downwards as in glTF.
    `colors` (N, 4) float32, linear, or None; they may be given as (N, 3), and as uint8 or uint16 for 0 to 1.
    `indices` (M,) uint32, all less than N, or None for 0..N-1. `material` is an index into the scene's materials.

    Arrays of other number types are converted, and all are held read-only (see `scene_array`). Raises UsageError for
    what cannot be converted.
    """

    name: str
    positions: np.ndarray
    material: int
    topology: Topology = "triangles"
    indices: np.ndarray | None = None
    normals: np.ndarray | None = None
    tangents: np.ndarray | None = None
    uvs: tuple[np.ndarray, ...] = ()
    colors: np.ndarray | None = None

    def __post_init__(self) -> None:
        if self.topology not in get_args(Topology):
            raise UsageError(f"Mesh.topology is {self.topology!r}, not one of {', '.join(get_args(Topology))}")
        expect(self.name, str, "Mesh.name", "text")
        expect_index(self.material, "Mesh.material", "a material")
        positions = scene_array(self.positions, "Mesh.positions", np.float32, None, 3)
        count = len(positions)
        self._set("positions", positions)
        for name, columns in (("normals", 3), ("tangents", 4)):
            if getattr(self, name) is not None:
                self._set(name, scene_array(getattr(self, name), f"Mesh.{name}", np.float32, count, columns))
        if self.colors is not None:
            self._set("colors", _checked(scene_array(_as_rgba(self.colors), "Mesh.colors", np.float32, count, 4)))
        expect(self.uvs, (tuple, list), "Mesh.uvs", "a tuple of arrays")
        if len(self.uvs) > 2:
            raise UsageError(f"Mesh.uvs is a tuple of at most two arrays, not of {len(self.uvs)}")
        self._set("uvs", tuple(scene_array(uv, f"Mesh.uvs[{k}]", np.float32, count, 2)
                               for k, uv in enumerate(self.uvs)))
        if self.indices is not None:
            indices = scene_array(self.indices, "Mesh.indices", np.uint32, None)
            if indices.size and indices.max() >= count:
                raise UsageError(f"Mesh.indices: index {indices.max()}, but there are {count} positions")
            self._set("indices", indices)
        if self.element_count < ELEMENT_SIZES[self.topology]:
            of = "positions" if self.indices is None else "indices"
            raise UsageError(f"Mesh.{of} has {len(getattr(self, of))}: a mesh without {self.topology} cannot be drawn")

    def __repr__(self) -> str:
        """In one line: the arrays would fill pages."""
        given = [name for name in ("indices", "normals", "tangents", "colors") if getattr(self, name) is not None]
        given += [f"{len(self.uvs)} uvs"] * bool(self.uvs)
        words = ", ".join([self.topology, f"{len(self.positions)} positions", *given])
        return f"<Mesh {self.name!r}: {words}>"

    @cached_property
    def drawn(self) -> np.ndarray:
        """The positions that are drawn, each once, (K, 3) float32."""
        return drawn_positions(self.positions, self.indices)

    def drawn_chunks(self) -> Iterator[np.ndarray]:
        """`drawn` in (n, 3) float64, a piece at a time, so that what is computed of a piece stays in the cache."""
        for first in range(0, len(self.drawn), _CHUNK):
            yield self.drawn[first:first + _CHUNK].astype(np.float64)

    @cached_property
    def bounds(self) -> np.ndarray:
        """The lowest and highest corner of the bounding box of all drawn vertices, (2, 3) float64."""
        return np.stack([self.drawn.min(axis=0), self.drawn.max(axis=0)]).astype(np.float64)

    @cached_property
    def outermost(self) -> np.ndarray:
        """Of the positions that are drawn those that are the farthest in some of 64 directions, or all where there are
        no more, (K, 3) float64. Their hull is nearly that of the mesh: that of a ball is up to 4 % smaller."""
        if len(self.drawn) <= _DIRECTIONS:
            return self.drawn.astype(np.float64)
        k = np.arange(_DIRECTIONS) + 0.5
        height, turn = 1 - 2 * k / _DIRECTIONS, k * (np.pi * (3 - 5**0.5))  # a Fibonacci lattice on the sphere
        across = np.sqrt(1 - height**2)
        directions = np.stack([across * np.cos(turn), height, across * np.sin(turn)], axis=1)
        farthest, reached = np.zeros((_DIRECTIONS, 3)), np.full(_DIRECTIONS, -np.inf)
        for chunk in self.drawn_chunks():
            reach = directions @ chunk.T
            is_farther = reach.max(axis=1) > reached
            farthest[is_farther] = chunk[reach[is_farther].argmax(axis=1)]
            reached = np.maximum(reached, reach.max(axis=1))
        return np.unique(farthest, axis=0)

    @cached_property
    def opening(self) -> float:
        """The area of the opening of what the triangles enclose, over that of the triangles: 0 closed, 1 a plane.

        The areas of a closed surface cancel as vectors, so that what is left of them is that of a flat opening. Of what
        the inner sides of a convex vessel see, it is such a share, as form factors are reciprocal. 1, too, where the
        triangles face the inside, and of points and lines, which enclose nothing.
        """
        if self.topology != "triangles":
            return 1.0
        corners = self.positions if self.indices is None else self.positions[self.indices]
        a, b, c = (corners.reshape(-1, 3, 3) - self.bounds.mean(axis=0)).transpose(1, 0, 2)
        areas = np.cross(b - a, c - a)
        left, walls = float(np.linalg.norm(areas.sum(axis=0))), float(np.linalg.norm(areas, axis=1).sum())
        return min(left / walls, 1.0) if walls > 0 and np.vdot(a, areas) > 0 else 1.0

    @property
    def layout(self) -> tuple[object, ...]:
        """All that programs and the sizes of buffers depend on. Poses of one mesh have the same layout."""
        return (self.material, self.topology, len(self.positions), self.element_count, self.indices is None,
                self.normals is None, self.tangents is None, len(self.uvs), self.colors is None)

    @property
    def element_count(self) -> int:
        """The number of vertices drawn; a vertex that two indices refer to counts twice."""
        return len(self.positions) if self.indices is None else len(self.indices)

    @property
    def triangle_count(self) -> int:
        return self.element_count // 3 if self.topology == "triangles" else 0


def _as_rgba(colors: np.ndarray) -> np.ndarray:
    """With alpha, and 8 or 16 bits scaled to [0, 1]; what else is wrong with them is for `scene_array` to say."""
    if not isinstance(colors, np.ndarray):
        return colors
    if colors.dtype in (np.uint8, np.uint16):
        colors = colors / np.float32(np.iinfo(colors.dtype).max)
    if colors.ndim == 2 and colors.shape[1] == 3:
        colors = np.concatenate([colors, np.ones((len(colors), 1), np.float32)], axis=1)
    return colors


def _checked(colors: np.ndarray) -> np.ndarray:
    if colors.size and not (colors.min() >= 0 and colors.max() <= 1):
        raise UsageError(f"Mesh.colors are from {colors.min():g} to {colors.max():g}, not from 0 to 1; make those "
                         "up to 255 uint8")
    return colors


def drawn_positions(positions: np.ndarray, indices: np.ndarray | None) -> np.ndarray:
    """The positions (N, 3) that the indices name, each once; all of them without indices."""
    if indices is None:
        return positions
    is_drawn = np.zeros(len(positions), bool)
    is_drawn[indices] = True
    return positions if is_drawn.all() else positions[is_drawn]
