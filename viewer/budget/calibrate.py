"""Measures a device: the methods of the ladder on a few small scenes, against path-traced references."""

from __future__ import annotations

from dataclasses import dataclass, replace
from statistics import median

from ..bake.environment import bake_environment
from ..gpu.context import Context
from ..measure.report.ladder import Method, ladder
from ..raster.renderer import Renderer
from ..scene.scene import Scene
from ..settings import Settings
from ..trace.tracer import Tracer
from .calibrate_path import calibrate_path
from .calibration import Calibration, RasterMethod
from .contention import quiet_seconds
from .cost import Cost, Load
from .scenes import again, crowd, herd, lit_scenes, mapped
from .truth import LARGE, SMALL, Truth, framing, mean_error

FEW, MAP_SIDE = 16, 2048
"""Texels along the sides of a map."""
PATIENCE_S = 2.0
"""For a first small picture; what takes longer is not looked at, nor its dearer kinds: paths use such time better."""
GAIN = 0.97
"""Of the error of the kind before it: what has more, and its dearer kinds, are not looked at."""
EDGES = {"none", "msaa-4", "ssaa-4", "ssaa-9"}
"""Antialiasing that is looked at."""
BAKED = {"indirect", "reflections"}
"""Settings of the raster whose preparing is tracing paths."""
_RUNS = 3
_APART = Settings(antialias="msaa-2")
"""Of whose programs none is a method's: those have to be new to the driver when their turn comes."""


def calibrate(context: Context) -> Calibration:
    """Without what only a new process can tell. Takes some ten seconds.

    What is new to the driver here counts as new: let it begin with nothing on disk.
    """
    tracer = Tracer(context)
    truths = {lighting: [Truth.of(tracer, scene) for scene in scenes] for lighting, scenes in lit_scenes().items()}
    tracer.release()
    traced = calibrate_path(context, truths)
    ladders = {lighting: _methods(those[0].scene) for lighting, those in truths.items()}
    raster = _Raster(context, _shared(context, *(those[0].scene for those in truths.values())))
    for slug, method in {slug: method for those in ladders.values() for slug, method in those.items()}.items():
        raster.measure(method, {lighting: those for lighting, those in truths.items() if slug in ladders[lighting]})
    return Calibration(tuple(raster.found), traced, {"raster": 0.0, "path": 0.0})


def _methods(scene: Scene) -> dict[str, Method]:
    """Those that show a scene as it is lit, without what turns one more knob of another, and without what bakes light
    by tracing paths: in that time paths make the picture itself."""
    found = [method for method in ladder(scene, Settings()).raster
             if method.lights is None and method.changes.get("antialias") in EDGES
             and not BAKED & method.changes.keys()]
    return {method.slug: method for method in found
            if not any(other.name == method.name and other.changes.items() < method.changes.items() for other in found)}


def _shared(context: Context, environment: Scene, lights: Scene) -> Cost:
    """What preparing takes that does not depend on the method: for each texel of a map, triangle in a shadow map, and
    environment that is new."""
    assert environment.environment is not None
    source = environment.environment
    bench = _Bench(context, _APART)
    bench.prepare(mapped(environment, FEW))  # compiles
    few, many = (bench.prepare(mapped(environment, side)) for side in (FEW, MAP_SIDE))
    extra = []
    for scene in (lights, crowd(lights)):
        seconds = []
        for shadows in ("on", "off"):
            bench.settings = replace(_APART, shadows=shadows)
            bench.picture(again(scene))  # compiles
            seconds.append(bench.prepare(again(scene)))
        extra.append((Load.of(scene, SMALL), seconds[0] - seconds[1]))
    bench.release()
    return Cost(texel=max(many - few, 0.0) / (MAP_SIDE**2 - FEW**2),
                shadowed=Cost.fitted(extra[0], shadowed=extra[1]).shadowed,
                bake=quiet_seconds(lambda: bake_environment(source, cache=False)))


@dataclass(frozen=True)
class _Kind:
    """What methods have in common that differ in nothing but antialiasing: preparing a scene, the base scene without
    what others share, a draw, and another program that is new to the driver, or not."""

    prepare: Cost
    base: float
    draw: float
    programs: tuple[float, float]


class _Raster:
    """The methods one after the other, as the ladder has them: cheapest first."""

    def __init__(self, context: Context, shared: Cost) -> None:
        self.found: list[RasterMethod] = []
        self._context, self._shared = context, shared
        self._kinds: dict[str, _Kind] = {}
        self._least: dict[tuple[str, str], float] = {}
        self._closed: set[str] = set()

    def measure(self, method: Method, truths: dict[str, list[Truth]]) -> None:
        """Adds it to what is `found`, where it is of use."""
        if method.name in self._closed:
            return
        settings, base = method.settings(Settings()), next(iter(truths.values()))[0].scene
        new = _Bench(self._context, settings)
        first = [new.picture(base)]
        errors = {} if first[0] > PATIENCE_S else {
            lighting: mean_error([new.error(truth) for truth in those]) for lighting, those in truths.items()}
        error = max(errors.values(), default=float("inf"))
        if error > GAIN * self._least.get(method.family, float("inf")):
            self._closed.add(method.name)
            new.release()
            return
        self._least[method.family] = error
        kept = _Bench(self._context, settings)
        first.append(kept.picture(base))
        small = kept.steady(base)
        name = ", ".join(f"{name}={value}" for name, value in method.changes.items() if name != "antialias")
        if name not in self._kinds:
            self._kinds[name] = self._kind((new, kept), base, small)
        kind, load = self._kinds[name], Load.of(base, SMALL)
        new_cost, kept_cost = (
            Cost(fixed=max(seconds - small - kind.base - each * load.programs, 0.0), program=each)
            for seconds, each in zip(first, kind.programs, strict=True))
        many = crowd(base)
        picture = Cost.fitted((load, small), pixel=(Load.of(base, LARGE), kept.steady(base, LARGE)),
                              triangle=(Load.of(many, SMALL), kept.steady(many)))
        self.found.append(RasterMethod(method.label, dict(method.changes), new_cost, kept_cost, kind.prepare,
                                       replace(picture, draw=kind.draw), errors))
        for bench in (new, kept):
            bench.release()

    def _kind(self, benches: tuple[_Bench, _Bench], base: Scene, small: float) -> _Kind:
        """`benches` have drawn `base`, which takes `small` seconds."""
        kept = benches[1]
        load, many, stones = Load.of(base, SMALL), crowd(base), herd(base)
        prepare = max(kept.picture(again(base)) - small, 0.0)
        programs = [max(bench.picture(mapped(base, FEW)) - small - prepare, 0.0) for bench in benches]
        preparing = Cost.fitted((load, prepare), self._shared, triangle=(Load.of(many, SMALL), kept.prepare(many)))
        draws = Load.of(stones, SMALL).draws - load.draws
        first, steady = kept.picture(stones), kept.steady(stones)
        return _Kind(replace(preparing, draw=max(first - steady - prepare, 0.0) / draws), prepare,
                     max(steady - small, 0.0) / draws, (programs[0], programs[1]))


class _Bench:
    """A renderer that has compiled nothing, and the seconds its pictures take."""

    def __init__(self, context: Context, settings: Settings) -> None:
        self.settings, self._renderer = settings, Renderer(context)
        self.release = self._renderer.release

    def error(self, truth: Truth) -> float:
        return truth.error(self._renderer.render(truth.scene, framing(truth.scene), self.settings, SMALL).linear)

    def picture(self, scene: Scene, size: tuple[int, int] = SMALL) -> float:
        return quiet_seconds(lambda: self._renderer.render(scene, framing(scene), self.settings, size))

    def steady(self, scene: Scene, size: tuple[int, int] = SMALL) -> float:
        """Of a picture when all is prepared."""
        self.picture(scene, size)
        return median(self.picture(scene, size) for _ in range(_RUNS))

    def prepare(self, scene: Scene) -> float:
        """Of what only the first picture of a scene takes."""
        return max(self.picture(scene) - median(self.picture(scene) for _ in range(_RUNS)), 0.0)
