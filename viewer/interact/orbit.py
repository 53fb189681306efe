"""The orbit camera: orbit, pan and dolly about a target. It does not depend on a window."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import ArrayLike

from ..scene.camera import DEFAULT_AZIMUTH, DEFAULT_ELEVATION, DEFAULT_FOV, Camera, framing_distance
from ..scene.framing import fit
from ..scene.scene import Scene

QUARTER = math.pi / 2
NEAREST, FARTHEST = 1e-4, 50.0
"""Bounds of the distance to the target, in units of the distance that frames the scene."""
COAST_SECONDS = 0.35
"""The time in which the speed of inertia falls to 1/e."""
COAST_END = 0.02
"""The speed, in window heights per second, at which it stops."""


class OrbitController:
    """A camera on a sphere about `target`; angles in radians, distances in world units.

    `roll` is the camera's rotation about its view direction; only cameras from a file have one. An orthographic view
    shows as much as the perspective one at the target's depth. Mouse movements are in window heights, x to the right
    and y downwards, so they do not depend on the size of the window or the scene.
    """

    def __init__(self, scene: Scene, aspect: float, fov_y: float = DEFAULT_FOV) -> None:
        self.fov_y = fov_y
        self.is_orthographic = False
        self._lens = Camera(np.eye(4))
        """The camera that was followed, whose principal point and pixels stay until the scene is framed."""
        self.velocity = np.zeros(2)
        """The velocity of inertia, in window heights per second, (2,)."""
        self.azimuth, self.elevation = DEFAULT_AZIMUTH, DEFAULT_ELEVATION
        self.set_scene(scene)
        self.frame_all(aspect)

    def set_scene(self, scene: Scene) -> None:
        """Set what `frame_all` frames and what limits the camera's distance. The camera does not move."""
        self._scene = scene
        self.center, self.radius = scene.center, scene.radius

    def frame_all(self, aspect: float) -> None:
        """Fill the view with the scene, from the current direction. The target is as deep as the scene's centre."""
        self.roll, self._lens = 0.0, Camera(np.eye(4))
        self.target, self.distance = fit(
            self._scene, self._rotation(0.0), aspect, self.fov_y, is_orthographic=self.is_orthographic)
        self.velocity = np.zeros(2)

    def look_from(self, azimuth: float, elevation: float) -> None:
        """Look at the same target from the same distance and a given direction, without roll."""
        self.azimuth, self.elevation, self.roll = azimuth, elevation, 0.0
        self.velocity = np.zeros(2)

    def follow(self, camera: Camera, depth: float) -> None:
        """Take over the pose and projection of `camera`. The target is `depth` in front of it."""
        rotation = camera.pose[:3, :3]
        back, up = rotation[:, 2], rotation[:, 1]
        self.elevation = math.atan2(back[1], math.hypot(back[0], back[2]))
        if math.hypot(back[0], back[2]) > 1e-6:
            self.azimuth = math.atan2(back[0], back[2])
        else:  # straight up or down, the camera's "up" determines the azimuth
            sign = -math.copysign(1.0, back[1])
            self.azimuth = math.atan2(sign * up[0], sign * up[2])
        reference = self._rotation(0.0)
        self.roll = math.atan2(rotation[:, 0] @ reference[:, 1], rotation[:, 0] @ reference[:, 0])
        if abs(self.roll) < 1e-9:
            self.roll = 0.0
        self.fov_y, self.is_orthographic, self._lens = camera.fov_y, camera.height is not None, camera
        self.target = camera.eye - depth * back
        self.distance = depth if camera.height is None else camera.height / (2 * math.tan(self.fov_y / 2))
        self.velocity = np.zeros(2)

    @property
    def camera(self) -> Camera:
        """The current camera."""
        pose = np.eye(4)
        pose[:3, :3] = self._rotation(self.roll)
        pose[:3, 3] = self.target + self.distance * pose[:3, 2]
        height = 2 * self.distance * math.tan(self.fov_y / 2) if self.is_orthographic else None
        return Camera(pose, self.fov_y, height, principal=self._lens.principal, pixel_aspect=self._lens.pixel_aspect)

    def orbit(self, dx: float, dy: float) -> None:
        """Rotate by half a turn per window height, so that the scene follows the mouse. The elevation stops at the
        poles."""
        self.azimuth = math.remainder(self.azimuth - math.pi * dx, 2 * math.pi)
        self.elevation = min(max(self.elevation + math.pi * dy, -QUARTER), QUARTER)

    def pan(self, dx: float, dy: float, depth: float | None = None) -> None:
        """Move parallel to the screen. A point at `depth` (by default the target's) stays under the cursor."""
        if depth is None or self.is_orthographic:
            depth = self.distance
        rotation = self._rotation(self.roll)
        height = 2 * depth * math.tan(self.fov_y / 2)
        self._set_target(self.target + height * (-dx * rotation[:, 0] + dy * rotation[:, 1]))

    def dolly(self, factor: float, point: ArrayLike | None = None) -> None:
        """Multiply the distance to `point` (by default the target) by `factor`. The point stays where it is in the
        picture."""
        nearest, farthest = self._limits()
        distance = min(max(self.distance * factor, min(nearest, self.distance)), max(farthest, self.distance))
        if point is not None:
            point = np.asarray(point, np.float64)
            self._set_target(point + (self.target - point) * (distance / self.distance))
        self.distance = distance

    def center_on(self, point: ArrayLike) -> None:
        """Look at `point` from the same direction, without changing its depth."""
        point = np.asarray(point, np.float64)
        if not self.is_orthographic:
            back = self._rotation(0.0)[:, 2]
            depth = float((self.target + self.distance * back - point) @ back)
            self.distance = min(max(depth, self._limits()[0]), self._limits()[1])
        self._set_target(point)
        self.velocity = np.zeros(2)

    def coast(self, seconds: float) -> bool:
        """Move the orbit by inertia for `seconds`. Returns whether it has moved."""
        if math.hypot(*self.velocity) < COAST_END:
            self.velocity = np.zeros(2)
            return False
        self.orbit(*(self.velocity * seconds))
        self.velocity = self.velocity * math.exp(-seconds / COAST_SECONDS)
        return True

    def _limits(self) -> tuple[float, float]:
        framing = framing_distance(self.radius, 1.0, self.fov_y)
        return NEAREST * framing, FARTHEST * framing

    def _set_target(self, target: np.ndarray) -> None:
        """Set the target, at most as far from the scene as the camera may be, so that the scene is not lost."""
        offset = target - self.center
        length, limit = float(np.linalg.norm(offset)), self._limits()[1]
        self.target = self.center + offset * min(1.0, limit / length) if length > 0 else target

    def _rotation(self, roll: float) -> np.ndarray:
        """Right, up and back as columns, (3, 3). It follows from the angles without an "up" vector, so it is also valid
        at the poles."""
        sa, ca = math.sin(self.azimuth), math.cos(self.azimuth)
        se, ce = math.sin(self.elevation), math.cos(self.elevation)
        right, up = np.array([ca, 0.0, -sa]), np.array([-se * sa, ce, -se * ca])
        c, s = math.cos(roll), math.sin(roll)
        return np.stack([c * right + s * up, c * up - s * right, [ce * sa, se, ce * ca]], axis=1)
