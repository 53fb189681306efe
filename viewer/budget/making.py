"""Carries a choice out, and mends it where the picture itself shows that another is better."""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Collection, Sequence
from dataclasses import dataclass, replace
from operator import attrgetter

import numpy as np

from ..image.image import Image
from ..measure.compare.relmse import EPSILON
from ..raster.renderer import Renderer
from ..raster.sampled_images import decode_ahead
from ..scene.camera import Camera
from ..scene.scene import Scene
from ..trace.paths.path_render import PathRender
from ..trace.paths.run import Report, run
from ..trace.tracer import Tracer
from .calibration import Calibration
from .candidates import LEAST_SAMPLES, MIN_SAMPLES, Candidate, TracedCandidate
from .choice import Choice
from .contention import Stopwatch
from .course import Course

PILOT = 4
"""Samples a pixel before pictures of the raster are held against them."""
SURE = 2.0
"""Standard deviations of a mean that are added to it."""
REHEARSAL = 10.0
"""How many times as long as it takes to finish there has to be left for trying that first."""


@dataclass(frozen=True)
class View:
    scene: Scene
    camera: Camera
    size: tuple[int, int]
    layers: Collection[str] = ()


@dataclass(frozen=True)
class Drawing:
    """What a picture was expected to take and the `seconds` that it took; `slowdown` by how many times that was longer
    than on an idle machine."""

    candidate: Candidate
    seconds: float
    slowdown: float


class Making:
    """One picture, begun at `started` by time.perf_counter. Fills in what came of `choice`; `titles` are the methods it
    made pictures by, of the raster and of the path tracer, `drawing` the last of the raster."""

    def __init__(self, renderer: Renderer, tracer: Tracer, calibration: Calibration, view: View, started: float,
                 choice: Choice) -> None:
        self._renderer, self._tracer, self._calibration = renderer, tracer, calibration
        self._view, self._started, self._choice = view, started, choice
        self.titles: tuple[set[str], set[str]] = set(), set()
        self.drawing: Drawing | None = None

    def drawn(self, candidate: Candidate) -> Image:
        """By the raster."""
        view, watch = self._view, Stopwatch()
        if not self._renderer.holds(view.scene):
            self._renderer.expect(decode_ahead(view.scene, candidate.settings))
        self.titles[0].add(candidate.title)
        image = self._renderer.render(view.scene, view.camera, candidate.settings, view.size)
        self.drawing = Drawing(candidate, watch.seconds, watch.slowdown)
        return image

    def along(self, course: Course, report: Report | None, wants_to_stop: Callable[[], bool],
              had: Image | None = None) -> Image:
        """In the time budget, for which there is a course. What is drawn first is kept where it is nearer to what the
        paths say than they are sure, or where they come to nothing in that time. `had` is a picture by the method that
        was taken so far."""
        first, path = course.first, course.path
        assert self._choice.budget is not None
        end = self._started + self._choice.budget
        other = had if first is None or first.title == self._choice.taken.title else None
        if first is not None and other is None:
            other = self.drawn(first)
        if path is None:
            assert first is not None and other is not None
            return self._taken(first, other, None)
        if first is not None and other is not None and not self._is_time_for(path, end):
            return self._instead(path, first, other, end)
        spare = self._spare(first, self._choice.budget)
        exposure = self._begin(path)
        try:
            latest = math.inf if spare is None and first is None else end - path.reserve
            if spare is not None and spare.fits(self._choice.budget):
                latest = end - spare.seconds
            is_covered = self._covered(exposure, lambda: wants_to_stop() or time.perf_counter() >= latest)
            if not is_covered and not math.isinf(latest) and not wants_to_stop():
                return self._instead(path, first, other, end)
            reserve = self._rehearsed(path, exposure, end)
            run(exposure, self._started, report, wants_to_stop, reserve)
            if first is not None and other is not None:
                if not math.isfinite(exposure.error):
                    self._choice.unfinished = None if wants_to_stop() else path
                    return self._taken(first, other, None)
                self._choice.held.append((first, against(other, exposure)))
                if self._choice.held[-1][1] < self._error(exposure):
                    self._choice.beaten = replace(path, error=self._error(exposure))
                    return self._taken(first, other, self._choice.held[-1][1])
            return self._developed(path, exposure)
        finally:
            exposure.release()

    def _instead(self, path: Candidate, first: Candidate | None, other: Image | None, end: float) -> Image:
        """Where the paths come to nothing: the best there is time for, or what is there."""
        self._choice.unfinished = path
        spare = self._spare(first, end - time.perf_counter())
        if spare is not None:
            return self._taken(spare, self.drawn(spare), None)
        assert first is not None and other is not None
        return self._taken(first, other, None)

    def _is_time_for(self, path: TracedCandidate, end: float) -> bool:
        """Whether paths come to something in what is left, at the pace of the picture that was drawn."""
        drawing = self.drawing
        late = 1.0 if drawing is None else max(drawing.seconds / max(drawing.candidate.seconds, 1e-6), 1.0)
        return time.perf_counter() + late * path.of(MIN_SAMPLES).seconds <= end

    def _spare(self, first: Candidate | None, seconds: float) -> Candidate | None:
        """What is drawn where paths come to nothing: the best of what takes no more than `seconds`, where it is better
        than what is there; the quickest where nothing is."""
        raster = [one for one in self._choice.found if not one.is_traced]
        quickest = min(raster, key=attrgetter("seconds", "error"), default=None) if first is None else None
        found = min((one for one in raster if one.seconds <= seconds), key=attrgetter("error", "seconds"),
                    default=quickest)
        return None if found is not None and first is not None and found.error >= first.error else found

    @staticmethod
    def _covered(exposure: PathRender, is_over: Callable[[], bool]) -> bool:
        """Go on until every pixel has a sample; False where it `is_over` before."""
        while not exposure.is_done and exposure.film.tile_errors()[..., 2].min() < 1:
            if is_over():
                return False
            exposure.step(0)
        return True

    def until_right(self, path: TracedCandidate, target: float, rivals: Sequence[Candidate],
                    report: Report | None, wants_to_stop: Callable[[], bool]) -> Image:
        """By paths until the picture as a whole has the error asked for; but when a few samples show that a rival has
        it, by that."""
        exposure = self._begin(path)
        end = math.inf if self._choice.budget is None else self._started + self._choice.budget

        def is_right(samples: int) -> bool:
            return exposure.samples >= samples and exposure.error <= target

        try:
            while rivals and not exposure.is_done and not wants_to_stop() and not (
                    exposure.samples >= PILOT and math.isfinite(exposure.error)):
                exposure.step(0)
            for rival in rivals if not exposure.is_done and math.isfinite(exposure.error) else ():
                if is_right(PILOT) or time.perf_counter() + rival.seconds + path.reserve > end:
                    break
                image = self.drawn(rival)
                error = against(image, exposure)
                self._choice.held.append((rival, error))
                if error <= target:
                    return self._taken(rival, image, error)
            run(exposure, self._started, report, lambda: wants_to_stop() or is_right(LEAST_SAMPLES), path.reserve)
            return self._developed(path, exposure)
        finally:
            exposure.release()

    def _rehearsed(self, path: TracedCandidate, exposure: PathRender, end: float) -> float:
        """How long what comes after the last sample takes, seen on a first picture where there is time for that: then
        all it needs is compiled, and however busy the device is, it is known."""
        seconds = path.reserve
        for _ in range(2):  # the first compiles
            if exposure.is_done or end - time.perf_counter() < REHEARSAL * seconds:
                break
            exposure.step(0)
            started = time.perf_counter()
            exposure.image()
            seconds = time.perf_counter() - started
        return seconds

    def _begin(self, path: Candidate) -> PathRender:
        view = self._view
        self.titles[1].add(path.title)
        return self._tracer.begin(view.scene, view.camera, path.settings, view.size, view.layers)

    def _taken(self, candidate: Candidate, image: Image, error: float | None) -> Image:
        self._choice.taken, self._choice.error = candidate, error
        return image

    def _developed(self, path: Candidate, exposure: PathRender) -> Image:
        self._choice.samples, error = exposure.samples, self._error(exposure)
        if exposure.settings.denoise != "off" and math.isfinite(error):
            return self._taken(replace(path, error=error), exposure.image(), None)
        return self._taken(path, exposure.image(), error if math.isfinite(error) else None)

    def _error(self, exposure: PathRender) -> float:
        """As its samples tell it; where it is filtered, with what that usually does to it."""
        is_filtered = exposure.settings.denoise != "off"
        return exposure.error * (self._calibration.traced.factor(exposure.error) if is_filtered else 1.0)


def against(image: Image, exposure: PathRender) -> float:
    """The relative error of `image`, by the unfinished picture of `exposure`: each pixel's variance is taken off its
    squared difference, and what both are relative to is the mean of the pixels around it, which is less noisy. What
    is left of the noise counts as error: few samples show no small one."""
    total, squares = (array.astype(np.float64) for array in exposure.film.read_sums())
    n = np.maximum(total[..., 3:], 1)
    truth = total[..., :3] / n
    variance = np.maximum(squares[..., :3] / n - truth**2, 0) / np.maximum(n - 1, 1)
    if isinstance(exposure.settings.background, tuple):
        truth += (1 - squares[..., 3:] / n) * np.array(exposure.settings.background)
    squared = (np.nan_to_num(image.linear[..., :3], posinf=0.0, neginf=0.0) - truth) ** 2 - variance
    relative = (squared / (around(truth) ** 2 + EPSILON)).mean(axis=-1)
    doubt = SURE * float(relative.std()) / math.sqrt(relative.size)
    return math.sqrt(max(float(relative.mean()), 0.0) + doubt)


def around(picture: np.ndarray, reach: int = 2) -> np.ndarray:
    """The mean over the square of pixels as far as `reach` from each; (H, W, C)."""
    height, width = picture.shape[:2]
    side = 2 * reach + 1
    sums = np.pad(np.pad(picture, ((reach,) * 2, (reach,) * 2, (0, 0)), mode="edge").cumsum(0).cumsum(1),
                  ((1, 0), (1, 0), (0, 0)))
    return (sums[side:, side:] - sums[:height, side:] - sums[side:, :width] + sums[:height, :width]) / side**2
