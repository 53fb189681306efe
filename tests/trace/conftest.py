"""One tracer for all tests of a file."""

from __future__ import annotations

from collections.abc import Iterator

import pytest

from viewer.gpu.context import Context
from viewer.trace.tracer import Tracer


@pytest.fixture(scope="module")
def tracer(context: Context) -> Iterator[Tracer]:
    tracer = Tracer(context)
    yield tracer
    tracer.release()
