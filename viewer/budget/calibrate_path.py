"""Measures the path tracer: how long its parts take, and what error is left after so many samples."""

from __future__ import annotations

import time
from dataclasses import dataclass, replace
from statistics import median

import numpy as np

from ..gpu.context import Context
from ..scene.scene import Scene
from ..settings import Settings
from ..trace.tracer import Tracer
from .calibration import TracedMethod
from .contention import Stopwatch
from .cost import Cost, Load
from .scenes import HOST, again, crowd, herd, mapped
from .truth import LARGE, SMALL, Truth, exposed, framing, mean_error, trace_all

FILTERED_SPP = (1, 4, 16, 48)
TIMED_SPP = 4
"""One of them."""
FEW, MAP_SIDE = 16, 2048
"""Texels along the sides of a map."""
_PLAIN = Settings(mode="path", spp=TIMED_SPP)
_FILTERED = replace(_PLAIN, denoise="fast")
_RUNS = 3


def calibrate_path(context: Context, truths: dict[str, list[Truth]]) -> TracedMethod:
    """`truths` by lighting."""
    base = next(iter(truths.values()))[0].scene
    compiling, textured = [], mapped(base, FEW)
    for _ in range(2):  # new to the driver, then not
        tracer = Tracer(context)
        compiling.append(_compiling(tracer, base, textured))
        if len(compiling) == 1:
            tracer.release()
    new, kept = compiling
    plain, filtered = ([_steady(tracer, base, settings, size) for size in (SMALL, LARGE)]
                       for settings in (_PLAIN, _FILTERED))
    prepare = _prepare(tracer, base, plain[0].total)
    errors = {lighting: [_errors(tracer, truth) for truth in those] for lighting, those in truths.items()}
    tracer.release()

    def by_pixel(seconds: list[float]) -> Cost:
        return Cost.fitted((Load.of(base, SMALL), seconds[0]), pixel=(Load.of(base, LARGE), seconds[1]))

    pairs = []
    for spp in FILTERED_SPP:
        raw, left = (mean_error([one[spp][k] for those in errors.values() for one in those]) for k in range(2))
        pairs.append((raw, left / raw))
    of_one = {lighting: mean_error([one[TIMED_SPP][0] for one in those]) * TIMED_SPP**0.5
              for lighting, those in errors.items()}
    return TracedMethod(
        new[0], kept[0], new[1], kept[1], prepare,
        sample=by_pixel([parts.trace / TIMED_SPP for parts in plain]),
        finish=by_pixel([parts.begin + parts.end for parts in plain]),
        denoise=by_pixel([max(b.total - a.total, 0.0) for a, b in zip(plain, filtered, strict=True)]),
        errors=of_one, denoised=tuple(sorted(pairs, reverse=True)))


def _errors(tracer: Tracer, truth: Truth) -> dict[int, tuple[float, float]]:
    """By samples a pixel, as they are and filtered."""
    found = {}
    for spp in FILTERED_SPP:
        with exposed(tracer, truth.scene, replace(_FILTERED, spp=spp), SMALL) as exposure:
            filtered = exposure.image().linear.astype(np.float64)
            found[spp] = truth.error(exposure.film.read_radiance().astype(np.float64)), truth.error(filtered)
    return found


@dataclass(frozen=True)
class _Parts:
    """Seconds of a picture, were nothing else at work."""

    begin: float
    trace: float
    end: float

    @property
    def total(self) -> float:
        return self.begin + self.trace + self.end


def _picture(tracer: Tracer, scene: Scene, settings: Settings, size: tuple[int, int]) -> _Parts:
    watch, times = Stopwatch(), [time.perf_counter()]
    exposure = tracer.begin(scene, framing(scene), settings, size)
    times.append(time.perf_counter())
    trace_all(exposure)
    times.append(time.perf_counter())
    exposure.image()
    times.append(time.perf_counter())
    exposure.release()
    return _Parts(*(np.diff(times) / watch.slowdown).tolist())


def _steady(tracer: Tracer, scene: Scene, settings: Settings, size: tuple[int, int] = SMALL) -> _Parts:
    """When all is prepared."""
    _picture(tracer, scene, settings, size)
    runs = [_picture(tracer, scene, settings, size) for _ in range(_RUNS)]
    return _Parts(*(median(getattr(run, part) for run in runs) for part in ("begin", "trace", "end")))


def _new(tracer: Tracer, scene: Scene, steady: float) -> float:
    """Seconds of what only the first picture of a scene takes; a later one takes `steady`."""
    return max(_picture(tracer, scene, _PLAIN, SMALL).total - steady, 0.0)


def _compiling(tracer: Tracer, base: Scene, textured: Scene) -> tuple[Cost, Cost]:
    """Of tracing and of filtering, by a tracer that has compiled nothing."""
    first = _picture(tracer, base, _PLAIN, SMALL).total
    steady = _picture(tracer, base, _PLAIN, SMALL).total
    filtering = _picture(tracer, base, _FILTERED, SMALL).total
    filtering = max(filtering - _picture(tracer, base, _FILTERED, SMALL).total, 0.0)
    prepare = _new(tracer, again(base), steady)
    each = max(_new(tracer, textured, steady) - prepare, 0.0)
    fixed = first - steady - prepare - each * Load.of(base, SMALL).programs
    return Cost(fixed=max(fixed, 0.0), program=each), Cost(fixed=filtering)


def _prepare(tracer: Tracer, base: Scene, steady: float) -> Cost:
    """Of a scene whose programs are compiled."""
    few = _new(tracer, again(base), steady)
    load, slopes = Load.of(base, SMALL), {}
    for part, more in (("triangle", crowd(base, HOST)), ("draw", herd(base)), ("texel", mapped(base, MAP_SIDE))):
        count = getattr(Load.of(more, SMALL), part + "s") - getattr(load, part + "s")
        slopes[part] = max(_new(tracer, more, steady) - few, 0.0) / count
    fixed = few - slopes["triangle"] * load.triangles - slopes["draw"] * load.draws
    return Cost(fixed=max(fixed, 0.0), **slopes)
