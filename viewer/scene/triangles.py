"""The triangles of a mesh as an array."""

from __future__ import annotations

import numpy as np

from .mesh import Mesh


def triangles_of(mesh: Mesh) -> np.ndarray:
    """The vertex indices of each triangle's corners, (T, 3) uint32; T = 0 for a mesh of lines or points."""
    indices = np.arange(len(mesh.positions), dtype=np.uint32) if mesh.indices is None else mesh.indices
    return np.ascontiguousarray(indices[: 3 * mesh.triangle_count].reshape(-1, 3), np.uint32)
