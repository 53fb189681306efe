"""A scene: everything there is to show, as plain data. Nothing here knows OpenGL."""

from __future__ import annotations

from dataclasses import dataclass, field, fields, replace
from functools import cached_property
from typing import Any

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
        if not self.instances:
            return np.array([[-0.5] * 3, [0.5] * 3])
        return np.stack([self.corners.min(axis=(0, 1)), self.corners.max(axis=(0, 1))])

    @cached_property
    def corners(self) -> np.ndarray:
        """The corners of each instance's box in the world, (instances, 8, 3) float64."""
        if not self.instances:
            return np.zeros((0, 8, 3))
        boxes = np.stack([_box_corners(self.meshes[i.mesh].bounds) for i in self.instances])
        transforms = np.stack([i.transform for i in self.instances])
        return boxes @ transforms[:, :3, :3].transpose(0, 2, 1) + transforms[:, None, :3, 3]

    @cached_property
    def center(self) -> np.ndarray:
        return self.bounds.mean(axis=0)

    @cached_property
    def radius(self) -> float:
        """Of the bounding sphere about `center`, from the vertices; never 0, so that it can be divided by."""
        center, radius = self.center, 0.0
        reach = np.linalg.norm(self.corners - center, axis=2).max(axis=1, initial=0.0)
        for k in np.argsort(-reach):
            if reach[k] <= radius:
                break  # no vertex of this box, or of those after it, is farther out than what was found
            instance = self.instances[k]
            mesh = self.meshes[instance.mesh]
            used = np.full(len(mesh.positions), mesh.indices is None)
            if mesh.indices is not None:
                used[mesh.indices] = True
            points = mesh.positions[used] @ instance.transform[:3, :3].T + (instance.transform[:3, 3] - center)
            radius = max(radius, float(np.sqrt(np.einsum("ij,ij->i", points, points).max())))
        if not self.instances:
            return float(np.sqrt(0.75))
        return radius or max(1e-6, float(np.abs(center).max()) * 1e-6)

    def relit(self, **changes: Any) -> Scene:
        """A copy with other `environment` or `lights`; what was worked out from the geometry is not lost."""
        copy = replace(self, **changes)
        for name in ("bounds", "corners", "center", "radius"):
            if name in self.__dict__:
                copy.__dict__[name] = self.__dict__[name]
        return copy

    def digest_parts(self) -> dict[str, object]:
        """What pictures of the scene depend on, for `base.digest`."""
        told = ("name", "warnings", "facts")
        return {item.name: getattr(self, item.name) for item in fields(self) if item.name not in told}

    @property
    def triangle_count(self) -> int:
        return sum(self.meshes[i.mesh].triangle_count for i in self.instances)


def _box_corners(bounds: np.ndarray) -> np.ndarray:
    """The eight corners, (8, 3), of a box given by (2, 3) bounds."""
    pick = np.array([[(k >> axis) & 1 for axis in range(3)] for k in range(8)])
    return bounds[pick, [0, 1, 2]]
