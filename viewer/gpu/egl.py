"""Contexts without a screen, through EGL's device platform (EGL_EXT_platform_device)."""

from __future__ import annotations

import ctypes
from functools import cache

from ..errors import ContextError
from .context import MINIMUM_VERSION, Context, Loader

# The file name of the installed library. ctypes.util.find_library("EGL") would start other processes, and would need a
# compiler or a development package.
LIBRARY = "libEGL.so.1"


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
    library = _library()
    library.eglGetProcAddress.restype = ctypes.c_void_p
    address = library.eglGetProcAddress(b"eglQueryDevicesEXT")
    if not address:
        raise ContextError("egl: the library lacks EGL_EXT_device_enumeration")
    query = ctypes.CFUNCTYPE(ctypes.c_uint, ctypes.c_int, ctypes.c_void_p, ctypes.POINTER(ctypes.c_int))(address)
    count = ctypes.c_int()
    if not query(0, None, ctypes.byref(count)):
        return 0
    return count.value


@cache
def _library() -> ctypes.CDLL:
    try:
        return ctypes.CDLL(LIBRARY)
    except OSError as error:
        raise ContextError(f"egl: {error}") from error
