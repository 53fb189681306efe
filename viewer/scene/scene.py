"""A scene: everything there is to show, as plain data. Nothing here knows OpenGL."""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property

import numpy as np

from .camera import Camera
from .environment import Environment
from .light import Light
from .material import Material
from .mesh import Mesh


@dataclass(frozen=True, eq=False)
class Instance:
    """A mesh placed in the world; `transform` is (4, 4) float64, column vectors (world = transform @ local)."""

    mesh: int
    transform: np.ndarray
    name: str = ""


@dataclass(frozen=True, eq=False)
class Scene:
    """Meshes share materials by index; instances share meshes by index. `warnings` are lines for the user."""

    name: str
    meshes: tuple[Mesh, ...] = ()
    materials: tuple[Material, ...] = ()
    instances: tuple[Instance, ...] = ()
    lights: tuple[Light, ...] = ()
    cameras: tuple[Camera, ...] = ()
    environment: Environment | None = None
    warnings: tuple[str, ...] = ()
    facts: dict[str, object] = field(default_factory=dict)
    """What the file says of itself, for `info`: format, generator, extensions used."""

    @cached_property
    def bounds(self) -> np.ndarray:
        """Lowest and highest corner of all instances, (2, 3) float64; a unit cube about the origin when empty."""
        corners = [_box_corners(self.meshes[i.mesh].bounds) @ i.transform[:3, :3].T + i.transform[:3, 3]
                   for i in self.instances]
        if not corners:
            return np.array([[-0.5] * 3, [0.5] * 3])
        every = np.concatenate(corners)
        return np.stack([every.min(axis=0), every.max(axis=0)])

    @property
    def center(self) -> np.ndarray:
        return self.bounds.mean(axis=0)

    @property
    def radius(self) -> float:
        """Of the bounding sphere about `center`; never 0, so that it can be divided by."""
        radius = float(np.linalg.norm(self.bounds[1] - self.bounds[0])) / 2
        return radius or max(1e-6, float(np.abs(self.center).max()) * 1e-6)

    @property
    def triangle_count(self) -> int:
        return sum(self.meshes[i.mesh].triangle_count for i in self.instances)


def _box_corners(bounds: np.ndarray) -> np.ndarray:
    """The eight corners, (8, 3), of a box given by (2, 3) bounds."""
    pick = np.array([[(k >> axis) & 1 for axis in range(3)] for k in range(8)])
    return bounds[pick, [0, 1, 2]]
