"""Input events of GLFW, passed on to the panel, the split line or the camera."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import glfw

from ..interact.keys import action_of
from ..interact.orbit import OrbitController
from ..interact.pointer import Pointer
from ..interact.state import ViewState
from .gui import NOWHERE, Gui

_NAMES = {
    getattr(glfw, f"KEY_{name}"): name
    for name in ("ESCAPE", "TAB", "HOME", "SPACE", "COMMA", "PERIOD", "PAGE_DOWN", "PAGE_UP",
                 *(f"F{k}" for k in range(1, 13)), *(f"KP_{k}" for k in range(10)), *"0123456789",
                 *"ABCDEFGHIJKLMNOPQRSTUVWXYZ")
}


class Input:
    """Turns the events of one window into changes of `state` and `orbit`, and calls `do(action)` for keys and
    `drop(paths)` for dropped files. The picture has `picture_size()` of the window's coordinates, at its upper left.

    Every event sets `changed`, which means that the window must be drawn again.
    """

    def __init__(self, window: Any, state: ViewState, orbit: OrbitController, gui: Gui,
                 picture_size: Callable[[], tuple[int, int]], do: Callable[[str], None],
                 drop: Callable[[list[str]], None]) -> None:
        self._window, self._gui, self._do = window, gui, do
        self._pointer = Pointer(state, orbit, picture_size, lambda: gui.scale)
        self.changed = True
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
        if not entered and not self._pointer.is_dragging:
            self._gui.on_move(*NOWHERE)

    def _on_button(self, _window: Any, button: int, action: int, modifiers: int) -> None:
        self.changed = True
        self._gui.io.add_mouse_button_event(button, action == glfw.PRESS)
        gesture = button == glfw.MOUSE_BUTTON_LEFT, bool(modifiers & glfw.MOD_SHIFT)
        if action == glfw.PRESS and not self._gui.wants_mouse and not self._pointer.is_dragging:
            self._pointer.press(*gesture)
        elif action == glfw.RELEASE and self._pointer.is_dragging:
            self._pointer.release(*gesture)

    def _on_move(self, _window: Any, x: float, y: float) -> None:
        self.changed = True
        self._gui.on_move(x, y)
        self._pointer.move(x, y)
        is_free = self._pointer.is_dragging or not self._gui.wants_mouse
        glfw.set_cursor(self._window, self._split_cursor if is_free and self._pointer.is_on_split else None)

    def _on_scroll(self, _window: Any, dx: float, dy: float) -> None:
        self.changed = True
        self._gui.io.add_mouse_wheel_event(dx, dy)
        if not self._gui.wants_mouse:
            self._pointer.scroll(dx, dy, self._held(glfw.KEY_LEFT_SHIFT, glfw.KEY_RIGHT_SHIFT),
                                 self._held(glfw.KEY_LEFT_CONTROL, glfw.KEY_RIGHT_CONTROL))

    def _held(self, *keys: int) -> bool:
        return any(glfw.get_key(self._window, key) == glfw.PRESS for key in keys)


def _key_name(key: int, scancode: int) -> str:
    """The letter that the key has in the user's keyboard layout, or else its name in the US layout."""
    name = glfw.get_key_name(key, scancode) if glfw.KEY_A <= key <= glfw.KEY_Z else None
    return name.upper() if name and len(name) == 1 and name.isascii() and name.isalpha() else _NAMES.get(key, "")
