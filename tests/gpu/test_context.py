from __future__ import annotations

import gc
import sys
from pathlib import Path

import numpy as np
import pytest
from contexts import open_or_skip
from needs import needs

import viewer.gpu.egl
from viewer.errors import ContextError, UsageError
from viewer.gpu.context import Context, create_context, open_context

# A triangle over the lower left half of a 4 x 4 picture: its edge passes between pixel centres.
VERTEX = """#version 330 core
void main() {
    vec2 corner = vec2(gl_VertexID == 1, gl_VertexID == 2);
    gl_Position = vec4(corner * 2.25 - 1.0, 0.0, 1.0);
}
"""
FRAGMENT = """#version 330 core
out vec4 color;
void main() { color = vec4(0.2, 0.4, 1.0, 1.0); }
"""
INSIDE, OUTSIDE = (51, 102, 255, 255), (255, 0, 0, 0)


def draw(context: Context) -> np.ndarray:
    """The triangle, as (4, 4, 4) bytes, row 0 at the bottom."""
    gl = context.gl
    target = gl.simple_framebuffer((4, 4))
    target.use()
    target.clear(1.0, 0.0, 0.0, 0.0)
    program = gl.program(vertex_shader=VERTEX, fragment_shader=FRAGMENT)
    gl.vertex_array(program, []).render(vertices=3)
    return np.frombuffer(target.read(components=4), np.uint8).reshape(4, 4, 4)


def assert_triangle(context: Context) -> None:
    rows, columns = np.mgrid[0:4, 0:4]
    inside = (rows + columns + 1) / 4 < 1.125
    expected = np.where(inside[..., None], np.uint8(INSIDE), np.uint8(OUTSIDE))
    np.testing.assert_array_equal(draw(context), expected)
    assert context.gl.error == "GL_NO_ERROR"


@pytest.mark.parametrize("backend", ["egl", "osmesa"])
def test_triangle(backend: str) -> None:
    with open_or_skip(backend) as context:
        assert context.backend == backend
        assert context.gl.version_code >= 330
        assert context.renderer and context.vendor and context.version
        assert_triangle(context)


def test_triangle_in_window(display: str) -> None:
    with open_or_skip("window") as context:
        assert_triangle(context)


def test_auto_opens_the_first_that_works() -> None:
    with open_context() as context:
        assert_triangle(context)


def test_one_after_the_other(display: str) -> None:
    for backend in ("egl", "window", "osmesa", "egl", "osmesa", "window"):
        with open_or_skip(backend) as context:
            assert_triangle(context)


@pytest.mark.parametrize("other", ["egl", "osmesa", "window"])
def test_two_at_once_keep_apart(other: str, display: str) -> None:
    first, second = open_or_skip("egl"), open_or_skip(other)
    buffers = [context.gl.buffer(data) for context, data in ((second, b"two!"),)]
    first.make_current()
    buffers.insert(0, first.gl.buffer(b"one!"))
    assert_triangle(first)
    second.make_current()
    assert buffers[1].read() == b"two!"
    assert_triangle(second)
    # Releasing the one that is not current leaves the other current and whole.
    first.release()
    assert buffers[1].read() == b"two!"
    assert_triangle(second)
    second.release()


def test_release_twice() -> None:
    context = open_context()
    context.release()
    context.release()


def test_dropped_objects_are_freed_in_their_own_context() -> None:
    first, second = open_or_skip("egl"), open_or_skip("egl")
    kept = second.gl.buffer(b"kept")  # has the same number in the second context as the dropped one in the first
    first.make_current()
    dropped = first.gl.buffer(b"drop")
    assert dropped.glo == kept.glo
    second.make_current()
    del dropped
    gc.collect()
    assert kept.read() == b"kept"
    first.make_current()
    assert not first.gl.objects
    second.make_current()
    assert kept.read() == b"kept"
    first.release()
    second.release()


def test_desktop_and_null_platform_exclude_each_other(display: str) -> None:
    with open_or_skip("window"), pytest.raises(ContextError, match="release the other context first"):
        create_context("osmesa")


def test_missing_device() -> None:
    with pytest.raises(ContextError) as caught:
        open_context("egl", device=99)
    lines = str(caught.value).splitlines()
    assert len(lines) == 3
    assert lines[1].startswith("egl: ")
    assert "99" in lines[1] or "libEGL" in lines[1]
    assert lines[2].startswith("fix: ") and "apt-get install" in lines[2]


def test_every_failure_is_told(monkeypatch: pytest.MonkeyPatch) -> None:
    """No EGL library, no OSMesa, no display: one line each and one with the fix."""

    def no_library() -> None:
        raise ContextError("egl: no such library")

    monkeypatch.setattr(viewer.gpu.egl, "_library", no_library)
    monkeypatch.setattr("viewer.gpu.osmesa.create_window", _raise("osmesa: no such library"))
    monkeypatch.setattr("viewer.gpu.window.create_window", _raise("window: no display"))
    monkeypatch.setattr(sys, "platform", "linux")
    with pytest.raises(ContextError) as caught:
        open_context()
    lines = str(caught.value).splitlines()
    assert lines[1:4] == ["egl: no such library", "osmesa: no such library", "window: no display"]
    assert len(lines) == 5
    assert caught.value.exit_status == 3


def _raise(text: str):
    def fail(*_: object, **__: object) -> None:
        raise ContextError(text)

    return fail


def test_wrong_usage() -> None:
    with pytest.raises(UsageError, match="cuda"):
        open_context("cuda")
    with pytest.raises(UsageError, match="egl backend only"):
        open_context("osmesa", device=0)


@needs("linux")  # reads the resident size from /proc
@pytest.mark.parametrize("backend", ["egl", "osmesa"])
def test_no_leak(backend: str) -> None:
    """200 rounds of a 1 MiB picture each: a leak of the context or its picture would come to 200 MiB.

    The bound allows 64 KiB a round: moderngl 5.13 leaks the strings of the extension list (16 KiB) and its own
    context struct (10 KiB) while objects of the context outlive it.
    """

    def round_trip() -> None:
        with create_context(backend) as context:
            target = context.gl.simple_framebuffer((512, 512))
            target.clear(1.0, 0.0, 0.0, 1.0)
            assert target.read(viewport=(1, 1), components=4) == bytes([255, 0, 0, 255])

    open_or_skip(backend).release()
    for _ in range(20):
        round_trip()
    gc.collect()
    before = resident_kib()
    for _ in range(200):
        round_trip()
    gc.collect()
    assert resident_kib() - before < 200 * 64


def resident_kib() -> float:
    pages = int(Path("/proc/self/statm").read_text().split()[1])
    return pages * 4096 / 1024
