"""Keeps a defect of Mesa's llvmpipe from corrupting memory (seen in Mesa 22.3.6, and still in its source of 2026).

llvmpipe draws each pass in threads of its own, and they tell the end of one by a fence: a counter behind a mutex
(lp_fence_signal in src/gallium/drivers/llvmpipe/lp_fence.c). The thread that draws next looks at the counter without
the mutex (lp_fence_signalled), and frees the fence of a pass that has ended (lp_setup_get_empty_scene in lp_setup.c).
If the system has stopped the last thread between the counter and the release of the mutex, as it does on a busy
machine, that release is then written to memory that has been freed, and may be another's by now. glibc sometimes finds
that: "corrupted double-linked list".

A sync object of OpenGL shares the fence of the pass before it. So one is made after each pass, and lives until the
threads have ended a later pass: each of them must have released the mutex then.
"""

from __future__ import annotations

import ctypes
from typing import TYPE_CHECKING, Any

import moderngl

from .free import free

if TYPE_CHECKING:
    from .context import Context

_SYNC_GPU_COMMANDS_COMPLETE = 0x9117
_SHORT_PASSES, _SHORT_PASS = 16, (512, 512)
"""Together they take a millisecond and a half."""
MOST_HELD = 1024
"""Fences that are kept, of about 100 bytes each, before the next pass waits for the device so that they can be freed.
"""


class OutOfMemory(moderngl.Error, MemoryError):
    """There was no memory for a framebuffer. Who knows what was too large catches moderngl.Error, and says it; for all
    others it is as any lack of memory."""


class LlvmpipeContext(moderngl.Context):
    """A context that keeps the fence of each pass, and says where memory lacks. A pass ends where a framebuffer is used
    or cleared."""

    passes: Passes
    _used: moderngl.Framebuffer | None

    @property  # type: ignore[override]
    def fbo(self) -> moderngl.Framebuffer | None:
        """The framebuffer that was used last; moderngl sets it before it binds one."""
        return self._used

    @fbo.setter
    def fbo(self, framebuffer: moderngl.Framebuffer | None) -> None:
        if framebuffer is not None:
            self.passes.end()
        self._used = framebuffer

    def framebuffer(self, *arguments: Any, **keywords: Any) -> moderngl.Framebuffer:
        """Raises OutOfMemory where an attachment got no memory. moderngl finds that out no sooner, and llvmpipe draws
        into all formats that are used here, so a framebuffer is incomplete for no other reason."""
        try:
            made = super().framebuffer(*arguments, **keywords)
        except moderngl.Error as error:
            if "not complete" in str(error):
                raise OutOfMemory("out of memory") from error
            raise
        made.__class__ = _Framebuffer
        return made


class _Framebuffer(moderngl.Framebuffer):
    def clear(self, *arguments: Any, **keywords: Any) -> None:
        context: Any = self.ctx
        context.passes.end()
        super().clear(*arguments, **keywords)
        if context.fbo is not self:  # moderngl binds that one again
            context.passes.end()


class Passes:
    """The fences of the passes of a context, which has to be current."""

    def __init__(self, context: Context) -> None:
        sync = ctypes.c_void_p
        # These do not wait, so Python's other threads need not go on meanwhile.
        self._fence = ctypes.PYFUNCTYPE(sync, ctypes.c_uint, ctypes.c_uint)(context.address("glFenceSync"))
        self._delete = ctypes.PYFUNCTYPE(None, sync)(context.address("glDeleteSync"))
        self._finish = context.function("glFinish")
        self.held: list[int] = []

    def wait(self) -> None:
        """Wait for the passes, without Python's lock."""
        self._finish()

    def end(self) -> None:
        """Keep the fence of what was drawn until now."""
        is_full = len(self.held) >= MOST_HELD
        if is_full:
            self._finish()
        self.held.append(self._fence(_SYNC_GPU_COMMANDS_COMPLETE, 0))
        if is_full:
            # The wait looks at a counter, too: the threads may not have left the last fence, but all before it.
            for sync in self.held[:-1]:
                self._delete(sync)
            del self.held[:-1]


def let_others_run(gl: moderngl.Context) -> None:
    """Call it before a draw that looks up what the pass before it draws, where others may decode meanwhile. llvmpipe
    waits in such a draw for its threads, and moderngl keeps Python's lock; so this waits, without it."""
    if isinstance(gl, LlvmpipeContext):
        gl.passes.wait()


def free_looked_up(gl: moderngl.Context) -> None:
    """Let llvmpipe free textures that were released, but that passes before have looked up.

    A pass is a "scene" in one of several places, and keeps what it looks up until its place is taken again
    (lp_setup_get_empty_scene in lp_setup.c). The first place that is free is taken, and a pass that looks up more than
    64 MB takes several; so the last of them keep theirs for many passes. Here so many short passes follow each other,
    each while those before are drawn, that all places are taken.
    """
    if not isinstance(gl, LlvmpipeContext):
        return
    textures = [gl.texture(_SHORT_PASS, 4) for _ in range(2)]
    targets = [gl.framebuffer([texture]) for texture in textures]
    for _ in range(_SHORT_PASSES // 2):
        for target in targets:
            target.use()
            target.clear()
    gl.passes.wait()
    free(gl, *targets, *textures)


def keep_fences(context: Context) -> None:
    """Make the context of moderngl a `LlvmpipeContext`."""
    gl = context.gl
    used = gl.__dict__.pop("fbo", None)
    gl.__class__ = LlvmpipeContext
    assert isinstance(gl, LlvmpipeContext)
    gl.passes, gl._used = Passes(context), used
