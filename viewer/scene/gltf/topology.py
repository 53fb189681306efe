"""Primitive modes: converts strips, fans and loops to triangles, lines and points (glTF 2.0, 3.7.2.1)."""

from __future__ import annotations

import numpy as np

from ..mesh import Topology

MODES: dict[int, tuple[str, Topology, int]] = {
    0: ("points", "points", 1), 1: ("lines", "lines", 2), 2: ("line loop", "lines", 2), 3: ("line strip", "lines", 2),
    4: ("triangles", "triangles", 3), 5: ("triangle strip", "triangles", 3), 6: ("triangle fan", "triangles", 3)}
"""For each `mode` of a primitive: its name, the topology it becomes, and the least vertices for one element."""

ELEMENT_SIZES: dict[Topology, int] = {"points": 1, "lines": 2, "triangles": 3}
"""The vertices of one element."""


def to_list(mode: int, indices: np.ndarray) -> np.ndarray:
    """Converts (M,) uint32 indices of a glTF mode to (M',) uint32 indices of separate points, lines or triangles."""
    if mode == 2:
        return np.stack([indices, np.roll(indices, -1)], axis=1).ravel()
    if mode == 3:
        return np.stack([indices[:-1], indices[1:]], axis=1).ravel()
    if mode == 5:
        # p_i = {v_i, v_(i+1+i%2), v_(i+2-i%2)}: odd triangles are reversed, so that all have the same winding order.
        i = np.arange(len(indices) - 2)
        odd = i % 2
        return np.stack([indices[i], indices[i + 1 + odd], indices[i + 2 - odd]], axis=1).ravel()
    if mode == 6:
        first = np.full(len(indices) - 2, indices[0])
        return np.stack([indices[1:-1], indices[2:], first], axis=1).ravel()
    size = {0: 1, 1: 2, 4: 3}[mode]
    return indices[:len(indices) // size * size]
