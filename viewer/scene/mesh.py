"""Geometry as the renderers take it: triangles, lines or points with flat arrays of attributes."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Literal

import numpy as np

Topology = Literal["triangles", "lines", "points"]


@dataclass(frozen=True, eq=False)
class Mesh:
    """One draw's worth of geometry with one material. Readers turn strips, fans and loops into these three topologies.

    positions (N, 3) float32, finite; normals (N, 3) float32 unit or None (points and lines need none);
    tangents (N, 4) float32 with w = +-1, or None; uvs: up to two (N, 2) float32 arrays, v downwards as in glTF;
    colors (N, 4) float32 linear or None; indices (M,) uint32, every one < N, or None for 0..N-1.
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
        """Lowest and highest corner, (2, 3) float64, of the vertices that are drawn."""
        used = self.positions
        if self.indices is not None:
            drawn = np.zeros(len(self.positions), bool)
            drawn[self.indices] = True
            used = used[drawn]
        return np.stack([used.min(axis=0), used.max(axis=0)]).astype(np.float64)

    @property
    def element_count(self) -> int:
        """Vertices drawn (an index used twice counts twice)."""
        return len(self.positions) if self.indices is None else len(self.indices)

    @property
    def triangle_count(self) -> int:
        return self.element_count // 3 if self.topology == "triangles" else 0
