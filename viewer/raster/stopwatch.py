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
        """Time the pass `name`, or a part of it, without what other passes take meanwhile."""
        if not self._measures_passes:
            yield
            return
        self._gl.finish()
        start, before = time.perf_counter(), sum(self.pass_ms.values())
        yield
        self._gl.finish()
        others = sum(self.pass_ms.values()) - before
        own = (time.perf_counter() - start) * 1e3 - others
        self.pass_ms[name] = self.pass_ms.get(name, 0.0) + max(own, 0.0)
