"""References of the scenes a device is calibrated on, and how pictures of them are made and timed."""

from __future__ import annotations

import math
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass

import numpy as np

from ..measure.compare.relmse import EPSILON
from ..scene.camera import Camera
from ..scene.scene import Scene
from ..settings import Settings
from ..trace.paths.path_render import PathRender
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
        with exposed(tracer, scene, Settings(mode="path", spp=REFERENCE_SPP, seed=_SEED), SMALL) as exposure:
            return cls(scene, exposure.image().linear[..., :3].astype(np.float64), exposure.error**2)

    def error(self, linear: np.ndarray) -> float:
        """Relative, of all pixels, less what the reference's noise adds."""
        squared = (linear[..., :3] - self.linear) ** 2 / (self.linear**2 + EPSILON)
        return math.sqrt(max(float(squared.mean()) - self.variance, 1e-8))


def framing(scene: Scene) -> Camera:
    return Camera.framing(scene.center, scene.radius, 1.0)


@contextmanager
def exposed(tracer: Tracer, scene: Scene, settings: Settings, size: tuple[int, int]) -> Iterator[PathRender]:
    """A picture with all its samples."""
    exposure = tracer.begin(scene, framing(scene), settings, size)
    try:
        trace_all(exposure)
        yield exposure
    finally:
        exposure.release()


def trace_all(exposure: PathRender) -> None:
    while not exposure.is_done:
        exposure.step(1.0)


def mean_error(errors: list[float]) -> float:
    """The geometric mean."""
    return math.exp(sum(map(math.log, errors)) / len(errors))
