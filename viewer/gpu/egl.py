"""Contexts without a screen, through EGL's device platform (EGL_EXT_platform_device)."""

from __future__ import annotations

import ctypes
from collections.abc import Callable
from contextlib import suppress
from functools import cache
from typing import Any

from ..errors import ContextError
from .context import MINIMUM_VERSION, Context, Loader

# The file name of the installed library. ctypes.util.find_library("EGL") would start other processes, and would need a
# compiler or a development package.
LIBRARY = "libEGL.so.1"
_PLATFORM_DEVICE = 0x313F


class EGLContext(Context):
    """`device` is an index below `device_count()`; None takes the first device that gives a context."""

    backend = "egl"

    def __init__(self, device: int | None = None) -> None:
        super().__init__(lambda: self._create(device))

    def _create(self, device: int | None) -> Loader:
        try:
            from glcontext import egl
        except ImportError as error:
            raise ContextError("egl: is available only on Linux") from error
        count = device_count()
        if count == 0:
            raise ContextError("egl: no devices: the EGL library is installed, but no driver for it")
        if device is not None and not 0 <= device < count:
            raise ContextError(f"egl: there is no device {device}; there are {count}, counted from 0")
        failures = []
        for index in range(count) if device is None else (device,):
            self.device_index = index
            try:
                # eglGetProcAddress also finds OpenGL's functions, so libGL (and with it X11) is not needed.
                return egl.create_context(libgl=LIBRARY, libegl=LIBRARY, glversion=MINIMUM_VERSION, device_index=index)
            except Exception as error:
                failures.append(f"device {index}: {error}")
        raise ContextError(f"egl: {'; '.join(failures)}")


def device_count() -> int:
    """The number of EGL devices; Mesa's software rasteriser counts as one. Raises ContextError if there is no EGL."""
    return _devices(None, 0)


def load_driver() -> None:
    """Load the driver of the first device, as opening the first context does. Other threads of Python go on meanwhile.

    Where there is none, nothing is loaded: that is told when a context is opened.
    """
    device = ctypes.c_void_p()
    with suppress(ContextError):
        if _devices(ctypes.byref(device), 1):
            get_display = _function("eglGetPlatformDisplayEXT", ctypes.c_void_p, ctypes.c_uint, *[ctypes.c_void_p] * 2)
            initialize = _function("eglInitialize", ctypes.c_uint, *[ctypes.c_void_p] * 3)
            initialize(get_display(_PLATFORM_DEVICE, device, None), None, None)


def _devices(found: Any, room: int) -> int:
    """How many devices there are; with `room` for some, how many `found` has now. Raises ContextError."""
    query = _function("eglQueryDevicesEXT", ctypes.c_uint, ctypes.c_int, ctypes.c_void_p, ctypes.c_void_p)
    count = ctypes.c_int()
    return count.value if query(room, found, ctypes.byref(count)) else 0


def _function(name: str, *types: type) -> Callable[..., Any]:
    """The function `name` of EGL; `types` are the ctypes of its result and its arguments. Raises ContextError."""
    library = _library()
    library.eglGetProcAddress.restype = ctypes.c_void_p
    address = library.eglGetProcAddress(name.encode())
    if not address:
        raise ContextError(f"egl: the library lacks {name}")
    return ctypes.CFUNCTYPE(*types)(address)


@cache
def _library() -> ctypes.CDLL:
    try:
        return ctypes.CDLL(LIBRARY)
    except OSError as error:
        raise ContextError(f"egl: {error}") from error
