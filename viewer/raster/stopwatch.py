"""What preparing a scene and drawing a frame take, by the wall clock."""

from __future__ import annotations

import time
from collections.abc import Iterator
from contextlib import contextmanager

import moderngl


class Stopwatch:
    """Sums what preparing takes. It times the passes of a frame only where `measures_passes` is set, since it has to
    wait for each: timer queries do not count the work of a software rasteriser."""

    def __init__(self, gl: moderngl.Context, measures_passes: bool) -> None:
        self._gl, self._measures_passes = gl, measures_passes
        self.times: dict[str, float] = {}
        """Seconds spent on preparing, by part."""
        self.pass_ms: dict[str, float] = {}
        """Milliseconds of each pass of the last frame."""

    @contextmanager
    def preparing(self, part: str) -> Iterator[None]:
        start = time.perf_counter()
        yield
        self.times[part] = self.times.get(part, 0.0) + time.perf_counter() - start

    @contextmanager
    def drawing(self, name: str) -> Iterator[None]:
        """Time the pass `name`."""
        if not self._measures_passes:
            yield
            return
        self._gl.finish()
        start = time.perf_counter()
        yield
        self._gl.finish()
        self.pass_ms[name] = (time.perf_counter() - start) * 1e3
