"""One context for all tests of a file."""

from __future__ import annotations

from collections.abc import Iterator

import pytest

from viewer.errors import ContextError
from viewer.gpu.context import Context, open_context
from viewer.trace.tracer import Tracer


@pytest.fixture(scope="module")
def context() -> Iterator[Context]:
    try:
        opened = open_context()
    except ContextError as error:
        pytest.skip(str(error))
    with opened:
        yield opened


@pytest.fixture(scope="module")
def tracer(context: Context) -> Iterator[Tracer]:
    tracer = Tracer(context)
    yield tracer
    tracer.release()
