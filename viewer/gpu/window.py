"""Contexts of a desktop window (X11, Wayland, macOS, Windows), opened through GLFW."""

from __future__ import annotations

import glfw

from .context import Context
from .glfw_window import GLFWLoader, create_window


class WindowContext(Context):
    """A context with a window, which may be hidden. `window` is GLFW's handle, for events and for swapping buffers.

    `size` is in screen coordinates; the framebuffer may have more pixels (`glfw.get_framebuffer_size`).
    """

    backend = "window"

    def __init__(self, size: tuple[int, int] = (64, 64), title: str = "pbr-viewer", visible: bool = False) -> None:
        super().__init__(lambda: self._create(size, title, visible))

    def _create(self, size: tuple[int, int], title: str, visible: bool) -> GLFWLoader:
        self.window = create_window(
            self.backend,
            null_platform=False,
            # macOS has core contexts only with the forward-compatible flag.
            hints={glfw.VISIBLE: int(visible), glfw.OPENGL_FORWARD_COMPAT: glfw.TRUE},
            versions=((4, 1), (3, 3)),  # 4.1 is the newest of macOS; elsewhere drivers return their newest for either
            size=size,
            title=title,
        )
        return GLFWLoader(self.window)
