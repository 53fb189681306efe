"""Meshes: triangles, lines or points, with arrays of vertex attributes."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Literal

import numpy as np

Topology = Literal["triangles", "lines", "points"]


@dataclass(frozen=True, eq=False)
class Mesh:
    """Geometry with one material, drawn by one call. Readers convert strips, fans and loops to one of three topologies.

    `positions` (N, 3) float32, finite. `normals` (N, 3) float32 of unit length, or None (for points and lines).
    `tangents` (N, 4) float32 with w = +-1, or None. `uvs`: up to two (N, 2) float32 arrays, v downwards as in glTF.
    `colors` (N, 4) float32, linear, or None. `indices` (M,) uint32, all less than N, or None for 0..N-1. `material` is
    an index into the scene's materials.
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

    @cached_property
    def bounds(self) -> np.ndarray:
        """The lowest and highest corner of the bounding box of all drawn vertices, (2, 3) float64."""
        used = self.positions
        if self.indices is not None:
            drawn = np.zeros(len(self.positions), bool)
            drawn[self.indices] = True
            used = used[drawn]
        return np.stack([used.min(axis=0), used.max(axis=0)]).astype(np.float64)

    @property
    def element_count(self) -> int:
        """The number of vertices drawn; a vertex that two indices refer to counts twice."""
        return len(self.positions) if self.indices is None else len(self.indices)

    @property
    def triangle_count(self) -> int:
        return self.element_count // 3 if self.topology == "triangles" else 0
