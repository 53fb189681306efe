"""Input events of GLFW, passed on to the panel, the split line or the camera."""

from __future__ import annotations

import math
import time
from collections import deque
from collections.abc import Callable
from typing import Any

import glfw
import numpy as np

from ..interact.keys import action_of
from ..interact.orbit import OrbitController
from ..interact.pick import cursor_ray, pick, plane_point
from ..interact.state import ViewState
from ..scene.camera import Camera
from .gui import Gui

CLICK_DISTANCE = 4.0
"""In window coordinates: a press that moves no farther than this is a click, not a drag."""
DOUBLE_CLICK_SECONDS = 0.35
GRAB_DISTANCE = 6.0
THROW_SECONDS = 0.1
"""Inertia takes the mouse's mean velocity over this time before the button was released."""
WHEEL_STEP = 0.88
"""One notch of the wheel multiplies the distance by this; a trackpad sends fractions of a notch."""
SCROLL_HEIGHTS = 0.03
"""One notch of the wheel pans or orbits by so many window heights."""
_NAMES = {
    getattr(glfw, f"KEY_{name}"): name
    for name in ("ESCAPE", "TAB", "HOME", "SPACE", "COMMA", "PERIOD", *(f"F{k}" for k in range(1, 13)),
                 *(f"KP_{k}" for k in range(10)), *"0123456789", *"ABCDEFGHIJKLMNOPQRSTUVWXYZ")
}


class Input:
    """Turns the events of one window into changes of `state` and `orbit`, and calls `do(action)` for keys and
    `drop(paths)` for dropped files. The picture has `picture_size()` of the window's coordinates, at its upper left.

    Every event sets `changed`, which means that the window must be drawn again.
    """

    def __init__(self, window: Any, state: ViewState, orbit: OrbitController, gui: Gui,
                 picture_size: Callable[[], tuple[int, int]], do: Callable[[str], None],
                 drop: Callable[[list[str]], None]) -> None:
        self._window, self._state, self._orbit, self._gui, self._do = window, state, orbit, gui, do
        self._picture_size = picture_size
        self.changed = True
        self._drag: str | None = None
        self._cursor = np.zeros(2)
        self._pressed_at = np.zeros(2)
        self._clicked_at = -math.inf
        self._trail: deque[tuple[float, np.ndarray]] = deque(maxlen=64)
        self._grabbed: tuple[object, np.ndarray] | None = None
        self._split_cursor = glfw.create_standard_cursor(glfw.HRESIZE_CURSOR)
        glfw.set_key_callback(window, self._on_key)
        glfw.set_char_callback(window, self._on_character)
        glfw.set_cursor_pos_callback(window, self._on_move)
        glfw.set_mouse_button_callback(window, self._on_button)
        glfw.set_scroll_callback(window, self._on_scroll)
        glfw.set_drop_callback(window, lambda _, paths: drop(paths))
        glfw.set_cursor_enter_callback(window, self._on_enter)
        for set_callback in (glfw.set_framebuffer_size_callback, glfw.set_window_refresh_callback,
                             glfw.set_window_focus_callback, glfw.set_window_content_scale_callback):
            set_callback(window, self._on_anything)

    def _on_anything(self, *_) -> None:
        self.changed = True

    def _on_key(self, _window: Any, key: int, scancode: int, action: int, modifiers: int) -> None:
        self.changed = True
        self._gui.on_key(key, action, modifiers)
        if action != glfw.PRESS or self._gui.wants_keyboard:
            return
        command = action_of(_key_name(key, scancode), bool(modifiers & glfw.MOD_SHIFT),
                            bool(modifiers & (glfw.MOD_CONTROL | glfw.MOD_SUPER)))
        if command is not None:
            self._do(command)

    def _on_character(self, _window: Any, codepoint: int) -> None:
        self.changed = True
        self._gui.on_character(codepoint)

    def _on_enter(self, _window: Any, entered: int) -> None:
        self.changed = True
        if not entered and self._drag is None:
            self._gui.io.add_mouse_pos_event(-1e9, -1e9)

    def _on_button(self, _window: Any, button: int, action: int, modifiers: int) -> None:
        self.changed = True
        self._gui.io.add_mouse_button_event(button, action == glfw.PRESS)
        if action == glfw.PRESS and not self._gui.wants_mouse and self._drag is None:
            self._press(button, bool(modifiers & glfw.MOD_SHIFT))
        elif action == glfw.RELEASE and self._drag is not None:
            self._release(button, bool(modifiers & glfw.MOD_SHIFT))

    def _press(self, button: int, shift: bool) -> None:
        self._orbit.velocity = np.zeros(2)
        self._pressed_at = self._cursor
        if button == glfw.MOUSE_BUTTON_LEFT and self._on_split(self._cursor):
            self._drag = "split"
        else:
            self._drag = "orbit" if button == glfw.MOUSE_BUTTON_LEFT and not shift else "pan"
        if self._drag == "pan":
            self._grab()

    def _release(self, button: int, shift: bool) -> None:
        drag, self._drag = self._drag, None
        now = time.monotonic()
        if drag == "orbit" and self._state.inertia:
            earlier = [cursor for moment, cursor in self._trail if now - moment < THROW_SECONDS]
            if earlier:
                self._orbit.velocity = (self._cursor - earlier[0]) / self._size()[1] / THROW_SECONDS
        is_click = _length(self._cursor - self._pressed_at) <= CLICK_DISTANCE
        if drag == "split" or button != glfw.MOUSE_BUTTON_LEFT or not is_click:
            return
        is_double = now - self._clicked_at < DOUBLE_CLICK_SECONDS
        self._clicked_at = -math.inf if is_double else now
        if shift or is_double:
            self._center()

    def _on_move(self, _window: Any, x: float, y: float) -> None:
        self.changed = True
        self._gui.io.add_mouse_pos_event(x, y)
        cursor = np.array([x, y])
        width, height = self._size()
        delta = (cursor - self._cursor) / height
        self._cursor = cursor
        self._trail.append((time.monotonic(), cursor))
        if self._drag == "split":
            self._state.split = min(max(x / width, 0.0), 1.0)
        elif self._drag == "orbit":
            self._orbit.orbit(*delta)
        elif self._drag == "pan":
            depth = (self._grabbed[1] - self._orbit.camera.eye) @ self._orbit.camera.forward
            self._orbit.pan(*delta, depth)
        is_free = self._drag is None and not self._gui.wants_mouse
        over_split = self._drag == "split" or (is_free and self._on_split(cursor))
        glfw.set_cursor(self._window, self._split_cursor if over_split else None)

    def _on_scroll(self, _window: Any, dx: float, dy: float) -> None:
        self.changed = True
        self._gui.io.add_mouse_wheel_event(dx, dy)
        if self._gui.wants_mouse:
            return
        self._orbit.velocity = np.zeros(2)
        if self._held(glfw.KEY_LEFT_SHIFT, glfw.KEY_RIGHT_SHIFT):
            self._orbit.pan(dx * SCROLL_HEIGHTS, dy * SCROLL_HEIGHTS)
        elif self._held(glfw.KEY_LEFT_CONTROL, glfw.KEY_RIGHT_CONTROL):
            self._orbit.orbit(dx * SCROLL_HEIGHTS, dy * SCROLL_HEIGHTS)
        else:
            self._grab()
            self._orbit.dolly(WHEEL_STEP**dy, self._grabbed[1])

    def _grab(self) -> None:
        """Find the point under the cursor. If the last one is still under it, as after a dolly, it is kept."""
        camera, scene = self._orbit.camera, self._state.scene
        if self._grabbed is not None and self._grabbed[0] is scene.instances:
            origin, direction = cursor_ray(camera, self._size(), tuple(self._cursor))
            offset = self._grabbed[1] - origin
            if _length(np.cross(direction, offset)) <= 1e-6 * _length(offset):
                return
        point = self._pick(camera)
        if point is None:
            point = plane_point(camera, self._size(), tuple(self._cursor), self._orbit.distance)
        self._grabbed = (scene.instances, point)

    def _center(self) -> None:
        point = self._pick(self._orbit.camera)
        if point is not None:
            self._orbit.center_on(point)

    def _pick(self, camera: Camera) -> np.ndarray | None:
        return pick(self._state.scene, camera, self._size(), tuple(self._cursor))

    def _on_split(self, cursor: np.ndarray) -> bool:
        position = self._state.split
        return position is not None and abs(cursor[0] - position * self._size()[0]) <= GRAB_DISTANCE * self._gui.scale

    def _size(self) -> tuple[int, int]:
        width, height = self._picture_size()
        return max(width, 1), max(height, 1)

    def _held(self, *keys: int) -> bool:
        return any(glfw.get_key(self._window, key) == glfw.PRESS for key in keys)


def _key_name(key: int, scancode: int) -> str:
    """The letter that the key has in the user's keyboard layout, or else its name in the US layout."""
    name = glfw.get_key_name(key, scancode) if glfw.KEY_A <= key <= glfw.KEY_Z else None
    return name.upper() if name and len(name) == 1 and name.isascii() and name.isalpha() else _NAMES.get(key, "")


def _length(vector: np.ndarray) -> float:
    return float(np.linalg.norm(vector))
