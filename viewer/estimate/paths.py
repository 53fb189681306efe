"""Independent path-traced pictures of what a raster picture shows, for a time that is not known beforehand."""

from __future__ import annotations

import math
import time
from collections.abc import Callable
from dataclasses import fields, replace
from typing import TYPE_CHECKING, Any

import numpy as np

from ..scene.camera import Camera
from ..scene.scene import Scene
from ..settings import Settings, ignored

if TYPE_CHECKING:
    from ..trace.paths.path_render import PathRender
    from ..trace.tracer import Tracer

GROUPS = 8
"""Independent pictures. Their spread tells the noise, and a mean of products of different ones lacks little of what all
their samples could tell: the part 1 / GROUPS of the term that falls with the square of the samples."""
LEAST_GROUPS = 4
"""Without these there is no estimate, however long they take."""
_SEED = 0x51ED270B
"""Its multiples are far from seeds that users choose."""
_MOST_SPP = 64
"""Of one picture, so that they come often."""
_MOST_PIXELS = 1 << 16
"""Where the CPU renders: more samples of so many pixels, evenly spaced, tell more than one or two of all."""
SLICE_S = 0.2
"""Longest time between two checks whether to stop."""


def path_settings(settings: Settings) -> Settings:
    """Settings of mode path for the picture that the raster draws with `settings`, without a coloured background.

    What only one of the two uses has its default.
    """
    others = {*ignored("path"), *ignored("pbr", "phong")}
    unused: dict[str, Any] = {f.name: f.default for f in fields(Settings) if f.name in others}
    if isinstance(settings.background, tuple):
        unused["background"] = "none"
    return replace(settings, **unused, mode="path")


class PathGroups:
    """Path-traced pictures in groups, each of the mean of several pictures with seeds of their own.

    `step` traces on. A round gives each group the same number of samples, at most as many as it had, so that what is
    there may be used at any time once it `is_enough`.
    """

    def __init__(self, tracer: Tracer, scene: Scene, camera: Camera, settings: Settings, size: tuple[int, int]) -> None:
        self._tracer, self._scene, self._camera, self._size = tracer, scene, camera, size
        self._settings = path_settings(settings)
        is_slow = tracer.context.is_software
        self.every = math.ceil(math.sqrt(size[0] * size[1] / _MOST_PIXELS)) if is_slow else 1
        """Each so many'th pixel of a row and of a column is traced."""
        shape = size[1] // self.every, size[0] // self.every
        self._sums = np.zeros((GROUPS, *shape, 3), np.float32)
        self._spp = np.zeros(GROUPS, int)
        self._hits = np.zeros(shape, bool)
        self._render: PathRender | None = None
        self._begun = 0
        self._round = 1
        self.seconds = 0.0
        """Spent in `step`."""
        self.missing: tuple[str, ...] = ()
        """What of the scene paths do not find."""
        self.lost_share = 0.0
        """The share of the light of photons that is in neither picture (`PathRender.lost_share`)."""

    @property
    def is_enough(self) -> bool:
        return bool((self._spp > 0).sum() >= LEAST_GROUPS)

    @property
    def samples(self) -> float:
        """A pixel, of all groups together."""
        return float(self._spp.sum())

    @property
    def groups(self) -> np.ndarray:
        """(G, H, W, 3) float32, the means of the groups that have samples, row 0 at the top."""
        has = self._spp > 0
        return self._sums[has] / self._spp[has, None, None, None].astype(np.float32)

    @property
    def shows_model(self) -> np.ndarray:
        """The pixels, (H, W) bool, in which some camera ray met the model or a medium: those errors are taken over."""
        return self._hits.copy() if self._hits.any() else np.ones_like(self._hits)

    def of(self, picture: np.ndarray) -> np.ndarray:
        """The pixels of `picture`, (H, W, ...) of the whole size, that are traced."""
        upwards = picture[::-1][self.every // 2::self.every, self.every // 2::self.every]
        return upwards[:self._hits.shape[0], :self._hits.shape[1]][::-1]

    def spread(self, values: np.ndarray) -> np.ndarray:
        """(H, W) of the whole size, each pixel with the value of the nearest that is traced."""
        rows, columns = (np.minimum(np.arange(side) // self.every, count - 1)
                         for side, count in zip(self._size[::-1], values.shape, strict=True))
        return values[::-1][np.ix_(rows, columns)][::-1]

    def step(self, seconds: float, left: float = math.inf) -> None:
        """Trace for about so long, or to the end of a picture; `left` is the time that there is for all to come."""
        started = time.perf_counter()
        group = int(np.argmin(self._spp))
        if self._render is None:
            self._render = self._begin(group, left)
        self._render.step(seconds)
        if self._render.is_done:
            self._take(group, self._render)
            self.release()
        self.seconds += time.perf_counter() - started

    def is_over(self, seconds: float) -> bool:
        """Whether there is an estimate, and no further picture is likely to be finished so many seconds after the
        first was begun."""
        return self.is_enough and self._render is None and self.seconds + self.seconds / self.samples > seconds

    def _begin(self, group: int, left: float) -> PathRender:
        if self._spp.min() == self._spp.max() > 0:
            fitting = left / (self.seconds / self.samples * GROUPS)
            self._round = int(max(min(fitting, self._spp[0], _MOST_SPP), 1))
        self._begun += 1
        settings = replace(self._settings, seed=_SEED * self._begun & 0xFFFFFFFF, spp=self._round)
        layers = () if self._spp[group] else ("distance",)
        render = self._tracer.begin(self._scene, self._camera, settings, self._size, layers, self.every)
        self.missing = render.plan.missing
        return render

    def _take(self, group: int, render: PathRender) -> None:
        self._sums[group] += self._round * render.read_radiance()[..., :3]
        self.lost_share += (render.lost_share - self.lost_share) / self._begun  # the mean of all
        if not self._spp[group]:
            self._hits |= render.film.read_layers()[0][..., 3] > 0
        self._spp[group] += self._round

    def release(self) -> None:
        """Give up what is unfinished."""
        if self._render is not None:
            self._render.release()
            self._render = None


def trace_for(paths: PathGroups, seconds: float, wants_to_stop: Callable[[], bool] = lambda: False) -> None:
    """Trace so many seconds, and in any case what an estimate needs."""
    while not paths.is_over(seconds) and not wants_to_stop():
        paths.step(SLICE_S, seconds - paths.seconds)
