"""Frames of the raster's methods for `reach`: pictures and times, as a report takes them."""

from __future__ import annotations

import statistics
import time

from viewer.gpu.context import Context
from viewer.measure.report.ladder import PLAIN, Method
from viewer.measure.report.store import Record
from viewer.raster.renderer import Renderer
from viewer.scene.camera import Camera
from viewer.scene.scene import Scene
from viewer.settings import Settings

FEW, MANY = 3, 7
"""At most so many frames are timed to tell whether a method may be in time, and in each of its turns."""
LEAST, TURN_S = 2, 0.5
"""No fewer in a turn; after so many seconds it ends."""


class Frames:
    """One scene under one camera; what takes over `most` times as long as plain image-based light is too slow."""

    def __init__(self, context: Context, scene: Scene, camera: Camera, base: Settings, size: tuple[int, int],
                 most: float) -> None:
        self._context, self._scene, self._camera, self._base, self._size = context, scene, camera, base, size
        self._most = most
        self._renderer = Renderer(context)
        self._shown = context.gl.framebuffer([context.gl.renderbuffer(size, 4)])
        self._plain = float("inf")
        self.too_slow: set[str] = set()
        """Slugs of methods."""

    def measure(self, method: Method) -> Record:
        """Its picture, `prepare_s` of its first frame, and `ms` of a steady one; plain comes before all others."""
        started = time.perf_counter()
        first = self._frame(method)
        times = [self._frame(method)]
        if times[0] > self._most * self._plain:
            self.too_slow.add(method.slug)
        else:
            times += self._several(method, 0, FEW)
        best = min(times)
        if method == PLAIN:
            self._plain = best
        facts = {"prepare_s": max(first - best, 0.0), "ms": best * 1e3}
        return Record(self._renderer.read_radiance(), facts, time.perf_counter() - started)

    def in_turn(self, method: Method, rounds: int) -> tuple[float, float]:
        """Milliseconds of a steady frame of plain image-based light and of `method`: medians of all rounds."""
        plain, other = [], []
        for _ in range(rounds):
            plain += self._turn(PLAIN)
            other += self._turn(method)
        return statistics.median(plain) * 1e3, statistics.median(other) * 1e3

    def _turn(self, method: Method) -> list[float]:
        self._frame(method)
        return self._several(method, LEAST, MANY)

    def _several(self, method: Method, least: int, most: int) -> list[float]:
        times: list[float] = []
        while len(times) < least or (len(times) < most and sum(times) < TURN_S):
            times.append(self._frame(method))
        return times

    def _frame(self, method: Method) -> float:
        """Seconds until it is drawn, displayed and finished."""
        settings = method.settings(self._base)
        started = time.perf_counter()
        self._renderer.draw(method.scene(self._scene), self._camera, settings, self._size, still=True)
        self._renderer.present(settings, self._shown)
        self._context.gl.finish()
        return time.perf_counter() - started

    def release(self) -> None:
        self._context.make_current()
        self._renderer.release()
        self._shown.color_attachments[0].release()
        self._shown.release()
