"""Shows a window on all of a screen, and in its own place again."""

from __future__ import annotations

from typing import Any

import glfw


class FullScreen:
    def __init__(self, window: Any) -> None:
        self._window = window
        self._before: tuple[int, int, int, int] | None = None
        glfw.set_window_attrib(window, glfw.AUTO_ICONIFY, glfw.FALSE)  # stay where another screen gets the focus

    @property
    def is_on(self) -> bool:
        return self._before is not None

    def toggle(self) -> None:
        """Take the screen that most of the window is on, or go back to the place and size before."""
        window = self._window
        if self._before is not None:
            glfw.set_window_monitor(window, None, *self._before, glfw.DONT_CARE)  # type: ignore[arg-type]
            self._before = None
            return
        self._before = (*glfw.get_window_pos(window), *glfw.get_window_size(window))
        monitor = max(glfw.get_monitors(), key=self._shared, default=None)
        if monitor is None:
            self._before = None
            return
        mode = glfw.get_video_mode(monitor)
        glfw.set_window_monitor(window, monitor, 0, 0, mode.size.width, mode.size.height, mode.refresh_rate)

    def _shared(self, monitor: Any) -> int:
        """How many of its units of area the window covers."""
        assert self._before is not None
        mode, (x, y) = glfw.get_video_mode(monitor), glfw.get_monitor_pos(monitor)
        left, top, width, height = self._before
        across = min(left + width, x + mode.size.width) - max(left, x)
        down = min(top + height, y + mode.size.height) - max(top, y)
        return max(across, 0) * max(down, 0)
