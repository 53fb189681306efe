"""A real window on a virtual display, driven by real mouse and key events."""

from __future__ import annotations

import subprocess
from collections.abc import Callable, Iterator

import numpy as np
import pytest
from needs import require
from waiting import PATIENCE_S, wait_until

from viewer.base.resources import resource_folder
from viewer.settings import Settings

SIZE = (320, 240)
PLAIN = Settings(antialias="none", background=(0.2, 0.2, 0.2))
"""Quick to draw, and the same picture while the camera moves as when it rests."""


class Driver:
    """The hands at mouse and keyboard, and the eyes on the window."""

    def __init__(self, window) -> None:
        import glfw

        self.window = window
        self._id = str(glfw.get_x11_window(window.window))
        glfw.set_window_pos(window.window, 0, 0)
        self.xdotool("windowfocus", "--sync", self._id)
        self.settle()

    def xdotool(self, *arguments: object) -> None:
        """Do something with mouse and keyboard, then let the window answer."""
        subprocess.run(["xdotool", *map(str, arguments)], check=True, timeout=PATIENCE_S)
        self.settle()

    def key(self, *keys: str) -> None:
        self.xdotool("key", *keys)

    def move(self, x: int, y: int) -> None:
        self.xdotool("mousemove", "--window", self._id, x, y)

    def click(self, x: int, y: int, *options: object, button: int = 1) -> None:
        self.move(x, y)
        self.xdotool("click", *options, button)

    def drag(self, start: tuple[int, int], end: tuple[int, int], button: int = 1) -> None:
        self.move(*start)
        self.xdotool("mousedown", button)
        self.move((start[0] + end[0]) // 2, (start[1] + end[1]) // 2)
        self.move(*end)
        self.xdotool("mouseup", button)

    def settle(self) -> None:
        """Run the window until it waits for something to happen."""
        quiet = 0

        def step() -> None:
            nonlocal quiet
            self.window.step(timeout=0.02)
            quiet = quiet + 1 if not self.window.needs_redraw and self.window.picture.is_refined else 0

        wait_until(lambda: quiet == 2, step, what="rest of the window")

    def until(self, condition: Callable[[], object]) -> None:
        wait_until(condition, lambda: self.window.step(timeout=0.05))
        self.settle()

    def screen(self) -> np.ndarray:
        """What the window shows, panel and all, (H, W, 3) uint8."""
        taken = []

        def take(_window) -> None:  # after the swap nothing is defined
            screen = self.window.context.gl.screen
            width, height = screen.viewport[2:]
            pixels = np.frombuffer(screen.read(viewport=screen.viewport, components=3, alignment=1), np.uint8)
            taken.append(pixels.reshape(height, width, 3)[::-1])

        with pytest.MonkeyPatch.context() as patch:
            patch.setattr("glfw.swap_buffers", take)
            self.window._draw()
        return taken[0]


@pytest.fixture
def open_window(display) -> Iterator[Callable[..., Driver]]:
    """`open_window(scene, settings, **keywords)` gives a Driver of a window that is closed after the test."""
    require("xvfb", "xdotool")
    from viewer.app.window import ViewerWindow

    windows = []

    def make(scene, settings=PLAIN, size=SIZE, **keywords) -> Driver:
        windows.append(ViewerWindow(scene, settings, size=size, **keywords))
        return Driver(windows[-1])

    yield make
    for window in windows:
        window.__exit__(None, None, None)


@pytest.fixture(scope="session")
def scene():
    """A small model with textures, in the studio."""
    import viewer

    return viewer.load(resource_folder("assets") / "scenes" / "spheres.glb")
