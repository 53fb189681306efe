"""The options that several commands of the command line share, and the types of their values.

Nothing slow is imported here, so that `--help` and errors about options appear at once.
"""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Sequence
from typing import Any, get_args

import click

from ..errors import UsageError
from ..quality import AUTO, QUALITIES
from ..settings import (
    DEFAULT_SPP,
    LAYERS,
    MAX_EXPOSURE,
    PATH_LAYERS,
    RANGES,
    SURFACE_LAYERS,
    TELL_ERROR_S,
    Background,
    Denoise,
    Mode,
    parse_background,
)

MAX_NUMBER = 1e18
"""The largest number of metres or lux. Models have no larger coordinates, and its square still fits in a float32."""


class Number(click.ParamType):
    """A finite number from `low` to `high`, both included. `hint` is added to the error for what is no number."""

    name = "number"

    def __init__(self, low: float = -math.inf, high: float = math.inf, hint: str = "") -> None:
        self.low, self.high, self.hint = low, high, hint

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> float:
        try:
            number = float(value)
        except ValueError:
            number = math.nan
        if not math.isfinite(number):
            self.fail(f"{value!r} is not a number{self.hint}.", param, ctx)
        if not self.low <= number <= self.high:
            self.fail(f"{value} is not from {self.low:g} to {self.high:g}.", param, ctx)
        return number


class Whole(click.ParamType):
    """A whole number from `low` to `high`, both included."""

    name = "whole number"

    def __init__(self, low: int, high: int) -> None:
        self.low, self.high = low, high

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> int:
        try:
            number = int(value)
        except ValueError:
            self.fail(f"{value!r} is not a whole number.", param, ctx)
        if not self.low <= number <= self.high:
            self.fail(f"{value} is not from {self.low} to {self.high}.", param, ctx)
        return number


class Numbers(click.ParamType):
    """Numbers separated by commas. Their count must be one of `counts`; `check` returns a problem with them, or ""."""

    name = "numbers"

    def __init__(self, form: str, *counts: int, check: Callable[[tuple[float, ...]], str] | None = None) -> None:
        self.form, self.counts, self.check = form, counts, check

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> tuple[float, ...]:
        try:
            numbers = tuple(float(part) for part in value.split(","))
        except ValueError:
            numbers = ()
        if len(numbers) not in self.counts or not all(map(math.isfinite, numbers)):
            self.fail(f"{value!r} is not {self.form}, numbers separated by commas.", param, ctx)
        if max(map(abs, numbers)) > MAX_NUMBER:
            self.fail(f"{value!r} has a number beyond {MAX_NUMBER:g}.", param, ctx)
        problem = self.check(numbers) if self.check else ""
        if problem:
            self.fail(problem, param, ctx)
        return numbers

    def get_metavar(self, param: click.Parameter, ctx: click.Context | None = None) -> str:
        return self.form


class Size(click.ParamType):
    """A size WxH in pixels, or one number for a square."""

    name = "size"

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> tuple[int, int]:
        match = re.fullmatch(r"([0-9]+)(?:[xX]([0-9]+))?", value)
        if not match or not all(n.strip("0") for n in match.groups() if n):
            self.fail(f"{value!r} is not WxH, such as 1280x720, or one number for a square.", param, ctx)
        if max(len(n.lstrip("0")) for n in match.groups() if n) > 6:
            self.fail(f"{value!r} has a side beyond 999999 pixels.", param, ctx)
        return int(match[1]), int(match[2] or match[1])

    def get_metavar(self, param: click.Parameter, ctx: click.Context | None = None) -> str:
        return "WxH"


class BackgroundColor(click.ParamType):
    """env, none or #rrggbb (sRGB), converted to a value of Settings.background."""

    name = "background"

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> Background:
        try:
            return parse_background(value)
        except UsageError:
            self.fail(f"{value!r} is not env, none or #rrggbb.", param, ctx)

    def get_metavar(self, param: click.Parameter, ctx: click.Context | None = None) -> str:
        return "env|none|#rrggbb"


class PlainMaterial(click.ParamType):
    """COLOR[,METALLIC[,ROUGHNESS]], as the text of all three with the colour as #rrggbb."""

    name = "material"

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> Any:
        from PIL import ImageColor

        color, *words = value.split(",")
        try:
            rgb: Any = ImageColor.getrgb(color.strip())
            numbers = [float(word) for word in words]
        except ValueError:
            rgb, numbers = None, []
        if rgb is None or len(rgb) != 3 or len(words) > 2 or not all(0 <= number <= 1 for number in numbers):
            self.fail(f"{value!r} is not {self.get_metavar(None)}: a name such as gold, or #rrggbb, and numbers from 0 "
                      "to 1.", param, ctx)
        metallic, roughness = (*numbers, *(0.0, 0.5)[len(numbers):])
        return f"#{bytes(rgb).hex()},{metallic:g},{roughness:g}"

    def get_metavar(self, param: click.Parameter | None, ctx: click.Context | None = None) -> str:
        return "COLOR[,METALLIC[,ROUGHNESS]]"


class Layers(click.ParamType):
    """Names of layers separated by commas, as a tuple without repetitions."""

    name = "layers"

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> tuple[str, ...]:
        names = value.split(",") if isinstance(value, str) else value
        unknown = [name for name in names if name not in LAYERS]
        if unknown:
            self.fail(f"there is no layer {unknown[0]!r}; choose from {', '.join(LAYERS)}.", param, ctx)
        return tuple(dict.fromkeys(names))

    def get_metavar(self, param: click.Parameter, ctx: click.Context | None = None) -> str:
        return "NAME,..."


def _light_problem(light: tuple[float, ...]) -> str:
    return f"{light[2]:g} lux is negative." if light[2] < 0 else ""


def _ends(name: str) -> tuple[Any, Any]:
    return RANGES[name].low, RANGES[name].high


MODE_OPTION = click.option(
    "--mode", type=click.Choice(get_args(Mode)), default="pbr", show_default=True,
    help="pbr: physically based shading; phong: Phong's model; path: path tracing, exact but slow.")
QUALITY_OPTION = click.option(
    "--quality", type=click.Choice([AUTO, *QUALITIES]),
    help="Mode pbr: trade time against error. draft: image-based light only; standard: also shadows of the "
         "environment; high: also indirect light and traced rays, which take seconds to prepare. auto, the default: "
         "standard if its first picture is estimated to take at most twice the time of a draft, otherwise draft. "
         "Settings that --set names keep their values.")
LOOK_OPTIONS = [
    click.option("--env", default="studio", metavar="FILE|NAME|none", show_default=True,
                 help="The environment that lights the model: a panorama (.hdr, .exr, .png, .jpg), or studio, sky, "
                      "furnace, none."),
    click.option("--env-rotation", type=Number(), default=0.0, metavar="DEG",
                 help="Rotate the environment about the vertical axis, counter-clockwise seen from above."),
    click.option("--env-intensity", type=Number(0, 1e6), default=1.0, metavar="X",
                 help="Multiply the light of the environment."),
    click.option("--background", type=BackgroundColor(), default="env", show_default=True,
                 help="What is behind the model: the environment, nothing (alpha 0), or a colour. Exposure and tone "
                      "map do not change the colour; an .exr stores it as linear light."),
    click.option("--exposure", type=Number(-MAX_EXPOSURE, MAX_EXPOSURE), default=0.0, metavar="EV",
                 help="Make the picture 2^EV times as bright. An .exr is not changed."),
    click.option("--tonemap", type=click.Choice(["neutral", "agx", "aces", "none"]), default="neutral",
                 show_default=True, help="The tone map, which compresses bright light to the range of a screen."),
    click.option("--light", "lights", type=Numbers("AZ,EL,LUX", 3, check=_light_problem), multiple=True,
                 help="Add a directional light that shines from this azimuth and elevation (degrees) with this many "
                      "lux; can be repeated. A white surface that faces a light of 3.14 lux has radiance 1; 1000 lux "
                      "need an --exposure of -8."),
    click.option("--set", "assignments", multiple=True, metavar="NAME=VALUE",
                 help="Change any other setting; can be repeated. `pbr-viewer info --settings` lists the settings."),
]
MODEL_OPTIONS = [
    click.option("--with", "with_files", multiple=True, metavar="FILE",
                 help="Add another model or volume to the picture, in the same coordinate system; can be repeated. "
                      "It is not animated: --animation and --variant refer to MODEL."),
    click.option("--variant", metavar="NAME", help="Show this variant of the materials; `pbr-viewer info` lists the "
                                                   "variants. Default: the materials of the file."),
    click.option("--scene", metavar="N|NAME", help="Show this scene of a glTF file, by its number, counted from 0, or "
                                                   "by its name. Default: the file's default scene."),
    click.option("--up", type=click.Choice(["x", "y", "z", "-x", "-y", "-z"]), default="y", show_default=True,
                 help="The axis of the file that points upwards, often z in files from CAD and for 3D printing. The "
                      "model is turned so that this axis becomes +Y. All coordinates and angles are those after the "
                      "turn."),
    click.option("--material", type=PlainMaterial(),
                 help="Replace all materials and vertex colours by one material. COLOR is a CSS colour name, such as "
                      "gold, or #rrggbb. METALLIC is 0 and ROUGHNESS 0.5 by default."),
]
SCENE_OPTIONS = [MODE_OPTION, QUALITY_OPTION, *MODEL_OPTIONS, *LOOK_OPTIONS]
TIME_OPTIONS = [
    click.option("--animation", metavar="NAME|N", help="The animation to show, by its name or its number, counted from "
                                                       "0; `pbr-viewer info` lists them. Default: 0 with --time."),
    click.option("--time", type=Number(0, 1e9), metavar="SECONDS",
                 help="Show the animation at this time; default: 0 with --animation, else the model at rest."),
]
PATH_OPTIONS = [
    click.option("--spp", type=Whole(*_ends("spp")), metavar="N",
                 help=f"Mode path: samples per pixel; default: {DEFAULT_SPP}. With --time-budget or --error it is the "
                      "largest mean number of samples per pixel; default: unlimited."),
    click.option("--time-budget", type=Number(*_ends("time_budget")), metavar="SECONDS",
                 help="Make the best picture within this time. Both renderers are tried; with --mode path, path "
                      "tracing only."),
    click.option("--error", type=Number(*_ends("error")), metavar="TARGET",
                 help="Make a picture with at most this relative error (0.02 is 2 %) in little time. Both "
                      "renderers are tried; with --mode path, path tracing only. The error is an estimate."),
    click.option("--seed", type=Whole(*_ends("seed")), default=0, metavar="N",
                 help="Mode path: the seed of the random numbers; the same N gives the same noise."),
    click.option("--denoise", type=click.Choice(get_args(Denoise)), default="off", show_default=True,
                 help="Mode path: remove noise, which also blurs some detail. fast: a wavelet filter; raster: mixes in "
                      "a picture of mode pbr where that one is closer to the correct picture; oidn: Intel Open Image "
                      "Denoise, an optional dependency."),
]
ERROR_OPTIONS = [
    click.option("--tell-error", is_flag=False, flag_value=TELL_ERROR_S,
                 type=Number(*_ends("time_budget"), hint="; a MODEL after it needs --tell-error=SECONDS"),
                 metavar="[SECONDS]",
                 help="Print the error of a picture of mode pbr or phong, as measured by this many seconds of path "
                      f"tracing; default: {TELL_ERROR_S:g}. Write `--tell-error=SECONDS` if a MODEL follows."),
    click.option("--error-map", metavar="FILE",
                 help="With --tell-error: write a map of the error. An .exr holds the relative error; a .png is black "
                      "at 0 and pale at 100 %. For several models: a folder or a pattern, as for -o."),
]
GROUND_OPTION = click.option(
    "--ground", type=click.Choice(["off", "shadow"]), default="off", show_default=True,
    help="shadow: show the shadow that the model casts on a plane below it. It darkens the background; with "
         "--background none the shadow is stored in alpha.")
AOV_OPTION = click.option("--aov", type=Layers(), default=(), help=(
    f"Add layers with numbers for each pixel to the .exr or .npz: {', '.join(SURFACE_LAYERS)}; in mode path also "
    f"{', '.join(PATH_LAYERS)}. Motion is in pixels to the next frame of --animation or --turntable."))
FILM_OPTIONS = [
    click.option("--turntable", type=Whole(1, 36_000), metavar="FRAMES",
                 help="Film: turn once around the model in this number of frames."),
    click.option("--fps", type=Number(0.01, 1000), metavar="N", help="Film: frames per second. Default: 25."),
]
QUIET_OPTION = click.option("-q", "--quiet", is_flag=True, help="Show no warnings and no progress bar.")
NO_CACHE_OPTION = click.option("--no-cache", is_flag=True,
                               help="Neither read nor write the cache on disk (`pbr-viewer cache`).")
BACKEND_OPTION = click.option("--backend", type=click.Choice(["auto", "egl", "osmesa", "window"]), default="auto",
                              show_default=True, help="How to open OpenGL; `pbr-viewer doctor` shows what works here.")


def size_option(default: str) -> Callable[[Any], Any]:
    return click.option("--size", type=Size(), default=default, show_default=True,
                        help="Size in pixels; one number means a square.")


COMMON_OPTIONS = [
    size_option("1280x720"),
    NO_CACHE_OPTION,
    QUIET_OPTION,
    click.option("-v", "--verbose", is_flag=True, help="Print what is done and how long it takes."),
]
JSON_OPTION = click.option("--json", "json_file", metavar="FILE", help="Write JSON to FILE ('-': standard output).")


def is_given(option: str) -> bool:
    """Whether the option stands on the command line, and is not at its default."""
    source, kinds = click.get_current_context().get_parameter_source(option), click.core.ParameterSource
    return source not in (kinds.DEFAULT, kinds.DEFAULT_MAP)


def with_options(options: Sequence[Callable[[Any], Any]]) -> Callable[[Any], Any]:
    """A decorator that adds `options` to a command, listed in this order in its help."""

    def decorate(command: Any) -> Any:
        for option in reversed(options):
            command = option(command)
        return command

    return decorate
