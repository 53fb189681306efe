"""OpenGL contexts: where pictures are drawn, with or without a screen."""

from __future__ import annotations

import ctypes
import os
import sys
import threading
from collections.abc import Callable
from typing import Any, Protocol, Self

import moderngl

from ..errors import ContextError, UsageError

MINIMUM_VERSION = 330
"""OpenGL 3.3 core is the floor of everything the package draws."""

FIX = (
    "fix: install a graphics driver, or Mesa's software OpenGL: "
    "Debian, Ubuntu: apt-get install libegl1 libgl1-mesa-dri libosmesa6; "
    "Fedora: dnf install mesa-libEGL mesa-dri-drivers mesa-libOSMesa; `pbr-viewer doctor` tells what works here"
)


class Loader(Protocol):
    """What moderngl asks of the owner of a native context; `__enter__` makes it current, `__exit__` makes none so."""

    def load_opengl_function(self, name: str) -> int: ...
    def __enter__(self) -> Any: ...
    def __exit__(self, *exc: object) -> None: ...
    def release(self) -> None: ...


class Context:
    """An OpenGL context of one back end, current from its creation on.

    OpenGL draws into the context that is current on the thread, so after another one was opened or made current call
    `make_current` before going on with this. Textures, buffers and programs that Python has dropped are freed then, or
    at once by their own `release`; releasing the context frees all it holds. `with open_context() as context:` does so
    at the end.
    """

    backend = ""
    device_index: int | None = None

    def __init__(self, create: Callable[[], Loader]) -> None:
        """`create` makes the native context, or raises ContextError."""
        _check_process()
        previous = _leave_current()
        try:
            self._loader = create()
            self._enter()
            try:
                # Finds out what the current context can do.
                loader: Any = _Interned(self._loader)  # moderngl's own type for it, a dict, is wrong
                self.gl = moderngl.create_context(require=MINIMUM_VERSION, context=loader)
            except Exception as error:
                _leave_current()
                self._loader.release()
                raise ContextError(f"{self.backend}: {' '.join(str(error).split())}") from error
        except ContextError:
            if previous is not None:
                previous._enter()
            raise
        # moderngl's default is never to free what is not released by hand. "auto" would free it the moment Python
        # drops it, into whichever context is current then; so it is only listed, and freed by _free_dropped.
        self.gl.gc_mode = "context_gc"
        _processes.add(os.getpid())
        self._process = os.getpid()
        info = self.gl.info
        self.renderer: str = info["GL_RENDERER"]
        self.vendor: str = info["GL_VENDOR"]
        self.version: str = info["GL_VERSION"]

    @property
    def is_software(self) -> bool:
        """Whether a processor draws, not a graphics card."""
        return any(name in self.renderer.lower() for name in ("llvmpipe", "softpipe", "swrast", "swiftshader"))

    def function(self, name: str, *arguments: type) -> Callable[..., None]:
        """An OpenGL function that returns nothing and that moderngl lacks, by the ctypes of its arguments."""
        return ctypes.CFUNCTYPE(None, *arguments)(self._loader.load_opengl_function(name))

    def make_current(self) -> None:
        """Direct this thread's OpenGL calls to this context, and free what of it Python has dropped."""
        self._enter()
        self._free_dropped()

    def _enter(self) -> None:
        _check_process()
        if current_context() is not self:
            _leave_current()
            _current.context = self
        self._loader.__enter__()

    def release(self) -> None:
        """Destroy the context; harmless when done twice."""
        if isinstance(self.gl.mglo, moderngl.InvalidObject) or self._process != os.getpid():
            return
        previous = current_context()
        self._enter()
        # The framebuffer drawn into last, which this may be all that keeps.
        self.gl.fbo = None  # type: ignore[assignment]
        self._free_dropped()
        self.gl.extensions.clear()  # moderngl leaks the set
        # A context that is still current is only marked for destruction, so it has to be left first (EGL 1.5, 3.7.2).
        _leave_current()
        self.gl.release()
        if previous is not None and previous is not self:
            previous._enter()

    def _free_dropped(self) -> None:
        # As moderngl's Context.gc, which stumbles over what was released by hand before it was dropped.
        while self.gl.objects:
            dropped = self.gl.objects.popleft()
            if not isinstance(dropped, moderngl.InvalidObject):
                dropped.release()

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *exc: object) -> None:
        self.release()

    def __repr__(self) -> str:
        return f"<{type(self).__name__} {self.renderer}, OpenGL {self.version}>"


_current = threading.local()
_processes: set[int] = set()
"""This one, once it has had a context; the one it was forked off, if that had."""


def _check_process() -> None:
    """A fork copies a driver's state but not its threads, for which it would wait forever: raises ContextError."""
    if _processes and os.getpid() not in _processes:
        raise ContextError("no OpenGL context: this process was forked off one that has used OpenGL; start it another "
                           'way, as by multiprocessing.set_start_method("spawn")')


def current_context() -> Context | None:
    """The context that this thread draws into."""
    return getattr(_current, "context", None)


def _leave_current() -> Context | None:
    """Make no context current on this thread, and return the one that was.

    EGL, GLX and OSMesa each remember a current context of their own and skip a call that seems to change nothing, and
    creating or entering a context of one of them fails while another's is current: always leave by the door one came.
    """
    context = current_context()
    if context is not None:
        context._loader.__exit__(None, None, None)
        _current.context = None
    return context


_addresses: dict[int, int] = {}


class _Interned:
    """A loader for moderngl, which leaks the number it gets for each of some 900 functions: let it be the same one."""

    def __init__(self, loader: Loader) -> None:
        self._loader = loader
        self.release = loader.release

    def load_opengl_function(self, name: str) -> int:
        address = self._loader.load_opengl_function(name)
        return _addresses.setdefault(address, address)

    def __enter__(self) -> None:
        self._loader.__enter__()

    def __exit__(self, *exc: object) -> None:
        self._loader.__exit__(*exc)


def open_context(backend: str = "auto", device: int | None = None) -> Context:
    """A context to draw off screen with.

    `backend` is egl, osmesa, window (a hidden one) or auto: the first that works. `device` is an index into the EGL
    devices that `pbr-viewer doctor` lists, and implies egl; by default the first that works is taken.
    Raises ContextError, whose text gives one line per attempt and a last one with the fix.
    """
    if backend not in ("auto", "egl", "osmesa", "window"):
        raise UsageError(f"no backend {backend!r}; there are auto, egl, osmesa, window")
    _check_process()
    if device is not None and backend not in ("auto", "egl"):
        raise UsageError(f"a device can be chosen for the egl backend only, not for {backend}")
    if backend == "auto":
        backends = ("egl",) if device is not None else auto_backends()
    else:
        backends = (backend,)
    failures = []
    for name in backends:
        try:
            return create_context(name, device)
        except ContextError as error:
            failures.append(str(error))
    raise ContextError("\n".join(["no OpenGL context:", *failures, FIX]))


def auto_backends() -> tuple[str, ...]:
    """The back ends in the order `auto` tries them: only Linux has EGL and need do without a desktop."""
    return ("egl", "osmesa", "window") if sys.platform.startswith("linux") else ("window", "osmesa")


def create_context(name: str, device: int | None = None) -> Context:
    """A context of the back end `name`, not auto. Raises ContextError with the one reason."""
    # Imported here so that a picture through EGL does not pay for loading GLFW.
    if name == "egl":
        from .egl import EGLContext

        return EGLContext(device)
    if name == "osmesa":
        from .osmesa import OSMesaContext

        return OSMesaContext()
    from .window import WindowContext

    return WindowContext(visible=False)
