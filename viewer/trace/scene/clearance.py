"""How far the surfaces are from the places inside of a dense medium, at least: shaders/media/clearance.glsl.

Where a boundary refracts, no light can be asked from inside, so that a path has nothing to trace until it gets near a
surface. In media that absorb next to nothing it takes long steps there (deep_media.py). A grid over these solids, or
over all that is in such fog, tells in which balls there is none.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ..layout import CLEARANCE_STEPS
from ..rays.flatten import flatten
from .deep_media import deep_media
from .geometry import TraceGeometry

MOST_CELLS = 1 << 20
_SLACK = 1e-3
"""In cells: more than float32 moves a point or a triangle."""
_BOX_SIDES = (0, 1, 3, 2), (4, 5, 7, 6), (0, 1, 5, 4), (2, 3, 7, 6), (0, 2, 6, 4), (1, 3, 7, 5)
_BOX_TRIANGLES = np.array([corners for a, b, c, d in _BOX_SIDES for corners in ((a, b, c), (a, c, d))])
_CHUNK = 1 << 16  # triangles that are cut at a time


def has_clearance(geometry: TraceGeometry) -> bool:
    """Whether a medium scatters behind a boundary that refracts. Scenes with curves have no grid: it would have to know
    them, too."""
    return geometry.curves is None and bool(_closed(geometry))


def clearance_texels(geometry: TraceGeometry) -> NDArray[np.uint32]:
    """The section of the scene buffer, (n, 4): lowest corner of the grid and cells per tracer unit (float bits); cells
    along x, y and z; then a byte for each cell, x fastest."""
    deep = deep_media(geometry)
    in_fog = 0 in deep
    filled = [k for k, instance in enumerate(geometry.instances) if in_fog or instance.medium in deep]
    boxes = [_box_corners(box) for box in geometry.fog.boxes] if geometry.fog is not None and in_fog else []
    numbers = sorted({*filled, *_closed(geometry)})
    corners = np.concatenate([np.zeros((1, 3))] * in_fog + [_corners(geometry, number) for number in numbers] + boxes)
    low, size = corners.min(axis=0), np.maximum(np.ptp(corners, axis=0), 1e-6)
    cell = float(np.cbrt(size.prod() / MOST_CELLS))
    while np.ceil(size / cell).prod() > MOST_CELLS:
        cell *= 1.05
    cells = np.ceil(size / cell).astype(np.int64)
    vertices, triangles, _ = flatten(geometry, list(enumerate(geometry.instances)))
    for box in boxes:
        triangles = np.concatenate([triangles, len(vertices) + _BOX_TRIANGLES])
        vertices = np.concatenate([vertices, box])
    touched = _touched((vertices.astype(np.float64) - low) / cell, triangles, cells)
    gaps = _gaps(touched, outside=not in_fog)  # all that is in the fog lies in the grid
    steps = np.floor(CLEARANCE_STEPS * (np.sqrt(gaps) - _SLACK)).clip(0, 255).astype(np.uint8)
    head = np.zeros((2, 4), np.uint32)
    head[0] = np.array([*low, 1 / cell], np.float32).view(np.uint32)
    head[1, :3] = cells
    flat = steps.ravel()
    return np.concatenate([head, np.pad(flat, (0, -len(flat) % 16)).view("<u4").astype(np.uint32).reshape(-1, 4)])


def _closed(geometry: TraceGeometry) -> list[int]:
    """The instances that are filled with a scattering medium which light gets into by refraction only."""
    closed = {k for k, medium in enumerate(geometry.media) if medium.scatters} - geometry.open_media
    return [k for k, instance in enumerate(geometry.instances) if instance.medium in closed]


def _corners(geometry: TraceGeometry, number: int) -> NDArray[np.float64]:
    instance = geometry.instances[number]
    positions = geometry.meshes[instance.mesh].positions.astype(np.float64)
    return positions @ instance.transform[:, :3].T + instance.transform[:, 3]


def _box_corners(box: NDArray[np.float64]) -> NDArray[np.float64]:
    """Of the box of a volume, (8, 3), by its matrix to the unit cube."""
    return (np.array(list(np.ndindex(2, 2, 2))) - box[:, 3]) @ np.linalg.inv(box[:, :3]).T


def _touched(vertices: NDArray, triangles: NDArray, cells: NDArray[np.int64]) -> NDArray[np.bool_]:
    """The cells, (z, y, x), that triangles may touch. `vertices` are in cells; triangles are cut in four until their
    boxes are of two cells along each axis, or fewer."""
    touched = np.zeros(cells[::-1], bool)
    left = [triangles[k : k + _CHUNK] for k in range(0, len(triangles), _CHUNK)]
    pending = [vertices[part] for part in left]
    while pending:
        part = pending.pop()
        first = np.floor(part.min(axis=1) - _SLACK).astype(np.int64)
        last = np.floor(part.max(axis=1) + _SLACK).astype(np.int64)
        inside = ((last >= 0) & (first < cells)).all(axis=1)
        small = inside & (last - first <= 1).all(axis=1)
        for corner in np.ndindex(2, 2, 2):
            x, y, z = np.clip(np.where(corner, last[small], first[small]), 0, cells - 1).T
            touched[z, y, x] = True
        a, b, c = part[inside & ~small].transpose(1, 0, 2)
        ab, bc, ca = (a + b) / 2, (b + c) / 2, (c + a) / 2
        fourths = np.stack([(a, ab, ca), (ab, b, bc), (ca, bc, c), (ab, bc, ca)])
        fourths = fourths.transpose(0, 2, 1, 3).reshape(-1, 3, 3)
        pending += [fourths[k : k + _CHUNK] for k in range(0, len(fourths), _CHUNK)]
    return touched


def _gaps(touched: NDArray[np.bool_], outside: bool) -> NDArray[np.uint16]:
    """The squared distance, in cells, between each cell and the nearest one that is touched or, with `outside`, outside
    of the grid.

    Between two cells i and j along an axis there are max(|i - j| - 1, 0). The sum of the squares over the axes is
    minimised axis by axis (Felzenszwalb and Huttenlocher 2012, "Distance Transforms of Sampled Functions").
    """
    most = int(256 / CLEARANCE_STEPS) ** 2
    squares = np.where(np.pad(touched, 1, constant_values=outside), 0, most).astype(np.uint16)
    for axis in range(3):
        found = squares.copy()
        near, far = np.moveaxis(found, axis, 0), np.moveaxis(squares, axis, 0)
        for step in range(1, len(near)):
            gap = np.uint16((step - 1) ** 2)
            if gap >= near.max():
                break
            np.minimum(near[step:], far[:-step] + gap, out=near[step:])
            np.minimum(near[:-step], far[step:] + gap, out=near[:-step])
        squares = found
    return squares[1:-1, 1:-1, 1:-1]
