"""References of the scenes a device is calibrated on, and how pictures of them are made and timed."""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass

import numpy as np

from ..measure.relmse import EPSILON
from ..scene.camera import Camera
from ..scene.scene import Scene
from ..settings import Settings
from ..trace.exposure import Exposure
from ..trace.tracer import Tracer

SMALL, LARGE = (64, 64), (192, 192)
"""Pixels of what is timed; errors are of small pictures."""
REFERENCE_SPP = 256
_SEED = 1 << 20


@dataclass(frozen=True, eq=False)
class Truth:
    """`linear` (H, W, 3) float64; `variance` is its own mean relative one."""

    scene: Scene
    linear: np.ndarray
    variance: float

    @classmethod
    def of(cls, tracer: Tracer, scene: Scene) -> Truth:
        with exposed(tracer, scene, Settings(mode="path", spp=REFERENCE_SPP, seed=_SEED), SMALL) as (exposure, _, _):
            return cls(scene, exposure.image().linear[..., :3].astype(np.float64), exposure.error**2)

    def error(self, linear: np.ndarray) -> float:
        """Relative, of all pixels, less what the reference's noise adds."""
        squared = (linear[..., :3] - self.linear) ** 2 / (self.linear**2 + EPSILON)
        return math.sqrt(max(float(squared.mean()) - self.variance, 1e-8))


def framing(scene: Scene) -> Camera:
    return Camera.framing(scene.center, scene.radius, 1.0)


@contextmanager
def exposed(tracer: Tracer, scene: Scene, settings: Settings,
            size: tuple[int, int]) -> Iterator[tuple[Exposure, float, float]]:
    """A picture with all its samples, and the seconds that beginning and tracing it took."""
    started = time.perf_counter()
    exposure = tracer.begin(scene, framing(scene), settings, size)
    begun = time.perf_counter()
    while not exposure.is_done:
        exposure.step(1.0)
    try:
        yield exposure, begun - started, time.perf_counter() - begun
    finally:
        exposure.release()


def seconds_of(run: Callable[[], object]) -> float:
    """`run` reads its picture back, so the device is done with it."""
    started = time.perf_counter()
    run()
    return time.perf_counter() - started


def mean_error(errors: list[float]) -> float:
    """The geometric mean."""
    return math.exp(sum(map(math.log, errors)) / len(errors))
