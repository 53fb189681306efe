"""Which method to take: the least error for a time, or the least time for an error."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field, replace
from operator import attrgetter, itemgetter
from typing import Any

from ..errors import UsageError
from ..scene.scene import Scene
from ..settings import Settings
from .calibration import Calibration
from .cost import Cost, Load

MIN_SAMPLES = 4.0
"""A pixel, as expected: the last pixel has its first sample when the others have had about so many."""
SURELY = 3.0
"""How many times better the path tracer has to be, as expected, to be taken unseen."""
MARGIN = 1.5
"""On what preparing a scene is expected to take: that depends on how many programs it needs."""
LEAST_SAMPLES = 8
"""A pixel, before what they say of their own error is believed."""
NEAR = 1.5
"""How many times the error allowed the usual one of a method may be for it to be tried on a scene."""
TOLERANCE = 1.2
"""How many times the budget may be taken before it counts as not held."""
SLACK = 1e-6
SHARE = 0.25
"""Of the time that may go into a picture of the raster for the path-traced one to be held against."""


@dataclass(frozen=True)
class Candidate:
    """A way to make the picture; `seconds` in all, preparing included, and `error`, relative, as expected."""

    title: str
    settings: Settings
    seconds: float
    error: float
    samples: float | None = None
    """A pixel; of path-traced ones."""
    reserve: float = 0.0
    """Seconds of them that come after the last sample."""

    @property
    def is_traced(self) -> bool:
        return self.settings.mode == "path"

    def fits(self, budget: float | None) -> bool:
        return budget is None or self.seconds <= budget * (1 + SLACK)

    def to_json(self) -> dict[str, Any]:
        return {"method": self.title, "expected_s": self.seconds, "expected_error": self.error, "spp": self.samples}


@dataclass(frozen=True)
class Ready:
    """What need not be prepared any more: whether this process has made a first picture, and by which methods (their
    titles) it has made one of this scene."""

    has_raster: bool = False
    has_path: bool = False
    drawn: frozenset[str] = frozenset()
    traced: frozenset[str] = frozenset()
    holds_raster: bool = False
    holds_path: bool = False
    """Whether its triangles and maps are on the device, for whatever method."""
    pace: float = 1.0
    """How many times as long as expected pictures have taken of late."""


@dataclass
class Choice:
    """What was weighed and what came of it. `seconds` is from the call to the picture in memory."""

    found: list[Candidate]
    taken: Candidate
    budget: float | None = None
    target: float | None = None
    seconds: float = 0.0
    samples: float | None = None
    """A pixel; of a path-traced picture."""
    error: float | None = None
    """Relative, of this very picture as its samples tell; None: it is `taken.error`, what is usual."""
    held: list[tuple[Candidate, float]] = field(default_factory=list)
    """Pictures of the raster that were made too, and their errors against the path-traced one."""
    beaten: Candidate | None = None
    """The path-traced picture that one of them was nearer to the truth than, with the error its samples tell."""
    unfinished: Candidate | None = None
    """What was begun, and came to nothing in that time."""

    @property
    def unmet(self) -> str:
        """What was asked for, or expected, and could not be had; "": all could."""
        if self.budget is not None and self.seconds > TOLERANCE * self.budget:
            if not self.taken.fits(self.budget):
                return f"nothing is ready within {self.budget:g} s here, preparing the scene included"
            return "slower than expected"
        if self.target is not None and (self.error is None or self.error > self.target):
            return "the error asked for was not reached" if self.error is not None else \
                "whether that error is met is not known: there was no time to trace paths"
        if self.unfinished is not None:
            return f"{self.unfinished.title}: slower than expected, not every pixel had a sample"
        return ""

    def to_json(self) -> dict[str, Any]:
        return {"method": self.taken.title, "seconds": self.seconds, "spp": self.samples,
                "error": self.taken.error if self.error is None else self.error,
                "error_is": "expected" if self.error is None else "measured",
                "time_budget": self.budget, "error_target": self.target, "unmet": self.unmet or None,
                "candidates": [one.to_json() for one in self.found],
                "unfinished": self.unfinished and self.unfinished.title,
                "compared": [{"method": one.title, "error": error} for one, error in self.held]
                            + ([{"method": self.beaten.title, "error": self.beaten.error}] if self.beaten else [])}

    def __str__(self) -> str:
        """In a line."""
        wish = [] if self.budget is None else [f"time budget {self.budget:g} s"]
        wish += [] if self.target is None else [f"error {self.target:g}"]
        words = self.taken.title + ("" if self.samples is None else f", {self.samples:.3g} samples a pixel")
        words += f", in {self.seconds:.2g} s"
        words += f"; expected error {self.taken.error:.2g}" if self.error is None else f"; error {self.error:.2g}"
        other = self._runner_up()
        words += f"; {other[0]}: {other[1]:.2g}" if other else ""
        return f"{', '.join(wish)}: {words}" + (f" ({self.unmet})" if self.unmet else "")

    def _runner_up(self) -> tuple[str, float] | None:
        """The best of the other kind that there was time for."""
        if self.taken.is_traced and self.held:
            best, error = min(self.held, key=itemgetter(1))
            return best.title, error
        if self.beaten is not None:
            return self.beaten.title, self.beaten.error
        other = [one for one in self.found if one.is_traced != self.taken.is_traced and one.fits(self.budget)
                 and self.unfinished is None]
        best_other = min(other, key=attrgetter("error"), default=None)
        return None if best_other is None else (best_other.title, best_other.error)


def candidates(calibration: Calibration, scene: Scene, size: tuple[int, int], settings: Settings,
               ready: Ready = Ready(), needs_layers: bool = False) -> list[Candidate]:
    """All that goes with what the user has set; of the path tracer, as many samples as the time budget allows, or as
    the error needs. Raises UsageError where nothing does."""
    load = Load.of(scene, size)
    lighting = "environment" if scene.environment is not None else "lights"
    raster, traced = settings.check_open()
    found: list[Candidate] = []
    if raster is not None and not needs_layers:
        found += _raster(calibration, load, lighting, raster, ready)
    if traced is not None:
        found += _traced(calibration, load, lighting, traced, ready)
    if not found:
        raise UsageError("what is set leaves no method to choose from: give a --mode")
    return found


def _raster(calibration: Calibration, load: Load, lighting: str, settings: Settings,
            ready: Ready) -> Iterator[Candidate]:
    start = 0.0 if ready.has_raster else calibration.start["raster"]
    default = Settings()
    for method in calibration.raster:
        is_free = all(getattr(settings, name) in (getattr(default, name), value)
                      for name, value in method.changes.items())
        changed = replace(settings, **method.changes)
        if lighting in method.errors and is_free and changed.is_used:
            seconds = method.picture.seconds(load)
            seconds += _preparing(method.prepare, load, method.title in ready.drawn, ready.holds_raster)
            seconds *= ready.pace
            yield Candidate(method.title, changed, start + seconds, method.errors[lighting])


def _preparing(cost: Cost, load: Load, is_done: bool, is_held: bool) -> float:
    if is_done:
        return 0.0
    return MARGIN * (cost.fixed if is_held else cost.seconds(load))


def _traced(calibration: Calibration, load: Load, lighting: str, settings: Settings,
            ready: Ready) -> Iterator[Candidate]:
    method = calibration.traced
    start = 0.0 if ready.has_path else calibration.start["path"]
    # What estimates the error knows nothing of a filter: to a target, only a user has one chosen.
    can_choose = settings.denoise == "off" and settings.error is None
    for denoise in ("off", "fast") if can_choose else (settings.denoise,):
        title = "path traced" if denoise == "off" else f"path traced, denoised ({denoise})"
        filtering = method.denoise.seconds(load) if denoise != "off" else 0.0
        reserve = ready.pace * (method.finish.seconds(load) + filtering)
        fixed = start + reserve
        fixed += ready.pace * _preparing(method.prepare, load, title in ready.traced, ready.holds_path)
        samples = float(settings.most_spp)
        if settings.error is not None:
            samples = min(samples, max((method.error(lighting, 1.0, False) / settings.error) ** 2, LEAST_SAMPLES))
        each = max(ready.pace * method.sample.seconds(load), 1e-9)
        if settings.time_budget is not None:
            samples = min(samples, max((settings.time_budget - fixed) / each, MIN_SAMPLES))
        yield Candidate(title, replace(settings, denoise=denoise), fixed + each * samples,
                        method.error(lighting, samples, denoise != "off"), samples, reserve)


def choose(found: Sequence[Candidate], budget: float | None, error: float | None) -> Candidate:
    """Of those within `budget` seconds the least error, but of those within `error` too the least time; where none is
    within the budget, the fastest."""
    fitting = [one for one in found if one.fits(budget)]
    if not fitting:
        return min(found, key=attrgetter("seconds", "error"))
    right = [one for one in fitting if error is not None and one.error <= error * (1 + SLACK)]
    if right:
        return min(right, key=attrgetter("seconds", "error"))
    return min(fitting, key=attrgetter("error", "seconds"))


def stand_in(found: Sequence[Candidate], budget: float, chosen: Candidate) -> Candidate | None:
    """The picture of the raster to make first, and hold the path-traced one against: what is expected of either is
    less sure than what is seen when both are there. None: that is not worth its time."""
    quick = [one for one in found if not one.is_traced and one.seconds <= SHARE * budget]
    best = min(quick, key=attrgetter("error", "seconds"), default=None)
    return best if best is not None and chosen.error > best.error / SURELY else None


def worth_trying(found: Sequence[Candidate], path: Candidate, target: float) -> list[Candidate]:
    """The methods of the raster that may have such an error and are faster than tracing to it, two at most: the
    fastest, and the one that usually is best."""
    near = sorted((one for one in found if not one.is_traced and one.error <= NEAR * target
                   and one.seconds < path.seconds / 2), key=attrgetter("seconds"))
    best = min(near[1:], key=attrgetter("error"), default=None)
    return near if best is None else [near[0], best]
