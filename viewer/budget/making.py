"""Makes one picture: first candidates of the raster, then paths, and at last the best combination of both."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace

import numpy as np

from ..estimate.measure import error_notes
from ..estimate.paths import LEAST_GROUPS, PathGroups, path_settings
from ..image.displayed import displayed
from ..image.image import Image
from ..raster.renderer import Renderer
from ..raster.sampled_images import decode_ahead
from ..scene.camera import Camera
from ..scene.scene import Scene
from ..settings import MAX_SPP, Settings
from ..trace.paths.run import Report
from ..trace.tracer import Tracer
from .candidates import candidates_for
from .choice import Choice
from .combine import Samples, Told, judged
from .pace import SURE, Pace, maps

GROUPS = LEAST_GROUPS
"""Independent pictures of paths: few, so that each is soon finished."""
SLICE_S, REPORT_S = 0.2, 0.5
"""Longest time between two looks at the clock; time between two reports."""
STRIP = 8192
"""Pixels of which the combination is tried, to know what it takes."""
SMALL = 8
"""How many times as narrow and low as the picture a small frame is."""
SHADOWS = "environment shadows"
"""What the renderer calls the time of their maps."""
LEAST_GROWTH, MOST_GROWTH = 1.25, 2.0
"""Of the number of samples, between two looks at the error."""
ROUND = 8.0
"""Times the samples so far, of the next round, at most: few rounds are better, since it takes a while until the last
paths of each picture have ended."""
WORTH = 16
"""Samples a pixel with which paths bring about as much as further candidates (benchmarks/results/mixture.md)."""


class Making:
    def __init__(self, renderer: Renderer, tracer: Tracer, pace: Pace, choice: Choice, scene: Scene, camera: Camera,
                 size: tuple[int, int], clock: Callable[[], float], started: float, report: Report | None,
                 wants_to_stop: Callable[[], bool]) -> None:
        self._renderer, self._tracer, self._pace, self._choice = renderer, tracer, pace, choice
        self._scene, self._camera, self._size = scene, camera, size
        self._clock, self._started, self._report, self._wants_to_stop = clock, started, report, wants_to_stop
        self._end = math.inf if choice.budget is None else started + choice.budget
        self._reported = started
        self._radiance = np.zeros((size[1], size[0], 4), np.float32)
        self._current = -1

    def image(self, raster: Settings, traced: Settings | None) -> Image:
        """`raster` and `traced` are the user's settings in modes pbr and path; without the latter paths only tell the
        error."""
        background = "none" if isinstance(raster.background, tuple) else raster.background
        self._candidates = candidates_for(self._scene, replace(raster, background=background))
        self._choice.candidates = [{"method": title, "expected_s": None, "seconds": None}
                                   for title, _ in self._candidates]
        self._pace.of(self._scene, self._size, self._renderer.holds(self._scene))
        self._draw(self._first())
        self._choice.ready = self._clock() - self._started
        self._improve(traced is not None)
        groups = PathGroups(self._tracer, self._scene, self._camera,
                            replace(traced or path_settings(raster), background=background), self._size, GROUPS,
                            growth=ROUND, clock=self._clock)
        told = None
        try:
            if self._may_trace() and not self._wants_to_stop():
                told = self._with_paths(groups, traced is not None)
            if told is None:
                self._improve(False)
        finally:
            groups.end()
        return self._finished(raster, groups, told)

    @property
    def _left(self) -> float:
        return self._end - self._clock()

    def _first(self) -> int:
        """The best candidate whose time is known, for a scene that was drawn before; else the first."""
        known = [k for k, (_, settings) in enumerate(self._candidates)
                 if self._pace.knows(settings) and self._fits(self._pace.frame(settings))]
        return max(known, default=0)

    @property
    def _next(self) -> int | None:
        """The candidate to draw next: none with fewer shadow maps than there are, nor with more than a later one."""
        count = [maps(settings) for _, settings in self._candidates]
        return next((k for k in range(self._current + 1, len(count)) if count[k] >= count[self._current] and (
            count[k] <= min(count[k:]) or self._pace.knows(self._candidates[k][1]))), None)

    def _fits(self, seconds: float, may_trace: bool = True) -> bool:
        """Whether there is time for it; and, if there is time for many paths, whether it leaves them most of it. To a
        target it may take half as long as all so far."""
        if self._choice.target is not None:
            return 2 * seconds <= self._clock() - self._started and seconds <= self._left
        return 3 * seconds <= self._left or (seconds <= self._left and not (may_trace and self._may_trace(WORTH)))

    def _improve(self, may_trace: bool) -> None:
        while (candidate := self._next) is not None and not self._wants_to_stop():
            held, settings = self._candidates[self._current][1], self._candidates[candidate][1]
            if maps(settings) and self._pace.small is None and self._pace.frames[held] <= self._left:
                width, height = (max(side // SMALL, 1) for side in self._size)
                # The first makes a target of that size.
                self._pace.small = min(self._drawn_in(held, (width, height)) for _ in range(2))
            seconds = self._pace.frame(settings)
            self._choice.candidates[candidate]["expected_s"] = seconds if math.isfinite(seconds) else None
            if not self._fits(seconds, may_trace):
                return
            self._draw(candidate)

    def _draw(self, candidate: int) -> None:
        """What was drawn is the raster's picture from now on."""
        settings, is_new = self._candidates[candidate][1], not self._renderer.holds(self._scene)
        if is_new:
            self._renderer.expect(decode_ahead(self._scene, settings))
        before, textures = dict(self._renderer.times), self._renderer.texture_seconds
        seconds = self._drawn_in(settings, self._size)
        spent = {name: value - before.get(name, 0.0) for name, value in self._renderer.times.items()}
        self._pace.drawn(settings, seconds, spent.get(SHADOWS, 0.0))
        self._radiance = np.nan_to_num(self._renderer.read_radiance(), nan=0.0, posinf=0.0, neginf=0.0)
        self._current, self._choice.candidates[candidate]["seconds"] = candidate, seconds
        if is_new:
            self._pace.first, self._pace.textures = seconds, self._renderer.texture_seconds - textures
            # It has compiled what it drew, too. What a frame takes, the second one shows.
            if seconds - sum(spent.values()) <= self._left:
                self._pace.drawn(settings, self._drawn_in(settings, self._size), 0.0)

    def _drawn_in(self, settings: Settings, size: tuple[int, int]) -> float:
        started = self._clock()
        self._renderer.draw(self._scene, self._camera, settings, size, half=False, still=True)
        self._renderer.read_radiance()
        return self._clock() - started

    def _may_trace(self, samples: int = GROUPS) -> bool:
        """Whether there is time for so many paths a pixel, by default as few as tell anything, and for what is to be
        done with them."""
        seconds = self._pace.paths(self._scene, self._tracer.holds(self._scene), samples)
        return seconds <= self._left and seconds + self._reserve <= self._left

    @property
    def _reserve(self) -> float:
        """For what comes after the last sample. Displaying takes less than a frame."""
        width, height = self._size
        if self._pace.combine is None:
            strip = self._radiance[:math.ceil(STRIP / width), :, :3]
            parts = np.stack([strip * (1 + 0.1 * k) for k in range(GROUPS)])
            self._combine(strip, Samples(parts, np.ones_like(parts[..., :1])))
        return SURE * ((self._pace.combine or 0.0) * width * height + min(self._pace.frames.values()))

    def _combine(self, raster: np.ndarray, samples: Samples) -> dict[str, Told]:
        started = self._clock()
        told = judged(raster, samples)
        self._pace.combine = (self._clock() - started) / (raster.shape[0] * raster.shape[1])
        return told

    def _with_paths(self, groups: PathGroups, mixes: bool) -> dict[str, Told] | None:
        """Trace to the end of the time, or to the target; None if there was not enough time. Without `mixes` paths only
        tell the error of the raster's picture, and after the last candidate a target is given up."""
        target, look = self._choice.target, float(GROUPS)
        while True:
            self._trace(groups, math.inf if target is None else look)
            if not groups.is_enough:
                self._choice.unfinished = None if self._wants_to_stop() else "paths"
                return None
            told = self._combine(self._radiance[..., :3], Samples(groups.total, groups.count))
            told = told if mixes else {"drawn": told["drawn"]}
            best = min(told.values(), key=lambda one: one.relmse)
            is_hopeless = not mixes and self._next is None and best.low > (target or 0.0) ** 2
            if target is None or best.high <= target**2 or is_hopeless or self._is_over(groups):
                return told
            look = groups.samples * min(max(best.high / target**2, LEAST_GROWTH), MOST_GROWTH)
            self._improve(mixes)

    def _is_over(self, groups: PathGroups) -> bool:
        return self._wants_to_stop() or self._left <= self._reserve or groups.samples >= MAX_SPP

    def _trace(self, groups: PathGroups, samples: float) -> None:
        """To so many samples a pixel, in whole rounds; or to the end of the time, perhaps within a round."""
        last = 0.0
        while not self._is_over(groups) and not (groups.is_even and groups.samples >= samples):
            left = self._left - self._reserve
            missing = 0 if groups.is_enough or not groups.pictures else GROUPS - groups.pictures
            if left <= last or (groups.pictures > 1 and missing * groups.each > left):
                break
            before, is_near = self._clock(), left < 2 * SLICE_S
            groups.step(0.0 if is_near else SLICE_S, min(groups.within(left / SURE), samples - groups.samples))
            last = self._clock() - before - (0.0 if is_near else SLICE_S)  # of one iteration, at least
            self._tell(groups, samples)
        groups.end()
        if groups.is_enough:
            self._pace.sample = groups.each

    def _tell(self, groups: PathGroups, samples: float) -> None:
        now = self._clock()
        if self._report is None or now - self._reported < REPORT_S:
            return
        self._reported = now
        spent = now - self._started
        fraction = groups.samples / samples if math.isinf(self._end) else spent / (self._end - self._started)
        fraction = min(max(fraction, 1e-3), 1.0)
        self._report(fraction, spent * (1 / fraction - 1))

    def _finished(self, raster: Settings, groups: PathGroups, told: dict[str, Told] | None) -> Image:
        choice, linear, title = self._choice, self._radiance, self._candidates[self._current][0]
        stats: dict[str, object] = {"plan": self._renderer.plan.to_json() if self._renderer.plan else {}}
        choice.method = title
        if told is not None:
            titles = {"mixed": f"{title}, mixed with paths", "drawn": title, "traced": "path traced"}
            taken = min(told, key=lambda name: told[name].relmse)
            choice.method, choice.told = titles[taken], told[taken]
            choice.compared = {titles[name]: one.relative for name, one in told.items()}
            notes = error_notes(raster, groups.missing, groups.lost_share)
            stats |= {"estimated_error": told[taken].to_json(groups.seconds, notes)}
            if taken != "drawn":
                choice.samples = groups.samples
                alpha = groups.total[..., 3:].sum(axis=0) / groups.count.sum(axis=0)
                linear = np.concatenate([told[taken].picture, alpha], axis=-1)
                stats |= groups.stats
        image = displayed(self._renderer.context, self._renderer.programs, linear, raster)
        return replace(image, stats=stats)
