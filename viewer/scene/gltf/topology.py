"""Primitive modes: converts strips, fans and loops to triangles, lines and points (glTF 2.0, 3.7.2.1)."""

from __future__ import annotations

import numpy as np

from ..mesh import Topology

MODES: dict[int, tuple[str, Topology, int]] = {
    0: ("points", "points", 1), 1: ("lines", "lines", 2), 2: ("line loop", "lines", 2), 3: ("line strip", "lines", 2),
    4: ("triangles", "triangles", 3), 5: ("triangle strip", "triangles", 3), 6: ("triangle fan", "triangles", 3)}
"""For each `mode` of a primitive: its name, the topology it becomes, and the least vertices for one element."""

RESTART = "EXT_mesh_primitive_restart"
RESTARTABLE = (2, 3, 5, 6)
"""The modes whose indices a restart value may split, each part a loop, strip or fan of its own (RESTART)."""


def to_list(mode: int, indices: np.ndarray, restart: int | None) -> np.ndarray:
    """Converts (M,) uint32 indices of a glTF mode to (M',) uint32 indices of separate points, lines or triangles.

    `restart` is the value between two parts of the indices; only RESTARTABLE modes have it.
    """
    count = len(indices)
    if mode not in RESTARTABLE:
        size = {0: 1, 1: 2, 4: 3}[mode]
        return indices[:count // size * size]
    is_cut = np.zeros(count, bool) if restart is None else indices == restart
    begin = np.maximum.accumulate(np.where(is_cut, np.arange(1, count + 1), 0))  # of the part of each index
    if mode == 2:
        i = np.flatnonzero(~is_cut)
        is_last = np.append(is_cut[1:], True)[i]
        following = np.where(is_last, begin[i], i + 1)
        elements = np.stack([i, following], axis=1)[following != i]
    elif mode == 3:
        i = np.flatnonzero(~(is_cut[:-1] | is_cut[1:]))
        elements = np.stack([i, i + 1], axis=1)
    else:
        i = np.flatnonzero(~(is_cut[:-2] | is_cut[1:-1] | is_cut[2:]))
        if mode == 5:
            # p_i = {v_i, v_(i+1+i%2), v_(i+2-i%2)}: odd triangles are reversed, so that all have one winding order.
            odd = (i - begin[i]) % 2
            elements = np.stack([i, i + 1 + odd, i + 2 - odd], axis=1)
        else:
            elements = np.stack([i + 1, i + 2, begin[i]], axis=1)
    return indices[elements.ravel()]
