"""The rectangles of pixels that meshes may touch. One about a round body is half empty, so there are rows of them, too.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from ..scene.frame import Frame

Box = tuple[int, int, int, int]
"""x, y, width and height in pixels, from the lower left."""

_ROW = 32
"""Height in pixels."""
_CELLS = 8
"""Of a mesh, along each side of its box."""
_ANGLES = (np.arange(32) + 0.5) * (math.pi / 16)
_DIRECTIONS = np.stack([np.cos(_ANGLES), np.sin(_ANGLES)])
"""(2, 32), none of them upright."""


def cell_corners(positions: np.ndarray) -> np.ndarray:
    """The corners (N, 3) of a few boxes that hold all `positions` (V, 3), V > 0."""
    positions = positions.astype(np.float64)
    low = positions.min(axis=0)
    cells = ((positions - low) / np.maximum(positions.max(axis=0) - low, 1e-300) * (_CELLS - 1e-3)).astype(int)
    numbers = cells @ [1, _CELLS, _CELLS * _CELLS]
    order = np.argsort(numbers, kind="stable")
    starts = np.flatnonzero(np.diff(numbers[order], prepend=-1))
    ends = [bound.reduceat(positions[order], starts) for bound in (np.minimum, np.maximum)]
    return np.concatenate([np.stack([ends[k >> axis & 1][:, axis] for axis in range(3)], axis=1) for k in range(8)])


def pixel_rows(frame: Frame, points: np.ndarray, box: Box) -> list[Box]:
    """Rectangles within `box` that hold all its pixels of the convex hull of `points` (N, 3), in world axes.

    The hull lies between its tangents in 32 directions.
    """
    clip = np.concatenate([(points - frame.camera.eye) / frame.unit, np.ones((len(points), 1))],
                          axis=1) @ frame.view_projection.T
    if (clip[:, 3] <= 1e-6).any():  # reaches behind the eye
        return [box]
    x, y, width, height = box
    pixels = (clip[:, :2] / clip[:, 3:] + 1) / 2 * frame.size
    ends = np.append(np.arange(y, y + height, _ROW), y + height)
    reach = ((pixels @ _DIRECTIONS).max(axis=0) + 1 - ends[:, None] * _DIRECTIONS[1]) / _DIRECTIONS[0]
    is_right = _DIRECTIONS[0] > 0
    right = np.ceil(np.maximum(reach[:-1], reach[1:])[:, is_right].min(axis=1)).clip(x, x + width)
    left = np.floor(np.minimum(reach[:-1], reach[1:])[:, ~is_right].max(axis=1)).clip(x, x + width)
    rows = []
    for low, high, first, last in zip(ends[:-1].tolist(), ends[1:].tolist(), left.tolist(), right.tolist()):
        if first < last:
            rows.append((int(first), low, int(last - first), high - low))
    return rows


def pixel_box(frame: Frame, instance: int, part: Box) -> Box:
    """The rectangle of pixels (x, y, width, height) that an instance may touch, within `part` of the picture."""
    x, y, width, height = part
    corners = (frame.scene.corners[instance] - frame.camera.eye) / frame.unit
    clip = np.concatenate([corners, np.ones((8, 1))], axis=1) @ frame.view_projection.T
    if (clip[:, 3] <= 1e-6).any():  # reaches behind the eye
        return part
    pixels = (clip[:, :2] / clip[:, 3:] + 1) / 2 * frame.size
    low = np.maximum(pixels.min(axis=0) - 1, (x, y))
    high = np.minimum(pixels.max(axis=0) + 1, (x + width, y + height))
    left, bottom = math.floor(low[0]), math.floor(low[1])
    return left, bottom, max(math.ceil(high[0]) - left, 0), max(math.ceil(high[1]) - bottom, 0)


def union(boxes: Sequence[Box]) -> Box:
    """The rectangle about all that are not empty."""
    corners = np.array([(x, y, x + width, y + height) for x, y, width, height in boxes if width and height])
    if not len(corners):
        return 0, 0, 0, 0
    (left, bottom), (right, top) = corners[:, :2].min(axis=0).tolist(), corners[:, 2:].max(axis=0).tolist()
    return left, bottom, right - left, top - bottom


def around(hole: Box, box: Box) -> list[Box]:
    """The rectangles that are left of `box` without `hole`, which lies in it or is empty."""
    x, y, width, height = box
    if not hole[2]:
        return [box]
    left, bottom, right, top = hole[0], hole[1], hole[0] + hole[2], hole[1] + hole[3]
    parts = ((x, y, width, bottom - y), (x, top, width, y + height - top),
             (x, bottom, left - x, top - bottom), (right, bottom, x + width - right, top - bottom))
    return [part for part in parts if part[2] and part[3]]
