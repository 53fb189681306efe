"""How thick the solids are that scatter light, kept as long as poses do no more than move, turn and scale them."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import combinations

import numpy as np
from numpy.typing import NDArray

from ..gpu.context import Context
from ..scene.scene import Scene

_ALIKE = 1e-5
"""The relative difference up to which two matrices count as the same."""


class Interiors:
    """The thickness behind vertices of the solids that were measured last."""

    def __init__(self, context: Context) -> None:
        self._context = context
        self._measured: tuple[Scene, list[int], dict[int, NDArray[np.float32]]] | None = None
        self._factors: list[float] = []

    def take(self, scene: Scene, solids: Sequence[int]) -> dict[int, NDArray[np.float32]] | None:
        """Thickness, roundness, ways and other sides of the instances `solids` of `scene`, as
        `viewer.trace.chords.thickness_at_vertices` gives them; None if they are those of the last call."""
        factors = self._changes(scene, list(solids))
        if factors is None:
            from ..trace.chords import thickness_at_vertices

            found = thickness_at_vertices(self._context, scene, solids) if solids else {}
            self._measured, self._factors = (scene, list(solids), found), [1.0] * len(solids)
            return found
        if factors == self._factors or self._measured is None:
            return None
        self._factors = factors
        return {k: found * np.float32([factor, 1.0, factor, 1.0, 1.0, 1.0, 1.0])
                for (k, found), factor in zip(self._measured[2].items(), factors, strict=True)}

    def _changes(self, scene: Scene, solids: list[int]) -> list[float] | None:
        """By what each thickness differs, in radii of the scene, from the one measured; None: by more than a factor."""
        if self._measured is None or self._measured[1] != solids:
            return None
        before = self._measured[0]
        if any(scene.meshes[scene.instances[k].mesh] is not before.meshes[before.instances[k].mesh] for k in solids):
            return None
        moves = [_change(before.instances[k].transform, scene.instances[k].transform) for k in solids]
        if not all(is_similar(move) for move in moves):
            return None
        # A chord ends at any of the solids, so that those that touch have to move as one.
        if any(not _is_same(moves[a], moves[b]) and (_touch(before, solids[a], solids[b]) or
                                                     _touch(scene, solids[a], solids[b]))
               for a, b in combinations(range(len(solids)), 2)):
            return None
        return [float(np.cbrt(abs(np.linalg.det(move[:3, :3])))) * before.radius / scene.radius for move in moves]


def _change(before: NDArray, after: NDArray) -> NDArray[np.float64]:
    """The matrix (4, 4) that takes the instance from one place to the other; not finite if there is none."""
    if np.array_equal(before, after):
        return np.eye(4)
    try:
        return after @ np.linalg.inv(before)
    except np.linalg.LinAlgError:
        return np.full((4, 4), np.nan)


def is_similar(move: NDArray[np.float64]) -> bool:
    """Whether a matrix (4, 4) moves, turns, mirrors and scales alike along all axes, and does no more."""
    square = move[:3, :3].T @ move[:3, :3]
    scale = np.trace(square) / 3
    return bool(scale > 0 and np.abs(square - scale * np.eye(3)).max() <= _ALIKE * scale)


def _is_same(a: NDArray, b: NDArray) -> bool:
    return bool(np.abs(a - b).max() <= _ALIKE * np.abs(a).max())


def _touch(scene: Scene, a: int, b: int) -> bool:
    """Whether the boxes of two instances meet."""
    first, second = scene.corners[a], scene.corners[b]
    return bool((first.min(axis=0) <= second.max(axis=0)).all() and (second.min(axis=0) <= first.max(axis=0)).all())
