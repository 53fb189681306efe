"""What a mouse does to a view, without a toolkit: it orbits, pans, moves closer, drags the line of a split."""

from __future__ import annotations

import math
import time
from collections import deque
from collections.abc import Callable

import numpy as np

from ..scene.camera import Camera
from .orbit import OrbitController
from .pick import cursor_ray, pick, plane_point
from .state import ViewState

CLICK_DISTANCE = 4.0
"""In the coordinates of the picture: a press that moves no farther than this is a click, not a drag."""
DOUBLE_CLICK_SECONDS = 0.35
GRAB_DISTANCE = 6.0
THROW_SECONDS = 0.1
"""Inertia takes the mouse's mean velocity over this time before the button was released."""
WHEEL_STEP = 0.88
"""One notch of the wheel multiplies the distance by this; a trackpad sends fractions of a notch."""
SCROLL_HEIGHTS = 0.03
"""One notch of the wheel pans or orbits by so many heights of the picture."""


class Pointer:
    """One mouse over a picture of `size()`, in coordinates with y downwards; it changes `state` and `orbit`.

    `scale()` is how many of these coordinates are one on a screen of usual density.
    """

    def __init__(self, state: ViewState, orbit: OrbitController, size: Callable[[], tuple[int, int]],
                 scale: Callable[[], float]) -> None:
        self._state, self._orbit, self._scale = state, orbit, scale
        self._picture_size = size
        self._drag: str | None = None
        self._cursor = np.zeros(2)
        self._pressed_at = np.zeros(2)
        self._clicked_at = -math.inf
        self._trail: deque[tuple[float, np.ndarray]] = deque(maxlen=64)
        self._grabbed: tuple[object, np.ndarray] | None = None

    @property
    def is_dragging(self) -> bool:
        return self._drag is not None

    @property
    def is_on_split(self) -> bool:
        """Whether it drags the line of the split, or would do so if it were pressed."""
        return self._drag == "split" or (self._drag is None and self._is_near_split())

    def press(self, is_left: bool, shift: bool) -> None:
        self._orbit.velocity = np.zeros(2)
        self._pressed_at = self._cursor
        if is_left and self._is_near_split():
            self._drag = "split"
        else:
            self._drag = "orbit" if is_left and not shift else "pan"
        if self._drag == "pan":
            self._grab()

    def release(self, is_left: bool, shift: bool) -> None:
        drag, self._drag = self._drag, None
        now = time.monotonic()
        if drag == "orbit" and self._state.inertia:
            earlier = [cursor for moment, cursor in self._trail if now - moment < THROW_SECONDS]
            if earlier:
                self._orbit.velocity = (self._cursor - earlier[0]) / self._size()[1] / THROW_SECONDS
        is_click = _length(self._cursor - self._pressed_at) <= CLICK_DISTANCE
        if drag == "split" or not is_left or not is_click:
            return
        is_double = now - self._clicked_at < DOUBLE_CLICK_SECONDS
        self._clicked_at = -math.inf if is_double else now
        if shift or is_double:
            self._center()

    def move(self, x: float, y: float) -> None:
        cursor = np.array([x, y])
        width, height = self._size()
        delta = (cursor - self._cursor) / height
        self._cursor = cursor
        self._trail.append((time.monotonic(), cursor))
        if self._drag == "split":
            self._state.split = min(max(x / width, 0.0), 1.0)
        elif self._drag == "orbit":
            self._orbit.orbit(float(delta[0]), float(delta[1]))
        elif self._drag == "pan":
            assert self._grabbed is not None
            depth = (self._grabbed[1] - self._orbit.camera.eye) @ self._orbit.camera.forward
            self._orbit.pan(float(delta[0]), float(delta[1]), depth)

    def scroll(self, dx: float, dy: float, shift: bool, control: bool) -> None:
        """Turn the wheel by notches, or fractions of them; dy > 0 is away from the user."""
        self._orbit.velocity = np.zeros(2)
        if shift:
            self._orbit.pan(dx * SCROLL_HEIGHTS, dy * SCROLL_HEIGHTS)
        elif control:
            self._orbit.orbit(dx * SCROLL_HEIGHTS, dy * SCROLL_HEIGHTS)
        else:
            self._grab()
            assert self._grabbed is not None
            self._orbit.dolly(WHEEL_STEP**dy, self._grabbed[1])

    def _grab(self) -> None:
        """Find the point under the cursor. If the last one is still under it, as after a dolly, it is kept."""
        camera, scene = self._orbit.camera, self._state.scene
        if self._grabbed is not None and self._grabbed[0] is scene.instances:
            origin, direction = cursor_ray(camera, self._size(), (self._cursor[0], self._cursor[1]))
            offset = self._grabbed[1] - origin
            if _length(np.cross(direction, offset)) <= 1e-6 * _length(offset):
                return
        point = self._pick(camera)
        if point is None:
            cursor = self._cursor[0], self._cursor[1]
            point = plane_point(camera, self._size(), cursor, self._orbit.distance)
        self._grabbed = (scene.instances, point)

    def _center(self) -> None:
        point = self._pick(self._orbit.camera)
        if point is not None:
            self._orbit.center_on(point)

    def _pick(self, camera: Camera) -> np.ndarray | None:
        return pick(self._state.scene, camera, self._size(), (self._cursor[0], self._cursor[1]))

    def _is_near_split(self) -> bool:
        position = self._state.split
        if position is None:
            return False
        return bool(abs(self._cursor[0] - position * self._size()[0]) <= GRAB_DISTANCE * self._scale())

    def _size(self) -> tuple[int, int]:
        width, height = self._picture_size()
        return max(width, 1), max(height, 1)


def _length(vector: np.ndarray) -> float:
    return float(np.linalg.norm(vector))
