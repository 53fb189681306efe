"""The ways there are to make a picture, with what each is expected to take and how wrong it is expected to be."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import Any

from ..errors import UsageError
from ..scene.scene import Scene
from ..settings import Settings
from .calibration import Calibration, TracedMethod
from .cost import Cost, Load

MIN_SAMPLES = 4.0
"""A pixel, as expected: the last pixel has its first sample when the others have had about so many."""
MARGIN = 1.5
"""On what the first picture of a scene is expected to take: its maps and programs are not those of the calibration."""
LEAST_SAMPLES = 8
"""A pixel, before what they say of their own error is believed."""
SLACK = 1e-6
DEAR = ("environment_shadows", "ambient_occlusion", "reflections", "refraction", "indirect")
"""Settings that take time of their own: where a user has set one, only methods that are measured with it are known."""


@dataclass(frozen=True)
class Candidate:
    """A way to make the picture; `seconds` in all, preparing included, and `error`, relative, as expected."""

    title: str
    settings: Settings
    seconds: float
    error: float
    samples: float | None = None
    """A pixel; of path-traced ones."""

    @property
    def is_traced(self) -> bool:
        return self.settings.mode == "path"

    def fits(self, budget: float | None) -> bool:
        return budget is None or self.seconds <= budget * (1 + SLACK)

    def to_json(self) -> dict[str, Any]:
        return {"method": self.title, "expected_s": self.seconds, "expected_error": self.error, "spp": self.samples}


@dataclass(frozen=True)
class TracedCandidate(Candidate):
    """`begin` and `reserve` are the seconds before the first sample and after the last, `each` those of one sample of
    every pixel."""

    begin: float = 0.0
    reserve: float = 0.0
    each: float = 0.0
    method: TracedMethod | None = None
    lighting: str = ""

    def of(self, samples: float) -> TracedCandidate:
        """With so many samples a pixel."""
        assert self.method is not None
        error = self.method.error(self.lighting, samples, self.settings.denoise != "off")
        seconds = self.begin + self.each * samples + self.reserve
        return replace(self, samples=samples, seconds=seconds, error=error)

    def within(self, seconds: float) -> TracedCandidate:
        """With as many samples as there is time for, `MIN_SAMPLES` at least, and at most what is asked for."""
        samples = (seconds - self.begin - self.reserve) / self.each
        return self.of(min(max(samples, MIN_SAMPLES), float(self.settings.most_spp)))


@dataclass(frozen=True)
class Ready:
    """What need not be prepared any more: whether this process has made a first picture, and by which methods (their
    titles) it has made one of this scene."""

    has_raster: bool = False
    has_path: bool = False
    drawn: frozenset[str] = frozenset()
    holds_raster: bool = False
    holds_path: bool = False
    """Whether its triangles and maps are on the device, for whatever method."""
    compiled: frozenset[str] = frozenset()
    """Methods whose programs for such surfaces this process has compiled."""
    kept: frozenset[str] = frozenset()
    """Likewise those that the driver has on disk."""
    pace: float = 1.0
    """How many times as long as on an idle machine work takes now."""
    novelty: float = 1.0
    """How much of the time of programs that may be new to the driver those of this scene have shown to take."""
    weight: float = 1.0
    """How many times as long as expected pictures of this scene take."""


def candidates(calibration: Calibration, load: Load, scene: Scene, settings: Settings, ready: Ready = Ready(),
               needs_layers: bool = False) -> list[Candidate]:
    """All that goes with what the user has set; of the path tracer, as many samples as the time budget allows, or as
    the error needs. Raises UsageError where nothing does."""
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
        is_known = all(name in method.changes for name in DEAR
                       if getattr(settings, name, None) != getattr(default, name, None))
        changed = replace(settings, **method.changes)
        if lighting in method.errors and is_free and is_known and changed.is_used:
            seconds = ready.weight * method.picture.seconds(load)
            if method.title not in ready.drawn:
                # Of a scene that is held, what the method alone needs is still to be made.
                own = replace(method.prepare, texel=0.0, shadowed=0.0, bake=0.0)
                seconds += (own if ready.holds_raster else method.prepare).seconds(load)
                seconds += _compiling(method.compile_new, method.compile, load, method.title, ready)
                seconds = start + MARGIN * seconds
            yield Candidate(method.title, changed, ready.pace * seconds, method.errors[lighting])


def _compiling(new: Cost, kept: Cost, load: Load, title: str, ready: Ready) -> float:
    if title in ready.compiled:
        return 0.0
    least, most = kept.seconds(load), new.seconds(load)
    return least if title in ready.kept else least + ready.novelty * max(most - least, 0.0)


def _traced(calibration: Calibration, load: Load, lighting: str, settings: Settings,
            ready: Ready) -> Iterator[TracedCandidate]:
    method = calibration.traced
    begin = (0.0 if ready.has_raster else calibration.start["raster"]) * (not ready.has_path)
    begin += 0.0 if ready.has_path else calibration.start["path"]
    begin += 0.0 if ready.holds_path else MARGIN * method.prepare.seconds(load)
    # What estimates the error knows nothing of a filter: to a target, only a user has one chosen.
    can_choose = settings.denoise == "off" and settings.error is None
    for denoise in ("off", "fast") if can_choose else (settings.denoise,):
        title, compiling = "path traced", _compiling(method.compile_new, method.compile, load, "path traced", ready)
        reserve = method.finish.seconds(load)
        if denoise != "off":
            title = f"path traced, denoised ({denoise})"
            compiling += _compiling(method.filter_new, method.filter, load, title, ready)
            reserve += method.denoise.seconds(load)
        found = TracedCandidate(
            title, replace(settings, denoise=denoise), math.inf, math.inf,
            begin=ready.pace * (begin + MARGIN * compiling), reserve=ready.pace * reserve,
            each=max(ready.pace * method.sample.seconds(load), 1e-9), method=method, lighting=lighting)
        samples = float(settings.most_spp)
        if settings.error is not None:
            needed = (method.error(lighting, 1.0, False) / settings.error) ** 2
            samples = min(samples, max(needed, LEAST_SAMPLES))
        if settings.time_budget is not None:
            samples = min(samples, found.within(settings.time_budget).samples or MIN_SAMPLES)
        yield found.of(samples)
