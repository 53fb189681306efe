"""GLFW's state, which exists once per process: its platform, and the windows that are open on it."""

from __future__ import annotations

import ctypes
from typing import Any

import glfw

from ..errors import ContextError

_windows: set[int] = set()
_null_platform: bool | None = None


def create_window(
    backend: str,
    *,
    null_platform: bool,
    hints: dict[int, int],
    versions: tuple[tuple[int, int], ...],
    size: tuple[int, int],
    title: str,
) -> Any:
    """Opens a GLFW window with a core context of the first of `versions` (major, minor) that the driver supports.

    With `null_platform` GLFW uses no display; OSMesa needs only that. Otherwise it uses the desktop. GLFW can use only
    one of the two at a time. Raises ContextError if a window of the other platform is open, and for any failure of
    GLFW.
    """
    reporting, glfw.ERROR_REPORTING = glfw.ERROR_REPORTING, "ignore"  # failures are raised below, not printed
    try:
        _use_platform(backend, null_platform)
        for major, minor in versions:
            glfw.default_window_hints()
            for hint, value in hints.items():
                glfw.window_hint(hint, value)
            glfw.window_hint(glfw.CONTEXT_VERSION_MAJOR, major)
            glfw.window_hint(glfw.CONTEXT_VERSION_MINOR, minor)
            glfw.window_hint(glfw.OPENGL_PROFILE, glfw.OPENGL_CORE_PROFILE)
            window = glfw.create_window(*size, title, None, None)
            if window:
                _windows.add(_address(window))
                return window
        raise ContextError(f"{backend}: {_last_error()}")
    finally:
        glfw.ERROR_REPORTING = reporting


def _use_platform(backend: str, null_platform: bool) -> None:
    global _null_platform
    if _null_platform is not None and _null_platform != null_platform:
        if _windows:
            raise ContextError(
                f"{backend}: GLFW cannot use OSMesa and the desktop at once; release the other context first"
            )
        glfw.terminate()
        _null_platform = None
    if _null_platform is None:
        glfw.init_hint(glfw.PLATFORM, glfw.PLATFORM_NULL if null_platform else glfw.ANY_PLATFORM)
        if not glfw.init():
            raise ContextError(f"{backend}: {_last_error()}")
        _null_platform = null_platform


def _address(window: Any) -> int:
    return ctypes.cast(window, ctypes.c_void_p).value or 0


def _last_error() -> str:
    text: Any = glfw.get_error()[1]  # bytes, although the type stubs say str
    return " ".join(text.decode(errors="replace").split()) if text else "GLFW gives no reason"


class GLFWLoader:
    """The loader (viewer/gpu/context.py) of a GLFW window's context."""

    def __init__(self, window: Any) -> None:
        self.window = window

    def load_opengl_function(self, name: str) -> int:
        return ctypes.cast(glfw.get_proc_address(name), ctypes.c_void_p).value or 0

    def __enter__(self) -> None:
        glfw.make_context_current(self.window)

    def __exit__(self, *exc: object) -> None:
        glfw.make_context_current(None)  # type: ignore[arg-type]  # the type stubs do not allow None

    def release(self) -> None:
        if self.window is not None:
            _windows.discard(_address(self.window))
            glfw.destroy_window(self.window)
            self.window = None
