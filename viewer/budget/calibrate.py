"""Measures a device: every method of the ladder on a few small scenes, against path-traced references."""

from __future__ import annotations

from dataclasses import replace
from statistics import median

from ..gpu.context import Context
from ..measure.report.ladder import Method, ladder
from ..raster.renderer import Renderer
from ..scene.scene import Scene
from ..settings import Settings
from ..trace.tracer import Tracer
from .calibrate_path import calibrate_path
from .calibration import Calibration, RasterMethod
from .cost import Cost, Load
from .scenes import crowd, lit_scenes, mapped
from .truth import LARGE, SMALL, Truth, framing, mean_error, seconds_of

FEW, MAP_SIDE = 64, 2048
"""Texels along the sides of a map."""
PATIENCE_S = 2.0
"""For a first small picture; what takes longer is not looked at, nor its dearer kinds: paths use such time better."""
_RUNS = 5


def calibrate(context: Context, start: dict[str, float]) -> Calibration:
    """`start` is what `viewer.budget.start` measured. Takes some seconds."""
    tracer = Tracer(context)
    truths = {lighting: [Truth.of(tracer, scene) for scene in scenes] for lighting, scenes in lit_scenes().items()}
    texel = _texel(context, truths["environment"][0].scene)
    traced = calibrate_path(context, tracer, truths, texel)
    tracer.release()
    ladders = {lighting: _methods(those[0].scene) for lighting, those in truths.items()}
    raster: list[RasterMethod] = []
    slow: set[str] = set()
    for slug, method in {slug: method for those in ladders.values() for slug, method in those.items()}.items():
        applying = {lighting: those for lighting, those in truths.items() if slug in ladders[lighting]}
        found = _raster(context, method, applying, texel) if method.name not in slow else None
        if found is not None:
            raster.append(found)
        else:
            slow.add(method.name)
    return Calibration(tuple(raster), traced, start)


def _texel(context: Context, scene: Scene) -> float:
    """Seconds that one texel of a map takes to be decoded and uploaded."""
    renderer = Renderer(context)

    def seconds(side: int) -> float:
        one = mapped(scene, side)
        return seconds_of(lambda: renderer.render(one, framing(one), Settings(), SMALL))

    _, few, many = seconds(FEW), seconds(FEW), seconds(MAP_SIDE)  # the first compiles
    renderer.release()
    return max(many - few, 0.0) / (MAP_SIDE**2 - FEW**2)


def _methods(scene: Scene) -> dict[str, Method]:
    """Those that show a scene as it is lit, without what turns one more knob of another."""
    found = [method for method in ladder(scene, Settings()).raster if method.lights is None]
    return {method.slug: method for method in found
            if not any(other.name == method.name and other.changes.items() < method.changes.items() for other in found)}


def _raster(context: Context, method: Method, truths: dict[str, list[Truth]], texel: float) -> RasterMethod | None:
    """None where it takes longer than `PATIENCE_S`."""
    settings = method.settings(Settings())
    base = next(iter(truths.values()))[0].scene
    renderer = Renderer(context)
    compiling = seconds_of(lambda: renderer.render(base, framing(base), settings, SMALL))
    renderer.release()  # what a driver compiles once and keeps on disk is no cost of the next picture
    if compiling > PATIENCE_S:
        return None
    renderer = Renderer(context)
    small, large, many = (_times(renderer, settings, scene, size) for scene, size in (
        (base, SMALL), (base, LARGE), (crowd(base), SMALL)))
    errors = {}
    for lighting, those in truths.items():
        images = [renderer.render(truth.scene, framing(truth.scene), settings, SMALL) for truth in those]
        errors[lighting] = mean_error([truth.error(image.linear) for truth, image in zip(those, images, strict=True)])
    renderer.release()
    prepare = replace(Cost.fitted(small[:2], triangle=many[:2]), texel=texel)
    picture = Cost.fitted((small[0], small[2]), pixel=(large[0], large[2]), triangle=(many[0], many[2]))
    return RasterMethod(method.label, dict(method.changes), prepare, picture, errors)


def _times(renderer: Renderer, settings: Settings, scene: Scene, size: tuple[int, int]) -> tuple[Load, float, float]:
    """Seconds of preparing, and of a picture after that."""
    def picture() -> None:
        renderer.render(scene, framing(scene), settings, size)

    first = seconds_of(picture)
    steady = median(seconds_of(picture) for _ in range(_RUNS))
    return Load.of(scene, size), max(first - steady, 0.0), steady
