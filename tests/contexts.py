"""OpenGL contexts for tests: a back end that this machine lacks skips the test that asks for it."""

from __future__ import annotations

from needs import skip

from viewer.errors import ContextError
from viewer.gpu.context import Context, create_context, open_context


def open_or_skip(backend: str = "auto") -> Context:
    """A context of this back end, or of the first that works; the caller releases it."""
    try:
        return open_context() if backend == "auto" else create_context(backend)
    except ContextError:
        skip("opengl" if backend == "auto" else backend)
