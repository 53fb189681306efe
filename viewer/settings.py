"""The settings of a render. A picture is a function of (scene, camera, settings, size) only."""

from __future__ import annotations

import math
import re
from collections.abc import Collection
from dataclasses import dataclass, field, fields, replace
from functools import cache
from typing import Any, Literal, get_args, get_type_hints

from .errors import UsageError
from .ranges import Range, Several, WeaveName

Mode = Literal["pbr", "phong", "path"]
Denoise = Literal["off", "fast", "raster", "oidn"]
Lobes = Literal["all", "uniform-diffuse", "specular", "directional-diffuse"]
Tonemap = Literal["neutral", "agx", "aces", "none"]
Background = Literal["env", "none"] | tuple[float, float, float]
Ndf = Literal["ggx", "beckmann", "blinn-phong"]
Show = Literal["shaded", "base-color", "normal", "geometric-normal", "roughness", "metalness", "uv", "depth",
               "overdraw", "wireframe"]
Masking = Literal["smith", "smith-separable", "v-cavity", "none"]

NDFS: tuple[Ndf, ...] = get_args(Ndf)
"""In the order of the shaders' switch NDF."""
MASKINGS: tuple[Masking, ...] = get_args(Masking)
"""In the order of the shaders' switch MASKING."""
VALUES: tuple[Show, ...] = get_args(Show)[1:-1]
"""The views of one quantity in place of the shading, in the order of the shaders' switch SHOW."""
SURFACE_LAYERS = ("albedo", "normal", "depth", "position", "instance", "material", "motion", "uv")
"""The layers that say what surface a pixel shows; see docs/layers.md."""
PATH_LAYERS = ("variance", "samples")
"""Those that only mode path has."""
LAYERS = (*SURFACE_LAYERS, *PATH_LAYERS)
MAX_EXPOSURE = 64.0
"""In EV. 2**64 times the largest half float still fits in a float32."""
DEFAULT_SPP = 64
LEAST_DEFERRED = (512, 512)
"""The least picture of which antialias=auto defers shading."""
TELL_ERROR_S = 5.0
"""Seconds of path tracing for the error of a picture of the raster."""
MAX_SPP = 1 << 16
"""The error of a float32 sum of so many samples is at most 0.4 %, even if all are rounded in the same direction."""

_ALL: tuple[Mode, ...] = get_args(Mode)
_PBR: tuple[Mode, ...] = ("pbr",)
_PHONG: tuple[Mode, ...] = ("phong",)
_PATH: tuple[Mode, ...] = ("path",)
_REAL_TIME: tuple[Mode, ...] = ("pbr", "phong")
_PHYSICAL: tuple[Mode, ...] = ("pbr", "path")

_Value = str | float | tuple[float, ...] | None


def _option(default: _Value, meaning: str, values: Range | None = None, modes: tuple[Mode, ...] = _ALL) -> Any:
    """A setting of `--set`: its meaning, its values where it has no choices, and the modes that use it."""
    return field(default=default, metadata={"meaning": meaning, "values": values, "modes": modes})


def _own_option(default: _Value, values: Range | None = None, modes: tuple[Mode, ...] = _ALL) -> Any:
    """Likewise a setting that is not in `--set`, but has an option of its own."""
    return field(default=default, metadata={"values": values, "modes": modes})


@dataclass(frozen=True)
class Settings:
    """All settings of a render. The fields below `# --set` can be set on the command line by `--set NAME=VALUE`."""

    mode: Mode = "pbr"
    background: Background = "env"
    """The environment, nothing (alpha 0), or a colour in linear Rec. 709.

    Exposure and tone map do not change a background colour."""
    exposure: float = _own_option(0.0, Range(-MAX_EXPOSURE, MAX_EXPOSURE))
    """In EV: radiance is multiplied by 2**exposure before the tone map."""
    tonemap: Tonemap = "neutral"
    ground: Literal["off", "shadow"] = "off"
    """Shadow: the shadow of the model on the ground below it darkens what is behind."""

    # For mode path, which stops when the first of spp, time_budget and error is reached; if none is given, at 64 spp.
    spp: int | None = _own_option(None, Range(1, MAX_SPP, is_whole=True), modes=_PATH)
    """Samples per pixel. If a time budget or error is given, the most samples per pixel, on average."""
    time_budget: float | None = _own_option(None, Range(0.01, 1e6), modes=_PATH)
    """In seconds, for one picture, including its preparation."""
    error: float | None = _own_option(None, Range(1e-5, 1.0), modes=_PATH)
    """The relative error to reach, which is estimated from the samples."""
    seed: int = _own_option(0, Range(0, (1 << 32) - 1, is_whole=True), modes=_PATH)
    """The seed of the random numbers."""
    denoise: Denoise = _own_option("off", modes=_PATH)

    # --set
    ndf: Ndf = _option("ggx", "distribution of microfacet normals, D", modes=_PHYSICAL)
    masking: Masking = _option(
        "smith", "masking and shadowing of microfacets, G; smith: height-correlated", modes=_PHYSICAL)
    fresnel: Literal["schlick", "exact"] = _option("schlick", "Fresnel reflectance, F", modes=_PHYSICAL)
    multiscatter: Literal["on", "off"] = _option(
        "on", "energy compensation for multiple scattering between microfacets", modes=_PHYSICAL)
    sheen: Literal["charlie", "zeltner"] = _option(
        "charlie", "lobe of the fibres of a sheen; charlie: that of KHR_materials_sheen; zeltner: with light that is "
        "scattered several times between them", modes=_PHYSICAL)
    weave: str = _option(
        "off", "show the model, or one of its materials, as woven cloth along its texture coordinates: plain, twill, "
        "satin, denim, or a weave of your own", WeaveName(), modes=_PHYSICAL)
    lobes: Lobes = _option("all", "show one contribution alone")
    show: Show = _option(
        "shaded", "show one quantity of the surfaces instead of the shaded picture, without exposure and tone map, for "
        "teaching and debugging; overdraw: the number of fragments drawn in each pixel; wireframe: the shaded "
        "picture with the edges of triangles (docs/views.md)", modes=_REAL_TIME)
    grid: Literal["off", "on"] = _option(
        "off", "a grid on the ground below the model, with a power of ten as the distance between lines, and the axes "
        "of the world: x red, y green, z blue", modes=_REAL_TIME)
    phong: Literal["phong", "blinn-phong"] = _option("phong", "the highlight of --mode phong", modes=_PHONG)
    shadows: Literal["on", "off"] = _option("on", "shadows of the lights", modes=_REAL_TIME)
    environment_shadows: Literal["off", "16", "64", "256", "1024"] = _option(
        "off", "shadows of the environment, computed with this number of directional lights sampled from "
               "it", modes=_PBR)
    ambient_occlusion: Literal["off", "gtao"] = _option(
        "off", "ambient occlusion computed from the depth buffer; no effect together with environment-shadows",
        modes=_PBR)
    indirect: Literal["off", "estimated", "baked"] = _option(
        "off", "indirect light from other surfaces; estimated: a surface that blocks a light of environment-shadows is "
        "taken to reflect light with the mean colour of all surfaces; baked: path traced once at the "
        "vertices", modes=_PBR)
    reflections: Literal["environment", "traced"] = _option(
        "environment", "what surfaces reflect; traced: also the model itself, by rays from each shaded point",
        modes=_PBR)
    refraction: Literal["screen", "traced"] = _option(
        "screen", "refraction in solid glass: in screen space, or traced by two paths from each shaded point",
        modes=_PBR)
    subsurface: Literal["off", "slab", "screen"] = _option(
        "screen", "subsurface scattering in solids; slab: computed at each point alone, from the thickness behind it; "
        "screen: also spread over the surface, by a diffusion profile in screen space", modes=_PBR)
    specular_aa: Literal["on", "off"] = _option(
        "off", "specular antialiasing of the environment: blur reflections that are smaller than a pixel, which "
        "flickers less but is less exact; highlights of lights are always averaged over their pixels", modes=_PBR)
    background_blur: float = _option(
        0.0, "blur of the environment as background: standard deviation of a Gaussian in degrees; 0: none",
        Range(0.0, 90.0))
    volume_density: float = _option(
        1.0, "volume files: extinction coefficient per unit of length where the file's density is 1", Range(0.0, 1e18))
    volume_albedo: tuple[float, float, float] = _option(
        (0.9, 0.9, 0.9), "volume files: single-scattering albedo, the share of the extinction that is scattering",
        Several(0.0, 1.0))
    volume_g: float = _option(
        0.0, "volume files: mean cosine of the Henyey-Greenstein phase function; above 0: forwards", Range(-0.99, 0.99))
    volume_droplets: float = _option(
        0.0, "volume files: diameter of droplets of water in micrometres, 5 to 50, whose phase function replaces "
        "volume-g; 0: none", Range(5.0, 50.0, or_zero=True))
    volume_emission: tuple[float, float, float] = _option(
        (0.0, 0.0, 0.0), "volume files: emitted radiance per unit of length where the file's density is 1",
        Several(0.0, 1e9))
    fog: float = _option(
        0.0, "fog around the scene: extinction coefficient per unit of length; 0: none", Range(0.0, 1e18))
    fog_albedo: tuple[float, float, float] = _option(
        (1.0, 1.0, 1.0), "single-scattering albedo of the fog: the share of the extinction that is scattering",
        Several(0.0, 1.0))
    fog_g: float = _option(
        0.0, "mean cosine of the fog's Henyey-Greenstein phase function; above 0: forwards", Range(-0.99, 0.99))
    fog_droplets: float = _option(
        0.0, "diameter of droplets of water in the fog in micrometres, 5 to 50, whose phase function replaces fog-g; "
        "0: none", Range(5.0, 50.0, or_zero=True))
    fog_height: float = _option(
        0.0, "scale height of the fog: above the lowest point of the scene, its density falls by a factor of e over "
        "this length; 0: constant density", Range(0.0, 1e18))
    curve_radius: float = _option(
        0.0, "radius of all curves, in the scene's unit of length; 0: those of the file", Range(0.0, 1e9))
    hair_melanin: tuple[float, float] | None = _option(
        None, "curves: eumelanin (black, brown) and pheomelanin (yellow, red) of hair; none: the colours of the file, "
        "or 1.3,0 if it has none", Several(0.0, 1e3, names="EU,PHEO", or_none=True))
    hair_color: tuple[float, float, float] | None = _option(
        None, "curves: the colour of many fibres together; replaces hair-melanin", Several(0.0, 1.0, or_none=True))
    hair_absorption: tuple[float, float, float] | None = _option(
        None, "curves: absorption coefficient of a fibre whose radius is 1; replaces hair-melanin",
        Several(0.0, 1e4, or_none=True))
    hair_roughness: tuple[float, float] = _option(
        (0.3, 0.3), "curves: longitudinal and azimuthal roughness of the fibres", Several(0.0, 1.0, names="BM,BN"))
    hair_tilt: float = _option(
        2.0, "curves: tilt of the fibres' scales in degrees; above 0, the first highlight moves towards the tip, "
        "as in Mitsuba and pbrt; below 0 towards the root, as on real hair", Range(-45.0, 45.0), modes=_PHYSICAL)
    hair_scattering: Literal["single", "multiple"] = _option(
        "multiple", "curves: single scattering, or also light from fibre to fibre, by a diffusion equation",
        modes=_PBR)
    hair_ior: float = _option(1.55, "curves: index of refraction of the fibres", Range(1.0, 3.0))
    yarn: Literal["off", "cotton", "wool", "silk"] = _option(
        "off", "curves: show each curve as a yarn of plies and fibres, with the radius of the curve", modes=_PHYSICAL)
    yarn_plies: int | None = _option(
        None, "number of plies of a yarn; none: that of its kind",
        Range(1, 8, is_whole=True, or_none=True), modes=_PHYSICAL)
    yarn_fibres: int | None = _option(
        None, "number of fibres of a ply; none: that of the kind of yarn",
        Range(1, 4096, is_whole=True, or_none=True), modes=_PHYSICAL)
    yarn_twist: float | None = _option(
        None, "angle between plies and yarn in degrees; above 0, a right-handed screw; none: that of the kind of yarn",
        Range(-60.0, 60.0, or_none=True), modes=_PHYSICAL)
    yarn_hairs: float | None = _option(
        None, "number of loose fibres per length of one radius of the yarn; none: that of its kind",
        Range(0.0, 100.0, or_none=True), modes=_PATH)
    media_steps: Literal["auto", "28", "56", "112", "224"] = _option(
        "auto", "steps of a ray through fog and volumes; auto: 56, but 28 while the camera moves and the CPU renders",
        modes=_REAL_TIME)
    media_rays: Literal["auto", "all", "quarter", "ninth", "sixteenth"] = _option(
        "auto", "the share of pixels with their own ray through fog and volumes; auto: a quarter, but a sixteenth "
        "while the camera moves and the CPU renders", modes=_REAL_TIME)
    media_scattering: Literal["single", "multiple"] = _option(
        "multiple", "fog and volumes: single scattering, or also multiple scattering, by a diffusion equation",
        modes=_REAL_TIME)
    antialias: Literal["auto", "none", "msaa-2", "msaa-4", "msaa-8", "deferred-4", "ssaa-4", "ssaa-9", "ssaa-16"] = (
        _option("auto", "samples per pixel. msaa shades once for each triangle in a pixel, deferred for at most two "
                "surfaces, ssaa each sample. auto: msaa-4. If the CPU renders: none while the camera moves, deferred-4 "
                "from 512x512 pixels on, and ssaa-4 for curves, woven cloth and indirect=baked",
                modes=_REAL_TIME))
    plan: Literal["needed", "everything"] = _option(
        "needed", "everything: also compile and upload what is not needed, to measure what the plan saves; the picture "
        "is the same")
    sampling: Literal["mis", "bsdf", "lights"] = _option(
        "mis", "mode path: sample the BSDF, the lights, or both (mis: multiple importance sampling)", modes=_PATH)
    bounces: int = _option(
        32, "mode path: the maximum number of reflections and refractions of a path",
        Range(1, 255, is_whole=True), modes=_PATH)
    light_radius: float = _option(
        0.0, "mode path: radius of point and spot lights, in the scene's unit", Range(0.0, 1e9), modes=_PATH)
    caustics: Literal["off", "photons"] = _option(
        "off", "caustics of point, spot and directional lights, thrown by smooth glass and mirrors, with photons from "
        "the lights; in mode path as many photons as camera paths", modes=_PHYSICAL)
    photons: int = _option(16, "mode pbr: photons per pixel, for "
                               "caustics", Range(1, MAX_SPP, is_whole=True), modes=_PBR)
    clamp: float = _option(
        0.0, "mode path: maximum luminance of an indirect sample, which removes bright noise but loses light; 0: none",
        Range(0.0, 1e9), modes=_PATH)

    def __post_init__(self) -> None:
        given = [name for name in HAIR_COLORS if getattr(self, name) is not None]
        if len(given) > 1:
            raise UsageError(f"{' and '.join(given)}: only one of them says what colour hair has")

    @classmethod
    def of(cls, **values: Any) -> Settings:
        """Settings with the given fields; the others have their defaults. The background may be "#rrggbb" (sRGB).

        Raises UsageError for a field that does not exist or a value that it cannot have.
        """
        names = [f.name for f in fields(cls)]
        choices = setting_choices() | {"mode": get_args(Mode), "tonemap": get_args(Tonemap),
                                       "denoise": get_args(Denoise)}
        for name, value in values.items():
            if name not in names:
                raise UsageError(f"there is no setting {name!r}; choose from {', '.join(names)}")
            if name in choices and value not in choices[name]:
                raise UsageError(f"{name}={value!r}: {name} must be one of {', '.join(choices[name])}")
        if "background" in values:
            values["background"] = parse_background(values["background"])
        for name in values.keys() & RANGES.keys():
            if values[name] is not None or name not in STOPPING:
                values[name] = RANGES[name].number(values[name], f"{name}={values[name]!r}: it")
        return cls(**values)

    def check_used(self) -> None:
        """Raises UsageError if a setting that this mode ignores does not have its default."""
        ignored_names = ignored(self.mode)
        unused = [f.name for f in fields(self) if f.name in ignored_names and getattr(self, f.name) != f.default]
        if unused:
            verb = "has" if len(unused) == 1 else "have"
            modes = [mode for mode in get_args(Mode) if not set(unused) & set(ignored(mode))]
            where = f", only in mode{'s' * (len(modes) > 1)} {' and '.join(modes)}" if modes else ""
            raise UsageError(f"{' and '.join(unused)} {verb} no effect in mode {self.mode}{where}")

    @property
    def shows_values(self) -> bool:
        """Whether the picture is of a quantity of the surfaces, which no light, exposure or tone map changes."""
        return self.show in VALUES

    def check_ground(self) -> None:
        """Raises UsageError if there is a shadow on the ground in a picture whose samples are budgeted."""
        if self.ground != "off" and not (self.time_budget is None and self.error is None):
            raise UsageError(f"ground={self.ground} cannot be used with a time budget or an error to reach, which do "
                             "not count the samples of the shadow; choose spp")

    def check_told(self, what: str) -> None:
        """Raises UsageError if `what`, which compares a picture with a path-traced one, would count as wrong what no
        path-traced picture shows."""
        if self.ground != "off":
            raise UsageError(f"{what} does not know the shadow of the model on the ground: leave out "
                             f"ground={self.ground}")
        for name in ("show", "grid"):
            value = getattr(self, name)
            if value != getattr(Settings, name):
                raise UsageError(f"{what} is for shaded pictures without a grid: leave out {name}={value}")

    def check_layers(self, names: Collection[str]) -> None:
        """Raises UsageError for layers that this mode does not have."""
        lost = [name for name in names if name in PATH_LAYERS]
        if lost and self.mode != "path":
            raise UsageError(f"the layer{'s' * (len(lost) > 1)} {' and '.join(lost)}: only mode path has samples, not "
                             f"mode {self.mode}")

    @property
    def is_used(self) -> bool:
        """Whether `check_used` raises no error."""
        try:
            self.check_used()
        except UsageError:
            return False
        return True

    def check_open(self) -> tuple[Settings | None, Settings | None]:
        """These settings in mode pbr and in mode path, for choosing between them; None for a mode that ignores some.

        Raises UsageError if both modes ignore some of them, or for what only a picture of mode path has. Photons are
        left to mode path, too: what they cost the raster is not known.
        """
        if self.denoise == "raster":
            raise UsageError("denoise raster is for mode path: give that mode")
        for name in ("show", "grid"):
            if getattr(self, name) != getattr(Settings, name):
                raise UsageError(f"{name} has no effect on how a method is chosen: leave out the time budget and the "
                                 "error")
        modes = replace(self, mode="pbr", time_budget=None, error=None), replace(self, mode="path")
        usable = [settings if settings.is_used else None for settings in modes]
        if self.caustics == "photons":
            usable[0] = None
        if usable == [None, None]:
            raise UsageError("neither mode pbr nor mode path uses all of these settings: give a mode")
        return usable[0], usable[1]

    @property
    def is_adaptive(self) -> bool:
        """Whether pixels get different numbers of samples in mode path, by their noise."""
        return self.error is not None or self.time_budget is not None

    @property
    def most_spp(self) -> int:
        """The maximum number of samples per pixel in mode path, of all pixels on average."""
        if self.spp is not None:
            return self.spp
        return DEFAULT_SPP if self.time_budget is None and self.error is None else MAX_SPP

    def samples(self, is_software: bool, is_still: bool) -> int:
        """Samples per pixel (MSAA) on a software or hardware device, for a still picture or a moving camera."""
        if self.antialias == "auto":
            return 1 if is_software and not is_still else 4
        return int(self.antialias.rpartition("-")[2]) if self.antialias.startswith(("msaa", "deferred")) else 1

    def defers(self, is_software: bool, is_still: bool, size: tuple[int, int] = LEAST_DEFERRED) -> bool:
        """Whether opaque surfaces are shaded after all triangles are drawn; of a moving picture or not, as `samples`.

        A graphics card multisamples at little cost. What a CPU shades anew for each triangle costs it about as much as
        the first time. In smaller pictures more than two surfaces often meet in a pixel: the mean FLIP to multisampling
        would be above 0.005.
        """
        is_large = size[0] * size[1] >= LEAST_DEFERRED[0] * LEAST_DEFERRED[1]
        return self.antialias == "deferred-4" or (self.antialias == "auto" and is_software and is_still and is_large)

    def media_rays_and_steps(self, is_software: bool, is_still: bool) -> tuple[str, int]:
        """The pixels that have a ray through fog and volumes, and its steps, as `samples` has those of a pixel."""
        rays, steps = ("sixteenth", "28") if is_software and not is_still else ("quarter", "56")
        return (rays if self.media_rays == "auto" else self.media_rays,
                int(steps if self.media_steps == "auto" else self.media_steps))

    @property
    def supersampling(self) -> int:
        """The number of shaded points along each side of a pixel (SSAA)."""
        return math.isqrt(int(self.antialias[5:])) if self.antialias.startswith("ssaa") else 1

    def with_option(self, assignment: str) -> Settings:
        """A copy with one `NAME=VALUE` of `--set` applied. The name may have dashes instead of underscores.

        Raises UsageError for a name or value that does not exist.
        """
        name, value = setting_name(assignment), assignment.partition("=")[2]
        choices = setting_choices()
        if name not in setting_meanings():
            raise UsageError(f"--set {assignment}: there is no setting {name!r}; choose from "
                             f"{', '.join(setting_meanings())}")
        if name in RANGES:
            change: dict[str, Any] = {name: RANGES[name].number(value, f"--set {assignment}: {name}")}
        elif value in choices[name]:
            change = {name: value}
        else:
            raise UsageError(f"--set {assignment}: {name} must be one of {', '.join(choices[name])}")
        return replace(self, **change)


HAIR_COLORS = ("hair_melanin", "hair_color", "hair_absorption")
"""The settings of which one may say what colour hair has."""
STOPPING = ("spp", "time_budget", "error")
"""The settings that end a path-traced picture."""
RANGES: dict[str, Range] = {f.name: f.metadata["values"] for f in fields(Settings) if f.metadata.get("values")}
"""The values of the settings without a list of choices."""


@cache
def ignored(*modes: Mode) -> tuple[str, ...]:
    """The settings that none of `modes` uses."""
    return tuple(f.name for f in fields(Settings) if not set(f.metadata.get("modes", _ALL)) & set(modes))


def setting_name(assignment: str) -> str:
    """The field of `Settings` that a `NAME=VALUE` of `--set` names."""
    return assignment.partition("=")[0].strip().replace("-", "_")


def with_dashes(text: str) -> str:
    """`text` with the names of settings as the command line documents them: hair-melanin for hair_melanin. What was
    typed (hair_melanin=2, 'hair_melanin') stays, and so do names within paths."""
    names = "|".join(f.name for f in fields(Settings) if "_" in f.name)
    return re.sub(rf"(?<![\w./\\'\"-])({names})(?![\w=/\\'\"-]|\.\w)", lambda m: m[0].replace("_", "-"), text)


def parse_background(value: object) -> Background:
    """A value of `Settings.background` from "env", "none", "#rrggbb" (sRGB) or linear (r, g, b).

    Raises UsageError for anything else.
    """
    if isinstance(value, str) and value in ("env", "none"):
        return value  # type: ignore[return-value]
    if isinstance(value, str) and re.fullmatch("#?[0-9a-fA-F]{6}", value):
        import numpy as np

        from .scene.color import srgb_to_linear

        code = np.frombuffer(bytes.fromhex(value.removeprefix("#")), np.uint8)
        red, green, blue = srgb_to_linear(code / 255).tolist()
        return red, green, blue
    if isinstance(value, (tuple, list)) and len(value) == 3:
        red, green, blue = (Range(0, 1).number(part, f"background={part!r}: it") for part in value)
        return red, green, blue
    raise UsageError(f"background={value!r}: it must be env, none, #rrggbb or three linear numbers from 0 to 1")


@cache
def setting_choices() -> dict[str, tuple[str, ...]]:
    """The `--set` settings with choices, each with its allowed values. Numbers are in `RANGES`."""
    hints = get_type_hints(Settings)
    return {name: get_args(hints[name]) for name in setting_meanings() if name not in RANGES}


def setting_meanings() -> dict[str, str]:
    """The names and meanings of the `--set` settings, in the order in which they are documented."""
    return {f.name: f.metadata["meaning"] for f in fields(Settings) if "meaning" in f.metadata}
