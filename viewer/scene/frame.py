"""The numbers of one frame: matrices relative to the eye, in units of the scene's radius.

All positions a shader sees are world axes with the eye at the origin and the scene's bounding radius as the unit,
worked out in float64 and only then rounded. A scene of a micron and one of a thousand kilometres, at the origin or a
million units away, give the same float32 numbers and so the same picture.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike

from .camera import Camera
from .scene import Scene


@dataclass(frozen=True, eq=False)
class Frame:
    scene: Scene
    camera: Camera
    size: tuple[int, int]

    @property
    def unit(self) -> float:
        """World units in one unit of the shaders."""
        return self.scene.radius

    @property
    def aspect(self) -> float:
        return self.size[0] / self.size[1]

    @cached_property
    def _to_eye(self) -> np.ndarray:
        """World to eye-relative space, (4, 4)."""
        matrix = np.eye(4) / self.unit
        matrix[:3, 3] = -self.camera.eye / self.unit
        matrix[3, 3] = 1.0
        return matrix

    def model(self, transform: np.ndarray) -> np.ndarray:
        """Mesh (world = transform @ local) to eye-relative space, (4, 4) float64."""
        return self._to_eye @ transform

    def scale(self, transform: np.ndarray) -> float:
        """The mean scale of the mesh in eye-relative space: the cube root of what a volume is multiplied by."""
        return float(np.cbrt(abs(np.linalg.det(transform[:3, :3] / self.unit))))

    def position(self, point: ArrayLike) -> np.ndarray:
        """A world position, eye-relative, (3,) float64."""
        return (np.asarray(point, np.float64) - self.camera.eye) / self.unit

    @cached_property
    def view_projection(self) -> np.ndarray:
        """Eye-relative space to clip space, (4, 4) float64; near and far fit what is in the scene."""
        near, far = self.depth_range
        camera = self.camera
        if camera.height is not None:
            camera = Camera(camera.pose, camera.fov_y, camera.height / self.unit)
        rotation = np.eye(4)
        rotation[:3, :3] = camera.pose[:3, :3].T
        return camera.projection(self.aspect, near, far) @ rotation

    @cached_property
    def depth_range(self) -> tuple[float, float]:
        """Near and far in eye-relative units, as tight about the instances as their boxes allow."""
        depths = (self.scene.corners.reshape(-1, 3) - self.camera.eye) @ self.camera.forward / self.unit
        if not len(depths):
            return 0.01, 1.0
        low, high = float(depths.min()), float(depths.max())
        margin = 1e-3 * (high - low) + 1e-6 * max(abs(low), abs(high))
        low, high = low - margin, high + margin
        if self.camera.height is not None:
            return low, high
        high = max(high, 1e-3)
        # At 1e5:1 24 bits of depth tell surfaces apart at the far end that are 0.6 % of their distance from each other.
        low = max(low, high * 1e-5)
        # z / w at the far end differs from 1 by parts of low / high, and float32 must not round it beyond.
        return low, high * (1 + 2.0**-21 * high / low)

    @cached_property
    def visible(self) -> np.ndarray:
        """For each instance whether its box may be in the picture, (N,) bool."""
        corners = (self.scene.corners - self.camera.eye) / self.unit
        clip = np.concatenate([corners, np.ones((*corners.shape[:2], 1))], axis=2) @ self.view_projection.T
        w = clip[..., 3:]
        return ~((clip[..., :3] < -w).all(axis=1).any(axis=1) | (clip[..., :3] > w).all(axis=1).any(axis=1))

    @cached_property
    def ray(self) -> np.ndarray:
        """(x, y, 1) in normalised device coordinates to a world direction, not normalised, (3, 3) float64."""
        if self.camera.height is not None:
            basis = np.stack([np.zeros(3), np.zeros(3), self.camera.forward], axis=1)
        else:
            tan_y = np.tan(self.camera.fov_y / 2)
            right, up = self.camera.pose[:3, 0], self.camera.pose[:3, 1]
            basis = np.stack([right * tan_y * self.aspect, up * tan_y, self.camera.forward], axis=1)
        return basis

    @property
    def pixel_angle(self) -> float:
        """Of the middle pixel, in radians (0 for an orthographic camera)."""
        return 0.0 if self.camera.height is not None else 2 * np.tan(self.camera.fov_y / 2) / self.size[1]
