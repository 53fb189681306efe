"""Independent path-traced pictures of what a raster picture shows, for a time that is not known beforehand.

Only independent pictures tell the noise, since the samples of one are stratified.
"""

from __future__ import annotations

import math
import time
from collections.abc import Callable
from dataclasses import fields, replace
from typing import TYPE_CHECKING, Any, Self

import numpy as np

from ..scene.camera import Camera
from ..scene.scene import Scene
from ..settings import Settings, ignored

if TYPE_CHECKING:
    from ..trace.paths.path_render import PathRender
    from ..trace.tracer import Tracer

GROUPS = 8
"""Independent pictures by which an error is told. Their spread tells the noise, and a mean of products of different
ones lacks little of what all their samples could tell: the part 1 / GROUPS of the term that falls with the square of
the samples."""
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
    """Sums of samples in `groups` groups, which have nothing in common.

    `step` traces on. A round gives each group a picture of as many samples, at most `growth` times as many as it had,
    so that what is there may be used at any time once it `is_enough`. The pictures of a group share one sequence of
    random numbers, as that has less noise than several. `settings` are those of mode path. Each `every`-th pixel of a
    row and of a column is traced. `is_masked`: what `shows_model` needs is found, too.
    """

    def __init__(self, tracer: Tracer, scene: Scene, camera: Camera, settings: Settings, size: tuple[int, int],
                 groups: int, every: int = 1, is_masked: bool = False, growth: float = 1.0,
                 clock: Callable[[], float] = time.perf_counter) -> None:
        self._tracer, self._scene, self._camera, self._size = tracer, scene, camera, size
        self._settings, self._is_masked, self._growth, self._clock = settings, is_masked, growth, clock
        self.every = every
        shape = size[1] // every, size[0] // every
        self.total = np.zeros((groups, *shape, 4), np.float32)
        """Sums over samples: radiance, and alpha."""
        self.count = np.zeros((groups, *shape, 1), np.float32)
        self._hits = np.zeros(shape, bool)
        self.seconds = 0.0
        """Spent so far, the preparation of the scene left out."""
        self.each = 0.0
        """Of that for one sample a pixel, in the picture that was finished last."""
        self._took: dict[int, float] = {}
        """Seconds of pictures that are finished, by their samples a pixel."""
        self.pictures = 0
        """That are finished."""
        self.missing: tuple[str, ...] = ()
        """What of the scene paths do not find."""
        self.lost_share = 0.0
        """The share of the light of photons that is in neither picture (`PathRender.lost_share`)."""
        self._stats: dict[str, Any] = {"samples": 0, "bad_samples": 0, "rays": 0, "trace_s": 0.0}
        self._render: PathRender | None = None
        self._begun, self._spp, self._spent = 0, 0, 0.0
        self._numbered = [0] * groups
        """The samples a pixel of each group that were begun."""

    @classmethod
    def of_raster(cls, tracer: Tracer, scene: Scene, camera: Camera, settings: Settings, size: tuple[int, int]) -> Self:
        """To tell the error of what the raster draws with `settings`."""
        pixels = size[0] * size[1]
        every = math.ceil(math.sqrt(pixels / _MOST_PIXELS)) if tracer.context.is_software else 1
        return cls(tracer, scene, camera, path_settings(settings), size, GROUPS, every, True)

    @property
    def is_enough(self) -> bool:
        """Whether there are as many groups with samples of every pixel as an estimate needs."""
        return self.pictures >= LEAST_GROUPS

    @property
    def is_even(self) -> bool:
        """Whether all groups have as many samples."""
        return self.is_between and self.pictures % len(self.total) == 0

    @property
    def is_between(self) -> bool:
        """Whether no picture is begun and not finished."""
        return self._render is None

    @property
    def samples(self) -> float:
        """A pixel, of all groups together."""
        return float(self.count.mean()) * len(self.total)

    @property
    def groups(self) -> np.ndarray:
        """(G, H, W, 3) float32, the means of the groups that have samples of every pixel, row 0 at the top."""
        whole = slice(min(self.pictures, len(self.total)))
        return self.total[whole, ..., :3] / self.count[whole]

    @property
    def stats(self) -> dict[str, Any]:
        """As those of a path-traced picture."""
        return {"spp": self.samples, **self._stats} | ({"photons_lost": self.lost_share} if self.lost_share else {})

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

    def step(self, seconds: float, most: float = math.inf) -> None:
        """Trace for about so long, or to the end of a group's picture. If a round begins, it is to have at most `most`
        samples a pixel, or one in each group."""
        started = self._clock()
        if self._render is None:
            if self.is_even:
                had = self.samples / len(self.total)
                self._spp = int(max(min(most / len(self.total), self._growth * had, _MOST_SPP), 1))
            self._render = self._begin()
            if self._begun == 1:
                started = self._clock()
        self._render.step(seconds)
        spent = self._clock() - started
        self.seconds, self._spent = self.seconds + spent, self._spent + spent
        if self._render.is_done:
            if self._is_masked and self.pictures < len(self.total):
                self._hits |= self._render.film.read_layers()[0][..., 3] > 0
            self.end()
            self._took[self._spp] = self._spent
            self.pictures, self.each, self._spent = self.pictures + 1, self._spent / self._spp, 0.0

    def within(self, seconds: float) -> float:
        """The samples a pixel that a round of so many seconds may have: n in each picture take a + b n, where a is for
        the paths that end last. Infinite before a picture is finished."""
        if not self._took:
            return math.inf
        (least, short), (most, long) = min(self._took.items()), max(self._took.items())
        b = max((long - short) / (most - least) if most > least else long / most, 1e-9)
        a = max(long - b * most, 0.0)
        return len(self.total) * max(seconds / len(self.total) - a, 0.0) / b

    def _begin(self) -> PathRender:
        group = self._begun % len(self.total)
        first = self._numbered[group]
        self._begun += 1
        self._numbered[group] += self._spp
        seed = self._settings.seed + _SEED * (group + 1) & 0xFFFFFFFF
        settings = replace(self._settings, seed=seed, spp=self._spp, time_budget=None, error=None)
        layers = ("distance",) if self._is_masked and self.pictures < len(self.total) else ()
        render = self._tracer.begin(self._scene, self._camera, settings, self._size, layers, self.every, first=first)
        self.missing = render.plan.missing
        return render

    def end(self) -> None:
        """Add to its group what a picture has so far, and give it up."""
        if self._render is not None:
            total, squares = self._render.film.read_sums()
            group = (self._begun - 1) % len(self.total)
            self.total[group] += np.concatenate([total[..., :3], squares[..., 3:]], axis=-1)
            self.count[group] += total[..., 3:]
            if self._render.is_done:  # a pixel whose samples are all bad is black, as in pictures of mode path
                np.maximum(self.count[group], 1, out=self.count[group])
            self.lost_share += (self._render.lost_share - self.lost_share) / self._begun  # the mean of all
            stats = self._render.stats()
            for name in self._stats:
                self._stats[name] += stats[name]
            self.release()

    def release(self) -> None:
        """Give up what is unfinished."""
        if self._render is not None:
            self._render.release()
            self._render = None


def trace_for(paths: PathGroups, seconds: float, wants_to_stop: Callable[[], bool]) -> None:
    """Trace so many seconds, and in any case what an estimate needs."""
    while not is_over(paths, seconds) and not wants_to_stop():
        paths.step(SLICE_S, (seconds - paths.seconds) / paths.each if paths.each else math.inf)


def is_over(paths: PathGroups, seconds: float) -> bool:
    """Whether there is an estimate, and no further picture is likely to be finished so many seconds after the first was
    begun."""
    return paths.is_enough and paths.is_between and paths.seconds + paths.seconds / paths.samples > seconds
