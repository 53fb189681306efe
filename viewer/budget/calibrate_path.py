"""Measures the path tracer: how long its parts take, and what error is left after so many samples."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from ..gpu.context import Context
from ..scene.scene import Scene
from ..settings import Settings
from ..trace.tracer import Tracer
from .calibration import TracedMethod
from .cost import Cost, Load
from .scenes import crowd
from .truth import LARGE, SMALL, Truth, exposed, mean_error, seconds_of

FILTERED_SPP = (1, 4, 16, 48)
TIMED_SPP = 4


def calibrate_path(context: Context, tracer: Tracer, truths: dict[str, list[Truth]], texel: float) -> TracedMethod:
    """`truths` by lighting; `texel` is what one of a map costs to prepare."""
    pairs = []
    for spp in FILTERED_SPP:
        both = [[_error(tracer, truth, spp, denoises) for denoises in (False, True)]
                for those in truths.values() for truth in those]
        raw, filtered = (mean_error([pair[k] for pair in both]) for k in range(2))
        pairs.append((raw, filtered / raw))
    errors = {lighting: mean_error([_error(tracer, truth, TIMED_SPP, False) for truth in those]) * TIMED_SPP**0.5
              for lighting, those in truths.items()}
    base = next(iter(truths.values()))[0].scene
    small, large, many = _Times(context, base, SMALL), _Times(context, base, LARGE), _Times(context, crowd(base), SMALL)

    def by_pixel(name: str) -> Cost:
        return Cost.fitted((small.load, getattr(small, name)), pixel=(large.load, getattr(large, name)))

    prepare = Cost.fitted((small.load, small.prepare), triangle=(many.load, many.prepare))
    return TracedMethod(replace(prepare, texel=texel), by_pixel("sample"), by_pixel("finish"), by_pixel("denoise"),
                        errors, tuple(sorted(pairs, reverse=True)))


def _error(tracer: Tracer, truth: Truth, spp: int, denoises: bool) -> float:
    settings = Settings(mode="path", spp=spp, denoise="fast" if denoises else "off")
    with exposed(tracer, truth.scene, settings, SMALL) as (exposure, _, _):
        return truth.error(exposure.image().linear.astype(np.float64))


class _Times:
    """Seconds of the parts of a picture, on a tracer that is new to the scene."""

    def __init__(self, context: Context, scene: Scene, size: tuple[int, int]) -> None:
        self.load = Load.of(scene, size)
        tracer = Tracer(context)
        plain = Settings(mode="path", spp=TIMED_SPP)
        with exposed(tracer, scene, plain, size) as (exposure, begin, first_trace):
            finish = seconds_of(exposure.image)
        with exposed(tracer, scene, plain, size) as (_, begin_again, trace):
            self.sample = trace / TIMED_SPP
        with exposed(tracer, scene, replace(plain, denoise="fast"), size) as (exposure, _, guided_trace):
            filtering = seconds_of(exposure.image)
        tracer.release()
        self.finish = finish + begin_again
        self.denoise = max(filtering - finish, 0.0) + max(guided_trace - trace, 0.0)  # guides are gathered on the way
        # What is compiled when it is first needed counts as preparing.
        self.prepare = max(begin - begin_again, 0.0) + max(first_trace - trace, 0.0)
