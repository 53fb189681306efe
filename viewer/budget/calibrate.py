"""Measures a device: every method of the ladder on a few small scenes, against path-traced references."""

from __future__ import annotations

import math
import time
from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from ..gpu.context import Context
from ..measure.relmse import EPSILON
from ..measure.report.ladder import Method, ladder
from ..raster.renderer import Renderer
from ..scene.camera import Camera
from ..scene.scene import Scene
from ..settings import Settings
from ..trace.exposure import Exposure
from ..trace.tracer import Tracer
from .calibration import Calibration, RasterMethod, TracedMethod
from .cost import Cost, Load
from .scenes import crowd, lit_scenes, mapped

SMALL, LARGE = (64, 64), (192, 192)
REFERENCE_SPP = 256
FILTERED_SPP = (1, 4, 16, 48)
MAP_SIDE = 1024
PATIENCE_S = 2.0
"""For a first small picture; what takes longer is not looked at, nor are its dearer kinds: paths use such time better."""
_RUNS = 2
_SEED = 1 << 20
Report = Callable[[float], None]
"""Told which part is done."""


@dataclass(frozen=True, eq=False)
class _Truth:
    scene: Scene
    camera: Camera
    linear: np.ndarray
    variance: float
    """Its own mean relative one."""

    def error(self, linear: np.ndarray) -> float:
        """Relative, of all pixels, less what the reference's noise adds."""
        squared = (linear[..., :3] - self.linear) ** 2 / (self.linear**2 + EPSILON)
        return math.sqrt(max(float(squared.mean()) - self.variance, 1e-8))


def calibrate(context: Context, start: dict[str, float], report: Report = lambda _: None) -> Calibration:
    """`start` is what `viewer.budget.start` measured. Takes some seconds."""
    tracer = Tracer(context, use_cache=True)
    truths = {lighting: [_truth(tracer, scene) for scene in scenes] for lighting, scenes in lit_scenes().items()}
    report(0.3)
    base = truths["environment"][0].scene
    texel = _texel(context, base)
    traced = _traced(context, tracer, truths, texel)
    tracer.release()
    report(0.5)
    ladders = {lighting: _methods(those[0].scene) for lighting, those in truths.items()}
    methods = {slug: method for those in ladders.values() for slug, method in those.items()}
    raster: list[RasterMethod] = []
    slow: set[str] = set()
    for slug, method in methods.items():
        applying = {lighting: those for lighting, those in truths.items() if slug in ladders[lighting]}
        found = _raster(context, method, applying, texel) if method.name not in slow else None
        if found is not None:
            raster.append(found)
        else:
            slow.add(method.name)
        report(0.5 + 0.5 * (len(raster) + len(slow)) / len(methods))
    return Calibration(tuple(raster), traced, start)


def _texel(context: Context, scene: Scene) -> float:
    """Seconds that one texel of a map takes to be decoded and uploaded."""
    renderer = Renderer(context)
    few, many = mapped(scene, MAP_SIDE // 16), mapped(scene, MAP_SIDE)
    seconds = [_seconds_of(lambda: renderer.render(one, _framing(one), Settings(), SMALL))  # noqa: B023
               for one in (mapped(scene, 1), few, many)]  # the first compiles
    renderer.release()
    return max(seconds[2] - seconds[1], 0.0) / MAP_SIDE**2


def _methods(scene: Scene) -> dict[str, Method]:
    """Those that show a scene as it is lit, without what turns one more knob of another."""
    found = [method for method in ladder(scene, Settings()).raster if method.lights is None]
    return {method.slug: method for method in found
            if not any(other.name == method.name and other.changes.items() < method.changes.items() for other in found)}


def _truth(tracer: Tracer, scene: Scene) -> _Truth:
    camera = _framing(scene)
    settings = Settings(mode="path", spp=REFERENCE_SPP, seed=_SEED)
    with _exposed(tracer, scene, camera, settings, SMALL) as exposure:
        return _Truth(scene, camera, exposure.image().linear[..., :3].astype(np.float64), exposure.error**2)


def _framing(scene: Scene) -> Camera:
    return Camera.framing(scene.center, scene.radius, 1.0)


class _exposed:
    """A picture with all its samples; what making it took in `prepare` and `trace`, seconds."""

    def __init__(self, tracer: Tracer, scene: Scene, camera: Camera, settings: Settings, size: tuple[int, int]) -> None:
        self._begin = lambda: tracer.begin(scene, camera, settings, size)

    def __enter__(self) -> Exposure:
        started = time.perf_counter()
        self._exposure = self._begin()
        self.prepare = time.perf_counter() - started
        while not self._exposure.is_done:
            self._exposure.step(1.0)
        self.trace = time.perf_counter() - started - self.prepare
        return self._exposure

    def __exit__(self, *exc: object) -> None:
        self._exposure.release()


def _traced(context: Context, tracer: Tracer, truths: dict[str, list[_Truth]], texel: float) -> TracedMethod:
    errors, pairs = {}, []
    for lighting, those in truths.items():
        errors[lighting] = _mean([_error(tracer, truth, 4, "off") * 2 for truth in those])
    for spp in FILTERED_SPP:
        both = [[_error(tracer, truth, spp, denoise) for denoise in ("off", "fast")]
                for those in truths.values() for truth in those]
        raw, filtered = (_mean([pair[k] for pair in both]) for k in range(2))
        pairs.append((raw, filtered / raw))
    pairs.sort(reverse=True)
    prepare, *costs = _traced_costs(context, next(iter(truths.values()))[0].scene)
    return TracedMethod(replace(prepare, texel=texel), *costs, errors, tuple(pairs))


def _error(tracer: Tracer, truth: _Truth, spp: int, denoise: str) -> float:
    settings = Settings(mode="path", spp=spp, denoise=denoise)
    with _exposed(tracer, truth.scene, truth.camera, settings, SMALL) as exposure:
        return truth.error(exposure.image().linear.astype(np.float64))


def _mean(errors: list[float]) -> float:
    """The geometric one."""
    return math.exp(sum(map(math.log, errors)) / len(errors))


def _traced_costs(context: Context, base: Scene) -> tuple[Cost, Cost, Cost, Cost]:
    """prepare, sample, finish, denoise."""
    first, prepared = {}, {}
    for name, scene, size in _loads(base):
        tracer = Tracer(context, use_cache=True)
        settings = Settings(mode="path", spp=4)
        exposed = _exposed(tracer, scene, _framing(scene), settings, size)
        with exposed as exposure:
            finish = _seconds_of(exposure.image)
        first[name] = exposed.prepare, exposed.trace / settings.spp, finish
        with exposed:
            again = exposed.prepare, exposed.trace / settings.spp
        filtered = _exposed(tracer, scene, _framing(scene), replace(settings, denoise="fast"), size)
        with filtered as exposure:
            denoise = max(_seconds_of(exposure.image) - finish, 0.0)
            denoise += max(filtered.trace - settings.spp * again[1], 0.0)  # guides are gathered on the way
        # What is compiled when it is first needed counts as preparing.
        late = settings.spp * max(first[name][1] - again[1], 0.0)
        prepared[name] = Load.of(scene, size), first[name][0] - again[0] + late, again[1], finish + again[0], denoise
        tracer.release()

    def fitted(column: int, *parts: str) -> Cost:
        pick = {"pixel": "large", "triangle": "crowd"}
        return Cost.fitted(*[(prepared["small"][0], prepared["small"][column])],
                           **{part: (prepared[pick[part]][0], prepared[pick[part]][column]) for part in parts})

    return fitted(1, "triangle"), fitted(2, "pixel"), fitted(3, "pixel"), fitted(4, "pixel")


def _raster(context: Context, method: Method, truths: dict[str, list[_Truth]], texel: float) -> RasterMethod | None:
    """None where it takes longer than `PATIENCE_S`."""
    settings = method.settings(Settings())
    errors, taken = {}, {}
    base = next(iter(truths.values()))[0].scene
    renderer = Renderer(context)
    compiled = _seconds_of(lambda: renderer.render(base, _framing(base), settings, SMALL))
    renderer.release()  # what a driver compiles once and keeps on disk is no cost of the next picture
    if compiled > PATIENCE_S:
        return None
    renderer = Renderer(context)
    for name, scene, size in _loads(base):
        def picture(scene: Scene = scene, size: tuple[int, int] = size) -> None:
            renderer.render(scene, _framing(scene), settings, size)

        first = _seconds_of(picture)
        steady = min(_seconds_of(picture) for _ in range(_RUNS))  # whatever else runs only adds to it
        taken[name] = Load.of(scene, size), max(first - steady, 0.0), steady
    for lighting, those in truths.items():
        errors[lighting] = _mean([truth.error(renderer.render(truth.scene, truth.camera, settings, SMALL).linear)
                                  for truth in those])
    renderer.release()
    small, large, many = (taken[name] for name in ("small", "large", "crowd"))
    prepare = replace(Cost.fitted(small[:2], triangle=many[:2]), texel=texel)
    frame = Cost.fitted(small[::2], pixel=large[::2], triangle=many[::2])
    return RasterMethod(method.label, dict(method.changes), prepare, frame, errors)


def _loads(base: Scene) -> list[tuple[str, Scene, tuple[int, int]]]:
    return [("small", base, SMALL), ("large", base, LARGE), ("crowd", crowd(base), SMALL)]


def _seconds_of(run: Callable[[], object]) -> float:
    """`run` reads its picture back, so the device is done with it."""
    started = time.perf_counter()
    run()
    return time.perf_counter() - started
