"""The methods of rendering a scene, from the cheapest to path tracing, which has no error but noise.

A method is data: changes of the settings, and in one case other lights. `ladder` lists the methods that apply to a
scene, and why others do not. Nothing is drawn here.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, fields, replace
from importlib.util import find_spec
from typing import Any

from ...bake.environment import BakedEnvironment, bake_environment
from ...plan.curves import draws_curves
from ...plan.planner import plan_scene
from ...plan.warnings import NO_PHOTONS
from ...quality import POINTS, QualityName
from ...raster.caustics import plan_lines
from ...scene.light import Light
from ...scene.scene import Scene
from ...settings import Mode, Settings, ignored, setting_choices
from .stand_in_lights import environment_lights

SPP = tuple(1 << k for k in range(13))
"""Samples per pixel of the path-traced points; how many of these are measured depends on the time."""
TARGETS = (0.1, 0.05, 0.03, 0.02, 0.01)
"""Estimated relative errors at which adaptive path tracing stops."""
KNOBS = ("multiscatter", "specular_aa", "fresnel")
"""Settings of which the choices beside the user's are measured, one at a time, with image-based light."""
CURVE_KNOBS = ("hair_scattering",)
"""The same of scenes with curves."""
SHADOWS = "environment-shadows", "shadows of the environment"
"""Name and title."""
ESTIMATED = "estimated", "shadows of the environment and estimated indirect light"
"""Name and title of the method with the settings of `--quality standard`."""
OCCLUDED = ("none", "msaa-4", "ssaa-4")
"""Choices of antialiasing with which ambient occlusion is measured."""
SHADOWED = {"16": ("none", "msaa-4", "ssaa-4", "ssaa-9"), "64": ("msaa-4", "ssaa-4", "ssaa-9", "ssaa-16")}
"""How many lights of the environment cast shadows, and the choices of antialiasing to measure with them."""
MANY = {"256": ("ssaa-4", "ssaa-16"), "1024": ("ssaa-16",)}
"""The same for so many lights that preparing takes long: these are measured last."""
MEDIA = {
    "single": (("28", "sixteenth"),),
    "multiple": (("28", "sixteenth"), ("28", "ninth"), ("28", "quarter"), ("56", "quarter"), ("112", "quarter"),
                 ("56", "all"), ("224", "all")),
}
"""Of fog and volumes: how often light is scattered, the steps of a ray, and which pixels have one."""
EFFECTS = {"indirect": ("baked", "indirect light"), "reflections": ("traced", "traced reflections"),
           "refraction": ("traced", "traced refraction")}
"""Settings that add an effect of light to the raster: the expensive choice of each, and its title."""
INDIRECT = {"16": ("ssaa-4", "ssaa-9"), "64": ("ssaa-9",)}
"""Lights and antialiasing as in SHADOWED, with indirect light and no other of EFFECTS."""
TOGETHER = {"64": ("ssaa-4", "ssaa-9", "ssaa-16"), "256": ("ssaa-16",)}
"""Lights and antialiasing as in SHADOWED, with all of EFFECTS."""
PHOTONS = 4, 16, 64
"""Photons a pixel with which caustics are measured."""


@dataclass(frozen=True)
class Method:
    """One way to render the picture.

    `name` is for scripts, `title` for people; several methods share them. `changes` are the settings that differ from
    the user's, by name. If `lights` is not None, these take the place of the environment.
    """

    name: str
    title: str
    changes: dict[str, Any] = field(default_factory=dict)
    lights: tuple[Light, ...] | None = None
    quality: QualityName | None = None
    """The name of the point, if it is one of `--quality`."""

    @property
    def slug(self) -> str:
        """Distinct for each method of a ladder, and usable as a file name."""
        parts = [f"{key}-{value}" for key, value in self.changes.items() if key != "mode"]
        return "-".join([self.name, *parts]).replace("_", "-")

    @property
    def label(self) -> str:
        """The title, and what distinguishes the method from others with that title."""
        return ", ".join([self.title, *filter(None, map(_words, self.changes, self.changes.values()))])

    @property
    def family(self) -> tuple[str, str]:
        """Methods of one family differ in one setting that raises their cost step by step, or hardly in cost."""
        return self.name, self.changes.get("antialias", "")

    @property
    def mode(self) -> Mode:
        return self.changes.get("mode", "pbr")

    @property
    def is_traced(self) -> bool:
        return self.mode == "path"

    def settings(self, base: Settings) -> Settings:
        """`base` with the changes; settings that the method ignores have their defaults. The raster has photons only
        where they are the method."""
        plain = [*ignored(self.mode), *(() if self.is_traced else ("caustics", "photons"))]
        return replace(base, **{name: getattr(Settings(), name) for name in plain} | self.changes)

    def scene(self, scene: Scene) -> Scene:
        """The scene, with the method's own lights if it has some."""
        return scene if self.lights is None else scene.relit(environment=None, lights=(*scene.lights, *self.lights))


PLAIN = Method("ibl", "image-based light", {"environment_shadows": "off", "antialias": "msaa-4"}, quality="draft")
"""What other methods of the raster are compared with."""


@dataclass(frozen=True)
class LeftOut:
    """A method that is not measured, and why."""

    method: str
    reason: str


@dataclass(frozen=True)
class Ladder:
    """`raster` and `traced` in the order in which they are measured, cheapest first."""

    raster: tuple[Method, ...]
    traced: tuple[Method, ...]
    left_out: tuple[LeftOut, ...]


def ladder(scene: Scene, settings: Settings, use_cache: bool = True) -> Ladder:
    """The methods that apply to `scene`. `settings` are the user's, whose mode and options of mode path are ignored."""
    left_out: list[LeftOut] = []
    baked: BakedEnvironment | None = None
    from_environment: tuple[Light, ...] = ()
    if scene.environment is not None:
        baked = bake_environment(scene.environment, settings.ndf, use_cache)
        from_environment = environment_lights(scene.environment, baked)
    raster = [Method("phong", "Phong", {"mode": "phong", "antialias": "none"}),
              Method("phong", "Phong", {"mode": "phong", "antialias": "msaa-4"})]
    if scene.lights or from_environment:
        raster += [Method("lights", "lights only", {"antialias": antialias}, from_environment if baked else None)
                   for antialias in ("none", "msaa-4")]
    else:
        left_out.append(LeftOut("lights only", "the scene has no lights and no environment"))
    media = _in_media(scene, (*scene.lights, *(baked.suns if baked is not None else ())), settings, left_out)
    if baked is not None:
        plain, *others = _with_qualities(_distinct(
            _image_based(scene, (*scene.lights, *baked.suns), settings, left_out)))
        raster += [plain, *media, *others]  # media before what only changes how surfaces look
    else:
        left_out.append(LeftOut(PLAIN.title, "the scene has no environment"))
        raster += media
    raster += _caustics(scene, settings, left_out)
    traced: list[Method] = []
    for spp in SPP:
        traced += _traced(spp, left_out if spp == 1 else [])
    traced += [Method("path-adaptive", "path traced, adaptive", {"mode": "path", "error": error}) for error in TARGETS]
    return Ladder(tuple(raster), tuple(traced), tuple(left_out))


def settings_of(method: Method, base: Settings) -> dict[str, Any]:
    """The mode and all settings of a method that are not the defaults, ready for JSON."""
    settings, default = method.settings(base), Settings()
    return {f.name: _plain(getattr(settings, f.name)) for f in fields(Settings)
            if getattr(settings, f.name) != getattr(default, f.name) or f.name == "mode" or f.name in method.changes}


def _words(name: str, value: object) -> str:
    """How a label names a change of the settings; "" for those that the title implies."""
    if name in ("mode", "denoise") or (name == "environment_shadows" and value == "off"):
        return ""
    if name == "spp":
        return f"{value} sample{'s' * (value != 1)} a pixel"
    if name == "photons":
        return f"{value} photons a pixel"
    if name in ("ambient_occlusion", "caustics", *EFFECTS):
        return ""
    if name == "antialias":
        return "no antialiasing" if value == "none" else str(value).upper().replace("-", " ")
    if name == "environment_shadows":
        return f"{value} lights"
    return f"to an error of {value}" if name == "error" else f"{name.replace('_', '-')} {value}"


def _plain(value: object) -> object:
    return list(value) if isinstance(value, tuple) else value


def _image_based(scene: Scene, lights: Sequence[Light], settings: Settings,
                 left_out: list[LeftOut]) -> Iterator[Method]:
    has_curves = draws_curves(scene, replace(settings, mode="pbr"))
    if not scene.instances:
        left_out.append(LeftOut("other methods of surfaces", "there are none"))
    if not has_curves:
        left_out.append(LeftOut("methods of curves", "there are none"))
        if not scene.instances:
            yield PLAIN
            return
    choices = setting_choices()
    for antialias in sorted(choices["antialias"][1:], key=lambda name: name != PLAIN.changes["antialias"]):
        yield replace(PLAIN, changes={**PLAIN.changes, "antialias": antialias})
    knobs = [*CURVE_KNOBS] * has_curves + [*KNOBS] * bool(scene.instances)
    if any(light.casts_shadow for light in lights):
        knobs.append("shadows")
    else:
        left_out.append(LeftOut(f"{PLAIN.title}, shadows off", "no light casts a shadow"))
    if any(scene.materials[scene.meshes[instance.mesh].material].medium.scatters for instance in scene.instances):
        knobs.append("subsurface")
    for name in knobs:
        for value in choices[name]:
            if value != getattr(settings, name):
                yield replace(PLAIN, changes={**PLAIN.changes, name: value})
    if not scene.instances:
        return
    for antialias in OCCLUDED:
        yield Method("ambient-occlusion", "ambient occlusion", {"ambient_occlusion": "gtao", "antialias": antialias})
    yield from _shadowed(*SHADOWS, SHADOWED)
    yield Method(*ESTIMATED, dict(POINTS["standard"]))
    effects = dict(_effects(scene, lights, settings, left_out))
    for name, value in effects.items():
        yield Method(name, EFFECTS[name][1], {"environment_shadows": "off", name: value, "antialias": "msaa-4"})
    if "indirect" in effects:
        yield from _shadowed("indirect", EFFECTS["indirect"][1], INDIRECT, indirect=effects["indirect"])
    if effects:
        yield from _shadowed("together", "raster with all effects", TOGETHER, **effects)
    yield from _shadowed(*SHADOWS, MANY)


def _distinct(methods: Iterable[Method]) -> list[Method]:
    """Without repetitions: if indirect light is the only effect, "all effects" is the same method."""
    first: dict[frozenset[tuple[str, Any]], Method] = {}
    for method in methods:
        first.setdefault(frozenset(method.changes.items()), method)
    return list(first.values())


def _with_qualities(methods: Sequence[Method]) -> list[Method]:
    """Those that are points of `--quality` get its name: they have all effects of the point that the scene has."""
    tried = {change for method in methods for change in method.changes.items()}
    named: dict[frozenset[tuple[str, Any]], QualityName] = {}
    for quality, point in POINTS.items():
        changes = PLAIN.changes | {name: value for name, value in point.items() if (name, value) in tried}
        named[frozenset(changes.items())] = quality
    return [replace(method, quality=named.get(frozenset(method.changes.items()))) for method in methods]


def _shadowed(name: str, title: str, choices: Mapping[str, Sequence[str]], **changes: Any) -> Iterator[Method]:
    for count, antialiasing in choices.items():
        for antialias in antialiasing:
            yield Method(name, title, {"environment_shadows": count, **changes, "antialias": antialias})


def _effects(scene: Scene, lights: Sequence[Light], settings: Settings,
             left_out: list[LeftOut]) -> Iterator[tuple[str, str]]:
    """Those of EFFECTS that change what is drawn, each with its expensive choice."""

    def draws(**changes: Any) -> object:
        changed = replace(settings, mode="pbr", **changes)
        return plan_scene(scene, changed, lights, samples=1, half_target=True, orthographic=False).draws

    plain = draws(**{name: getattr(Settings(), name) for name in EFFECTS})
    for name, (value, title) in EFFECTS.items():
        if draws(**{other: getattr(Settings(), other) for other in EFFECTS} | {name: value}) != plain:
            yield name, value
        else:
            left_out.append(LeftOut(title, "it changes nothing in this scene"))


def _in_media(scene: Scene, lights: Sequence[Light], settings: Settings, left_out: list[LeftOut]) -> Iterator[Method]:
    """Fog and volumes in several steps."""
    plain = replace(settings, mode="pbr")
    if plan_scene(scene, plain, lights, samples=1, half_target=True, orthographic=False).media is None:
        left_out.append(LeftOut("fog and volumes", "there are none"))
        return
    for scattering, choices in MEDIA.items():
        for steps, rays in choices:
            yield Method("media", "lights and image-based light in media", {
                "environment_shadows": "off", "media_scattering": scattering, "media_steps": steps, "media_rays": rays,
                "antialias": "msaa-4"})


def _caustics(scene: Scene, settings: Settings, left_out: list[LeftOut]) -> Iterator[Method]:
    """Photons on top of the raster, if the reference has them."""
    title = "caustics by photons"
    if settings.caustics != "photons":
        left_out.append(LeftOut(title, "caustics=photons is not set, and the reference is without them, too"))
    elif not (told := plan_lines(scene, replace(settings, mode="pbr")))[0]:
        left_out.append(LeftOut(title, told[1][0].removeprefix(NO_PHOTONS)))
    else:
        for count in PHOTONS:
            yield Method("caustics", title, {"environment_shadows": "off", "antialias": "msaa-4", "caustics": "photons",
                                             "photons": count})


def _traced(spp: int, left_out: list[LeftOut]) -> Iterator[Method]:
    yield Method("path", "path traced", {"mode": "path", "spp": spp})
    yield Method("path+fast", "path traced, denoised", {"mode": "path", "spp": spp, "denoise": "fast"})
    yield Method("path+raster", "path traced, mixed with the raster", {"mode": "path", "spp": spp, "denoise": "raster"})
    if find_spec("pyoidn") is not None:
        yield Method("path+oidn", "path traced, OIDN", {"mode": "path", "spp": spp, "denoise": "oidn"})
    else:
        left_out.append(LeftOut("path traced, OIDN", "it is not installed (pip install 'pbr-viewer[oidn]')"))
