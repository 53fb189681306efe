"""OpenGL contexts for tests: a back end that this machine lacks skips the test that asks for it."""

from __future__ import annotations

from functools import cache

from needs import skip

from viewer.errors import ContextError
from viewer.gpu.context import Context, create_context, open_context
from viewer.gpu.probe import probe


def open_or_skip(backend: str = "auto") -> Context:
    """A context of this back end, or of the first that works; the caller releases it."""
    try:
        return open_context() if backend == "auto" else create_context(backend)
    except ContextError:
        skip("opengl" if backend == "auto" else backend)


@cache
def is_software() -> bool:
    """Whether Mesa's llvmpipe draws, whose arithmetic is IEEE 754's. A graphics card rounds division, square root and
    powers as its maker likes, has 8 bits for a place between two texels, and decodes sRGB to 8 bits of mantissa: where
    a test asks for more digits than these have, it has a second bound."""
    return "llvmpipe" in probe("egl").get("renderer", "llvmpipe")  # in another process: the present context stays so
