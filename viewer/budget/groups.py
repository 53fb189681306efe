"""Independent path-traced pictures of all pixels, which grow as long as there is time."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np

from ..scene.camera import Camera
from ..scene.scene import Scene
from ..settings import Settings

if TYPE_CHECKING:
    from ..trace.paths.path_render import PathRender
    from ..trace.tracer import Tracer

GROUPS = 4
_SEED = 0x51ED270B
"""Its multiples are far from seeds that users choose."""
_MOST_SPP = 64
"""Of one picture, so that they come often."""


class Groups:
    """GROUPS sums of samples that have nothing in common: only independent pictures tell the noise, since the samples
    of one picture are stratified.

    `step` traces on, in rounds: in each, every group gets a picture of as many samples a pixel. `settings` are those of
    mode path.
    """

    def __init__(self, tracer: Tracer, scene: Scene, camera: Camera, settings: Settings, size: tuple[int, int],
                 clock: Callable[[], float]) -> None:
        self._tracer, self._scene, self._camera, self._size = tracer, scene, camera, size
        self._settings, self._clock = settings, clock
        self.total = np.zeros((GROUPS, size[1], size[0], 4), np.float32)
        """Sums over samples: radiance, and alpha."""
        self.count = np.zeros((GROUPS, size[1], size[0], 1), np.float32)
        self.seconds = 0.0
        """Spent so far, the preparation of the scene left out."""
        self.each = 0.0
        """Of that for one sample a pixel, in the picture that was finished last."""
        self.pictures = 0
        """That are finished."""
        self.missing: tuple[str, ...] = ()
        """What of the scene paths do not find."""
        self._stats: dict[str, Any] = {"samples": 0, "bad_samples": 0, "rays": 0, "trace_s": 0.0}
        self._render: PathRender | None = None
        self._begun, self._spp, self._spent = 0, 0, 0.0

    @property
    def samples(self) -> float:
        """A pixel, of all groups together."""
        return float(self.count.mean()) * GROUPS

    @property
    def is_enough(self) -> bool:
        """Whether every group has samples of every pixel."""
        return self.pictures >= GROUPS

    @property
    def is_even(self) -> bool:
        """Whether all groups have as many samples."""
        return self._render is None and self.pictures % GROUPS == 0

    @property
    def stats(self) -> dict[str, Any]:
        return {"spp": self.samples, **self._stats}

    def step(self, seconds: float, most: float) -> None:
        """Trace for about so many seconds, or to the end of a group's picture. If a round begins, it is to have at most
        `most` samples a pixel, or one in each group."""
        started = self._clock()
        if self._render is None:
            if self.is_even:
                self._spp = int(max(min(most / GROUPS, self.samples / GROUPS, _MOST_SPP), 1))
            self._render = self._begin()
            if self._begun == 1:
                started = self._clock()
        self._render.step(seconds)
        spent = self._clock() - started
        self.seconds, self._spent = self.seconds + spent, self._spent + spent
        if self._render.is_done:
            self.end()
            self.pictures, self.each, self._spent = self.pictures + 1, self._spent / self._spp, 0.0

    def _begin(self) -> PathRender:
        self._begun += 1
        seed = self._settings.seed + _SEED * self._begun & 0xFFFFFFFF
        settings = replace(self._settings, seed=seed, spp=self._spp, time_budget=None, error=None)
        render = self._tracer.begin(self._scene, self._camera, settings, self._size)
        self.missing = render.plan.missing
        return render

    def end(self) -> None:
        """Add to its group what a picture has so far, and give it up."""
        if self._render is not None:
            total, squares = self._render.film.read_sums()
            group = (self._begun - 1) % GROUPS
            self.total[group] += np.concatenate([total[..., :3], squares[..., 3:]], axis=-1)
            self.count[group] += total[..., 3:]
            for name in self._stats:
                self._stats[name] += self._render.stats()[name]
            self._render.release()
            self._render = None
