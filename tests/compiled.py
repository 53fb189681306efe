"""What is compiled: the sources of every program, as the compiler gets them."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from contextlib import contextmanager

import viewer.gpu.program
from viewer.gpu.source import ProgramSource

Sources = Mapping[str, ProgramSource]
"""The assembled stages of one program: vertex, fragment, geometry."""


@contextmanager
def compiled() -> Iterator[list[Sources]]:
    """The sources of every program that is compiled meanwhile."""
    seen: list[Sources] = []
    real = viewer.gpu.program.compile_sources

    def compile_sources(context, sources, varyings=()):
        seen.append(dict(sources))
        return real(context, sources, varyings)

    viewer.gpu.program.compile_sources = compile_sources
    try:
        yield seen
    finally:
        viewer.gpu.program.compile_sources = real
