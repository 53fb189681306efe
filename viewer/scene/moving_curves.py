"""Curves that the nodes of a file place, or the joints of a skin."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from .curves import Curves
from .deform import blend_matrices
from .rig import Skin


@dataclass(frozen=True, eq=False)
class Strands:
    """Points and radii as they stand in a file, (n, 3) and (n,) float32, and the `colors` of points, (n, 3) or None. A
    skin moves them as `joints` and `weights`, (K, n) each, say (see `Deformation`); None without one."""

    points: np.ndarray
    radii: np.ndarray
    joints: np.ndarray | None = None
    weights: np.ndarray | None = None
    colors: np.ndarray | None = None

    def tinted(self, tint: Sequence[float], copies: int) -> np.ndarray:
        """The colours of so many copies, (copies * n, 3) float32: the points' times `tint`, linear RGB."""
        colors = np.ones_like(self.points) if self.colors is None else self.colors
        return np.tile(colors * np.asarray(tint, np.float32), (copies, 1))

    def moved(self, matrices: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Points and radii in the world: a copy for each of `matrices` (C, 4, 4) or, with joints, one copy that theirs
        move. A radius takes the mean scale of its point's matrix."""
        if self.joints is None or self.weights is None:
            points = np.concatenate([self.points @ m[:3, :3].T + m[:3, 3] for m in matrices])
            return points, np.outer(_scales(matrices[:, :3, :3]), self.radii).ravel()
        blend = blend_matrices(self.joints, self.weights, matrices)
        points = np.einsum("ijn,nj->ni", blend[:, :3], self.points) + blend[:, 3].T
        return points, _scales(np.moveaxis(blend[:, :3], 2, 0)) * self.radii


def _scales(linear: np.ndarray) -> np.ndarray:
    return np.cbrt(np.abs(np.linalg.det(linear)))


@dataclass(frozen=True, eq=False)
class Mover:
    """What moves curves: the node of this number, by `offsets` (C, 4, 4) from each copy to it, or the joints of a
    `skin`."""

    node: int
    offsets: np.ndarray
    skin: Skin | None = None

    def matrices(self, world: np.ndarray, hidden: np.ndarray) -> np.ndarray:
        """What `Strands.moved` takes, from the matrices of all nodes (N, 4, 4) and from which of them are hidden.
        Hidden curves are shrunk to a point, so that they draw nothing."""
        out = world[self.node] @ self.offsets if self.skin is None else self.skin.matrices(world)
        if hidden[self.node]:
            out[:, :3, :3] = 0.0
        return out


@dataclass(frozen=True, eq=False)
class MovingCurves:
    """Curves of a scene as they are at rest, and what they are made from at other times. `material` is the number in
    the file of the material whose base colour tints them, -1 for none."""

    at_rest: Curves
    strands: Strands
    mover: Mover
    material: int = -1

    def at(self, matrices: np.ndarray, tint: np.ndarray | None) -> Curves:
        """The curves under the mover's matrices, tinted by (3,) or, with None, as at rest; `at_rest` itself where they
        are as there.

        Raises UsageError if a point comes where no float32 is.
        """
        points, radii = (values.astype(np.float32) for values in self.strands.moved(matrices))
        rest = self.at_rest
        colors = rest.colors
        if tint is not None:
            tinted = self.strands.tinted(tint.tolist(), len(self.mover.offsets))
            colors = colors if colors is not None and np.array_equal(tinted, colors) else tinted
        if np.array_equal(points, rest.points) and np.array_equal(radii, rest.radii) and colors is rest.colors:
            return rest
        return replace(rest, points=points, radii=radii, colors=colors)
