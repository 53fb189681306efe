"""The matrices and positions of one frame, in eye-relative space.

Eye-relative space has the axes of the world, the eye at the origin and the scene's bounding radius as its unit. All
positions in shaders are in this space. They are computed in float64 and rounded last. So a scene of a micron and one of
a thousand kilometres, at the origin or a million units away, give the same float32 numbers and the same picture.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
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
    is_depth_reversed: bool = False
    """Whether clip space goes from z = w at the near plane to 0 at the far one, not from -w to w."""
    view_size: tuple[int, int] | None = None
    """The size whose aspect the view has, where pixels are not quite square; None: `size`."""

    def within(self, pixels: int) -> Frame:
        """The same view in at most about so many pixels."""
        scale = math.sqrt(pixels / (self.size[0] * self.size[1]))
        if scale >= 1:
            return self
        width, height = (max(round(side * scale), 1) for side in self.size)
        return replace(self, size=(width, height), view_size=self.view_size or self.size)

    @property
    def unit(self) -> float:
        """The length of one eye-relative unit in world units."""
        return self.scene.radius

    @property
    def aspect(self) -> float:
        width, height = self.view_size or self.size
        return width / height

    @cached_property
    def _to_eye(self) -> np.ndarray:
        """World to eye-relative space, (4, 4)."""
        matrix = np.eye(4) / self.unit
        matrix[:3, 3] = -self.camera.eye / self.unit
        matrix[3, 3] = 1.0
        return matrix

    @property
    def pixels_across(self) -> float:
        """How many pixels a sphere as large as the scene takes at its centre; infinite where the eye is in it."""
        height = self.camera.height
        if height is not None:
            return 2 * self.scene.radius / height * self.size[1]
        distance = float(np.linalg.norm(self.camera.eye - self.scene.center))
        if distance <= self.scene.radius:
            return math.inf
        return self.scene.radius / (distance * math.tan(self.camera.fov_y / 2)) * self.size[1]

    def model(self, transform: np.ndarray) -> np.ndarray:
        """Mesh (world = transform @ local) to eye-relative space, (4, 4) float64."""
        return self._to_eye @ transform

    def scale(self, transform: np.ndarray) -> float:
        """The mean scale of `transform` in eye-relative space: the cube root of the factor by which volumes change."""
        return float(np.cbrt(abs(np.linalg.det(transform[:3, :3] / self.unit))))

    def position(self, point: ArrayLike) -> np.ndarray:
        """A world position, eye-relative, (3,) float64."""
        return (np.asarray(point, np.float64) - self.camera.eye) / self.unit

    @cached_property
    def view_projection(self) -> np.ndarray:
        """Eye-relative space to clip space, (4, 4) float64. Near and far planes enclose the scene."""
        near, far = self.depth_range
        rotation = np.eye(4)
        rotation[:3, :3] = self.camera.pose[:3, :3].T
        projection = self._camera.projection(self.aspect, near, far)
        if self.is_depth_reversed:
            projection[2] = (projection[3] - projection[2]) / 2
        return projection @ rotation

    @cached_property
    def depth_range(self) -> tuple[float, float]:
        """Near and far planes in eye-relative units, as close to the boxes of all that is drawn as possible."""
        corners = np.concatenate([self.scene.corners.reshape(-1, 3), self.scene.volume_corners,
                                  self.scene.curve_corners])
        depths = (corners - self.camera.eye) @ self.camera.forward / self.unit
        if not len(depths):
            return 0.01, 1.0
        low, high = float(depths.min()), float(depths.max())
        margin = 1e-3 * (high - low) + 1e-6 * max(abs(low), abs(high)) + self._beyond_boxes
        low, high = low - margin, high + margin
        if self.camera.height is not None:
            return low, high
        high = max(high, 1e-3)
        if self.is_depth_reversed:  # a small near costs no precision: metres are seen beside what is 1e11 m away
            return max(low, high * 1e-12), high
        # 24 bits of depth distinguish surfaces z^2 / (near 2^24) apart. At a ratio of 1e5 that is 0.6 % of the distance
        # at the far plane.
        near = self.camera.near
        low = max(low, high * 1e-5 if near is None else min(near / self.unit, high / 2))
        # Near the far plane z / w comes close to 1. The margin keeps float32 from rounding it above 1.
        return low, high * (1 + 2.0**-21 * high / low)

    @property
    def _beyond_boxes(self) -> float:
        """How far strips of curves come nearer than the boxes about them, in eye-relative units: at the end of a strand
        they go on by its radius at a right angle to the bulge of as much (shaders/raster/curve.vert)."""
        return 0.42 * max((curves.widest for curves in self.scene.curves), default=0.0) / self.unit

    @cached_property
    def visible(self) -> np.ndarray:
        """Whether the bounding box of each instance may be in the picture, (N,) bool (frustum culling)."""
        corners = (self.scene.corners - self.camera.eye) / self.unit
        clip = np.concatenate([corners, np.ones((*corners.shape[:2], 1))], axis=2) @ self.view_projection.T
        w = clip[..., 3:]
        low = -w * (1, 1, not self.is_depth_reversed)
        return ~((clip[..., :3] < low).all(axis=1).any(axis=1) | (clip[..., :3] > w).all(axis=1).any(axis=1))

    @property
    def to_ndc(self) -> np.ndarray:
        """The (3, 3) float64 matrix from (x, y, 1), in pixels from the lower left corner, to normalised device
        coordinates."""
        width, height = self.size
        return np.array([[2 / width, 0, -1], [0, 2 / height, -1], [0, 0, 1]])

    @cached_property
    def ray(self) -> np.ndarray:
        """The (3, 3) float64 matrix from (x, y, 1), normalised device coordinates, to the world direction of the ray
        through that point, which is not normalised."""
        if self.camera.height is not None:
            return np.stack([np.zeros(3), np.zeros(3), self.camera.forward], axis=1)
        return self._plane(self.camera.forward)

    @cached_property
    def ray_origin(self) -> np.ndarray:
        """The (3, 3) float64 matrix from (x, y, 1), as for `ray`, to the eye-relative point where that ray starts."""
        if self.camera.height is None:
            return np.zeros((3, 3))
        return self._plane(np.zeros(3))

    @cached_property
    def _camera(self) -> Camera:
        """The camera, with lengths in eye-relative units."""
        height = self.camera.height
        return self.camera if height is None else replace(self.camera, height=height / self.unit)

    def _plane(self, axis: np.ndarray) -> np.ndarray:
        """The (3, 3) matrix from (x, y, 1) to where `Camera.window` is seen, about the point `axis`."""
        half, middle = self._camera.window(self.aspect)
        right, up = self.camera.pose[:3, 0], self.camera.pose[:3, 1]
        return np.stack([right * half[0], up * half[1], axis + right * middle[0] + up * middle[1]], axis=1)

    def shows_as(self, other: Frame) -> bool:
        """Whether both show what stands still at the same pixels."""
        here, there = ((c.fov_y, c.height, c.principal, c.pixel_aspect, *c.pose.ravel())
                       for c in (self.camera, other.camera))
        return self.size == other.size and here == there

    @property
    def pixel_angle(self) -> float:
        """The angle that the central pixel subtends, in radians (0 for an orthographic camera)."""
        return 0.0 if self.camera.height is not None else 2 * np.tan(self.camera.fov_y / 2) / self.size[1]
