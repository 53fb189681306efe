"""OpenGL contexts, with or without a screen."""

from __future__ import annotations

import ctypes
import os
import sys
import threading
from collections.abc import Callable
from typing import Any, Protocol, Self

import moderngl

from ..base.signals import unbroken
from ..errors import ContextError, UsageError
from .address_space import check_address_space
from .llvmpipe import keep_fences

MINIMUM_VERSION = 330
"""All rendering needs OpenGL 3.3 core, and nothing newer."""

FIX = (
    "fix: install a graphics driver, or Mesa's software OpenGL: "
    "Debian, Ubuntu: apt-get install libegl1 libgl1-mesa-dri libosmesa6; "
    "Fedora: dnf install mesa-libEGL mesa-dri-drivers mesa-libOSMesa; `pbr-viewer doctor` shows what works here"
)


class Loader(Protocol):
    """The interface of a native context that moderngl expects. `__enter__` makes the context current; `__exit__` makes
    no context current."""

    def load_opengl_function(self, name: str) -> int: ...
    def __enter__(self) -> Any: ...
    def __exit__(self, *exc: object) -> None: ...
    def release(self) -> None: ...


class Context:
    """An OpenGL context of one back end. Creating it makes it current.

    OpenGL draws into the context that is current on the thread. After another context was opened or made current, call
    `make_current` before using this one again. `make_current` also frees the textures, buffers and programs that Python
    has garbage-collected; their own `release` frees them at once. Releasing the context frees everything in it;
    `with open_context() as context:` does so at the end.
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
                # This queries the limits and extensions of the current context.
                loader: Any = _Interned(self._loader)  # moderngl's own type for it, a dict, is wrong
                with unbroken():  # it calls the loader from C
                    self.gl = moderngl.create_context(require=MINIMUM_VERSION, context=loader)
            except Exception as error:
                _leave_current()
                self._loader.release()
                raise ContextError(f"{self.backend}: {' '.join(str(error).split())}") from error
        except ContextError:
            if previous is not None:
                previous._enter()
            raise
        # By default moderngl frees no object that is not released explicitly. Mode "auto" would free an object when
        # Python garbage-collects it, in whichever context is current then. Mode "context_gc" only lists such objects,
        # and _free_dropped frees them.
        self.gl.gc_mode = "context_gc"
        _processes.add(os.getpid())
        self._process = os.getpid()
        info = self.gl.info
        self.renderer: str = info["GL_RENDERER"]
        self.vendor: str = info["GL_VENDOR"]
        self.version: str = info["GL_VERSION"]
        if "llvmpipe" in self.renderer:
            keep_fences(self)

    @property
    def is_software(self) -> bool:
        """Whether the CPU renders (Mesa's llvmpipe, for example), not a graphics card."""
        return any(name in self.renderer.lower() for name in ("llvmpipe", "softpipe", "swrast", "swiftshader"))

    def function(self, name: str, *arguments: type) -> Callable[..., None]:
        """The OpenGL function `name`, for functions that moderngl does not have. It returns nothing; `arguments` are
        the ctypes of its arguments."""
        return ctypes.CFUNCTYPE(None, *arguments)(self.address(name))

    def address(self, name: str) -> int:
        """Where the OpenGL function `name` is in memory."""
        return self._loader.load_opengl_function(name)

    def make_current(self) -> None:
        """Direct this thread's OpenGL calls to this context, and free its objects that Python has garbage-collected."""
        self._enter()
        self._free_dropped()

    def _enter(self) -> None:
        _check_process()
        if current_context() is not self:
            _leave_current()
            _current.context = self
        self._loader.__enter__()

    def release(self) -> None:
        """Destroy the context. A second call does nothing."""
        if isinstance(self.gl.mglo, moderngl.InvalidObject) or self._process != os.getpid():
            return
        previous = current_context()
        self._enter()
        # The framebuffer that was last drawn into may have no other reference.
        self.gl.fbo = None  # type: ignore[assignment]
        self._free_dropped()
        self.gl.extensions.clear()  # moderngl never frees this set
        # A context that is still current is only marked for destruction, so it has to be left first (EGL 1.5, 3.7.2).
        _leave_current()
        self.gl.release()
        if previous is not None and previous is not self:
            previous._enter()

    def _free_dropped(self) -> None:
        # This does what moderngl's Context.gc does, which fails on an object that was already released explicitly.
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
"""The processes that have opened a context: this one, or the one that it was forked from."""


def _check_process() -> None:
    """Raises ContextError in a process that was forked from one that has used OpenGL.

    A fork copies the driver's state but not its threads, so the driver would wait for them forever.
    """
    if _processes and os.getpid() not in _processes:
        raise ContextError("no OpenGL context: this process was forked from one that has used OpenGL; start it in "
                           'another way, for example with multiprocessing.set_start_method("spawn")')


def current_context() -> Context | None:
    """The context that this thread draws into."""
    return getattr(_current, "context", None)


def _leave_current() -> Context | None:
    """Make no context current on this thread, and return the one that was.

    EGL, GLX and OSMesa each remember which of their contexts is current, and they ignore a call that seems to change
    nothing. While a context of one of them is current, creating or entering a context of another one fails. So each
    context must be left through the library that it was entered with.
    """
    context = current_context()
    if context is not None:
        context._loader.__exit__(None, None, None)
        _current.context = None
    return context


_addresses: dict[int, int] = {}


class _Interned:
    """A loader for moderngl that returns the same integer object for the same address each time.

    moderngl leaks a reference to the integer of each of about 900 functions, for every context.
    """

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
    """Opens a context for rendering off screen.

    `backend` is egl, osmesa, window (a hidden window) or auto, which takes the first of them that works. `device` is an
    index into the EGL devices that `pbr-viewer doctor` lists, and implies egl; by default the first device that works
    is used. Raises ContextError, with one line for each attempt and a last line that says how to fix it; or with one
    line where the address space is too small.
    """
    if backend not in ("auto", "egl", "osmesa", "window"):
        raise UsageError(f"there is no backend {backend!r}; choose auto, egl, osmesa or window")
    _check_process()
    if not _processes:
        check_address_space()
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
    """The back ends in the order in which `auto` tries them. Only Linux has EGL, and often runs without a desktop."""
    return ("egl", "osmesa", "window") if sys.platform.startswith("linux") else ("window", "osmesa")


def create_context(name: str, device: int | None = None) -> Context:
    """Opens a context of the back end `name` (egl, osmesa or window). Raises ContextError with the reason."""
    # These imports are here so that rendering through EGL does not load GLFW.
    if name == "egl":
        from .egl import EGLContext

        return EGLContext(device)
    if name == "osmesa":
        from .osmesa import OSMesaContext

        return OSMesaContext()
    from .window import WindowContext

    return WindowContext(visible=False)
