"""Copies the triangles of instances to tracer space."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from ..layout import KIND_SHIFT, MISS

if TYPE_CHECKING:
    from ..scene.geometry import TraceGeometry, TraceInstance

_CHUNK = 1 << 20  # vertices that are transformed at a time


def flatten(
    geometry: TraceGeometry, instances: list[tuple[int, TraceInstance]]
) -> tuple[NDArray[np.float32], NDArray[np.int32], NDArray[np.uint32]]:
    """Vertices (V, 3) in tracer space, triangles (T, 3), and (T + 1, 2) the x and y of each triangle's hits.

    The last row is that of a miss, so that the index -1, with which Embree reports a miss, finds it.
    """
    by_mesh: dict[int, list[tuple[int, TraceInstance]]] = {}
    for index, instance in instances:
        by_mesh.setdefault(instance.mesh, []).append((index, instance))
    vertices, triangles, hits, first = [np.empty((0, 3), np.float32)], [np.empty((0, 3), np.int32)], [], 0
    for mesh_index, placed in by_mesh.items():
        mesh = geometry.meshes[mesh_index]
        size, count = len(mesh.positions), len(mesh.triangles)
        if not size or not count:
            continue
        matrices = np.array([instance.transform for _, instance in placed])
        for chunk in np.array_split(matrices, -(-len(matrices) * size // _CHUNK)):
            moved = mesh.positions.astype(np.float64) @ chunk[:, :, :3].transpose(0, 2, 1) + chunk[:, None, :, 3]
            vertices.append(moved.astype(np.float32).reshape(-1, 3))
        firsts = first + size * np.arange(len(placed), dtype=np.int32)
        triangles.append((mesh.triangles.astype(np.int32) + firsts[:, None, None]).reshape(-1, 3))
        codes = np.array([instance.kind.number << KIND_SHIFT | index for index, instance in placed], np.uint32)
        pairs = np.empty((len(placed), count, 2), np.uint32)
        pairs[..., 0], pairs[..., 1] = codes[:, None], np.arange(count)
        hits.append(pairs.reshape(-1, 2))
        first += size * len(placed)
    hits.append(np.array([(MISS, 0)], np.uint32))
    return np.concatenate(vertices), np.concatenate(triangles), np.concatenate(hits)
