"""The fences that viewer/gpu/llvmpipe.py keeps."""

from __future__ import annotations

import ctypes
from collections.abc import Iterator
from pathlib import Path

import moderngl
import pytest
from contexts import open_or_skip
from needs import needs, skip

from viewer.gpu.context import Context
from viewer.gpu.llvmpipe import MOST_HELD, LlvmpipeContext, free_looked_up


@pytest.fixture
def context() -> Iterator[Context]:
    with open_or_skip() as context:
        if "llvmpipe" not in context.renderer:
            skip("llvmpipe")
        yield context


def held(context: Context) -> list[int]:
    assert isinstance(context.gl, LlvmpipeContext)
    return context.gl.passes.held


def test_each_pass_has_its_fence_kept(context: Context) -> None:
    """Where none was kept, Mesa freed a fence that one of its threads still had locked."""
    targets = [context.gl.simple_framebuffer((8, 8)) for _ in range(2)]
    others = [context.gl.framebuffer([context.gl.texture((8, 8), 4)]) for _ in range(2)]
    before = len(held(context))
    for target in targets + others:
        target.use()
    assert len(held(context)) == before + 4
    others[0].clear()  # while another is in use: a pass before, and one of its own
    assert len(held(context)) == before + 6
    assert len(set(held(context))) == before + 6
    assert context.gl.fbo is others[1]
    assert context.gl.error == "GL_NO_ERROR"


def test_fences_are_freed_but_the_last(context: Context) -> None:
    target = context.gl.framebuffer([context.gl.texture((8, 8), 4)])
    for _ in range(MOST_HELD - len(held(context))):
        target.use()
    assert len(held(context)) == MOST_HELD
    target.use()
    assert len(held(context)) == 1
    assert context.gl.error == "GL_NO_ERROR"


def test_passes_that_free_what_others_have_looked_up_leave_nothing(context: Context) -> None:
    is_texture = ctypes.CFUNCTYPE(ctypes.c_ubyte, ctypes.c_uint)(context.address("glIsTexture"))
    texture = context.gl.texture((8, 8), 4)
    context.gl.framebuffer([texture]).use()
    before = len(held(context))
    free_looked_up(context.gl)
    assert len(set(held(context))) >= before + 8
    assert context.gl.fbo is context.gl.screen
    assert [name for name in range(1, 20) if is_texture(name)] == [texture.glo]
    assert context.gl.error == "GL_NO_ERROR"


@needs("linux")  # its limits and /proc
@pytest.mark.parametrize("attach", [
    lambda gl, size: gl.framebuffer(depth_attachment=gl.depth_texture(size)),  # as shadow maps do
    lambda gl, size: gl.framebuffer([gl.renderbuffer(size, 4)])])
def test_a_framebuffer_without_memory_is_a_memory_error(context: Context, attach) -> None:
    """256 MB where 64 MB are left"""
    import resource

    soft, hard = resource.getrlimit(resource.RLIMIT_AS)
    taken = int(Path("/proc/self/statm").read_text().split()[0]) * resource.getpagesize()
    resource.setrlimit(resource.RLIMIT_AS, (taken + (64 << 20), hard))
    try:
        with pytest.raises(MemoryError, match="^out of memory$"):
            attach(context.gl, (8192, 8192))
    finally:
        resource.setrlimit(resource.RLIMIT_AS, (soft, hard))
    attach(context.gl, (8, 8)).use()


def test_a_wrong_framebuffer_is_no_memory_error(context: Context) -> None:
    sizes = [context.gl.texture((side, side), 4) for side in (8, 16)]
    with pytest.raises(moderngl.Error) as raised:
        context.gl.framebuffer(sizes)
    assert not isinstance(raised.value, MemoryError)
