"""Meshes between the cells of a coarse grid, which scattered light does not pass (viewer/bake/diffusion.py)."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ..bake.diffusion import Walls
from ..plan.model import Draw
from ..scene.frame import Frame
from ..scene.mesh import Mesh
from ..scene.scene import Scene
from ..scene.triangles import triangles_of

_WHITEST = 0.98
"""No wall reflects more: inside of a closed white one light would never end."""


def media_walls(frame: Frame, draws: Sequence[Draw], reflectance: np.ndarray, corner: Sequence[float], length: float,
                side: int) -> Walls:
    """The opaque triangles among `draws` in a grid of `side` cells along each side. Its lowest corner and its length
    are in the space of the frame."""
    scene, cell = frame.scene, length / side
    from_world = np.eye(4) / (frame.unit * cell)
    from_world[:3, 3] = frame.position(np.zeros(3)) / cell - np.divide(corner, cell) - 0.5
    between = np.zeros((3, side, side, side), bool)
    for draw in draws:
        if draw.alpha_mode == "opaque" and draw.hides_sky:
            for k in _met(scene, draw.instances or (draw.instance,), from_world):
                instance = scene.instances[k]
                _mark(between, _large(scene.meshes[instance.mesh], from_world[:3] @ instance.transform, side))
    return Walls(between, np.minimum(reflectance, _WHITEST))


def _met(scene: Scene, instances: Sequence[int], from_world: np.ndarray) -> np.ndarray:
    """The instances whose boxes meet lines between the centres of cells: whole numbers along two of the axes."""
    places = scene.corners[list(instances)] @ from_world[:3, :3].T + from_world[:3, 3]
    holds = np.floor(places.max(axis=1)) >= np.ceil(places.min(axis=1))
    return np.array(instances)[holds.sum(axis=1) >= 2]


def _large(mesh: Mesh, to_cells: np.ndarray, side: int) -> np.ndarray:
    """The corners (T, 3, 3), in cells, of the triangles that lie between different whole numbers along two of the axes
    or more. A mesh has few of them, however many triangles it has."""
    triangles = triangles_of(mesh)
    places = [mesh.positions @ row[:3] + row[3] for row in np.float32(to_cells)]  # an axis at a time: much quicker
    x, y, z = (np.clip(np.floor(place), -1, side).astype(np.int32) + 1 for place in places)
    a, b, c = (x | y << 8 | z << 16)[triangles.T]
    differing = a ^ b | a ^ c
    some = np.flatnonzero(differing)
    spanned = np.stack([differing[some] & 0xff << shift for shift in (0, 8, 16)])
    large = triangles[some[np.count_nonzero(spanned, axis=0) >= 2]]
    return np.stack([place[large] for place in places], axis=-1)


def _mark(between: np.ndarray, triangles: np.ndarray) -> None:
    """Set [axis, z, y, x] of `between` where a triangle stands between the centre of the cell (x, y, z) and that of the
    next one along an axis. `triangles` (T, 3, 3) are in cells, whose centres are whole numbers."""
    side = between.shape[-1]
    first = np.clip(np.ceil(triangles.min(axis=1)), 0, side).astype(int)
    counts = np.maximum(np.clip(np.floor(triangles.max(axis=1)), -1, side - 1).astype(int) - first + 1, 0)
    for axis in range(3):
        u, v = (k for k in range(3) if k != axis)
        lines = counts[:, u] * counts[:, v]  # along the axis, that pass through the box of each triangle
        of = np.repeat(np.arange(len(triangles)), lines)
        nth = np.arange(len(of)) - np.repeat(np.cumsum(lines) - lines, lines)
        place = np.stack([first[of, u] + nth % counts[of, u], first[of, v] + nth // counts[of, u]], axis=1)
        corner, along, beside = triangles[of, 0], *(triangles[of, k] - triangles[of, 0] for k in (1, 2))
        to = place - corner[:, [u, v]]
        area = _cross(along[:, [u, v]], beside[:, [u, v]])
        with np.errstate(divide="ignore", invalid="ignore"):  # a triangle along the axis meets no line
            s, t = _cross(to, beside[:, [u, v]]) / area, _cross(along[:, [u, v]], to) / area
            height = np.floor(corner[:, axis] + s * along[:, axis] + t * beside[:, axis])
            meets = (s >= 0) & (t >= 0) & (s + t <= 1) & (height >= 0) & (height < side - 1)
        cells = np.zeros((int(meets.sum()), 3), int)
        cells[:, [u, v]], cells[:, axis] = place[meets], height[meets]
        between[axis, cells[:, 2], cells[:, 1], cells[:, 0]] = True


def _cross(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    return a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0]
