"""The renderers that the calls of one thread share. Threads have their own, since an OpenGL context belongs to one."""

from __future__ import annotations

import sys
import threading
from typing import TYPE_CHECKING

from .base.expect import expect

if TYPE_CHECKING:
    from .budget.chooser import Chooser
    from .raster.renderer import Renderer
    from .trace.tracer import Tracer


class _Renderers(dict[str, "Renderer"]):
    """A thread's renderers, which are released when the thread ends."""

    def __del__(self) -> None:
        if not sys.is_finalizing():  # at the end of the process its contexts end anyway
            for renderer in self.values():
                renderer.context.release()


_local = threading.local()


def shared_renderer(backend: str = "auto") -> Renderer:
    """This thread's renderer for `backend`, which is created on first use. Raises ContextError."""
    from .gpu.context import open_context
    from .raster.renderer import Renderer

    expect(backend, str, "backend", "auto, egl, osmesa or window")
    renderers: _Renderers = _local.__dict__.setdefault("renderers", _Renderers())
    if backend not in renderers:
        renderers[backend] = Renderer(open_context(backend))
    return renderers[backend]


def shared_tracer(backend: str = "auto") -> Tracer:
    """This thread's path tracer for `backend`, which shares the renderer's context. Raises ContextError."""
    from .trace.tracer import Tracer

    renderer = shared_renderer(backend)
    tracers: dict[str, Tracer] = _local.__dict__.setdefault("tracers", {})
    if backend not in tracers:
        tracers[backend] = Tracer(renderer.context)
    return tracers[backend]


def shared_chooser(backend: str) -> Chooser:
    """This thread's maker of pictures with a time budget or an error to reach, for `backend`. Raises ContextError."""
    from .budget.chooser import Chooser

    tracer = shared_tracer(backend)
    choosers: dict[str, Chooser] = _local.__dict__.setdefault("choosers", {})
    if backend not in choosers:
        choosers[backend] = Chooser(tracer.context, shared_renderer(backend), tracer)
    return choosers[backend]
