"""The command line's options that several commands share, and the types of their values.

Nothing heavy is imported here, so that `--help` and a wrong word answer at once.
"""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Sequence
from typing import Any, get_args

import click

from ..errors import UsageError
from ..settings import DEFAULT_SPP, LAYERS, MAX_EXPOSURE, RANGES, Background, Denoise, Mode, parse_background

MAX_NUMBER = 1e18
"""Of metres and lux; models reach no farther, and its square is still a float32."""


class Number(click.ParamType):
    """A finite number from `low` to `high`, both allowed."""

    name = "number"

    def __init__(self, low: float = -math.inf, high: float = math.inf) -> None:
        self.low, self.high = low, high

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> float:
        try:
            number = float(value)
        except ValueError:
            number = math.nan
        if not math.isfinite(number):
            self.fail(f"{value!r} is not a number.", param, ctx)
        if not self.low <= number <= self.high:
            self.fail(f"{value} is not from {self.low:g} to {self.high:g}.", param, ctx)
        return number


class Numbers(click.ParamType):
    """Numbers with commas between, as many as `counts` allows; `check` gives the problem with them, or ""."""

    name = "numbers"

    def __init__(self, form: str, *counts: int, check: Callable[[tuple[float, ...]], str] | None = None) -> None:
        self.form, self.counts, self.check = form, counts, check

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> tuple[float, ...]:
        try:
            numbers = tuple(float(part) for part in value.split(","))
        except ValueError:
            numbers = ()
        if len(numbers) not in self.counts or not all(map(math.isfinite, numbers)):
            self.fail(f"{value!r} is not {self.form}, numbers with commas between.", param, ctx)
        if max(map(abs, numbers)) > MAX_NUMBER:
            self.fail(f"{value!r} goes beyond {MAX_NUMBER:g}.", param, ctx)
        problem = self.check(numbers) if self.check else ""
        if problem:
            self.fail(problem, param, ctx)
        return numbers

    def get_metavar(self, param: click.Parameter, ctx: click.Context | None = None) -> str:
        return self.form


class Size(click.ParamType):
    """WxH in pixels, or one number for a square."""

    name = "size"

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> tuple[int, int]:
        match = re.fullmatch(r"([0-9]{1,6})(?:[xX]([0-9]{1,6}))?", value)
        if not match or not all(int(n) for n in match.groups() if n):
            self.fail(f"{value!r} is not WxH, such as 1280x720.", param, ctx)
        return int(match[1]), int(match[2] or match[1])

    def get_metavar(self, param: click.Parameter, ctx: click.Context | None = None) -> str:
        return "WxH"


class BackgroundColor(click.ParamType):
    """env, none or #rrggbb (sRGB) to what Settings.background holds."""

    name = "background"

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> Background:
        try:
            return parse_background(value)
        except UsageError:
            self.fail(f"{value!r} is not env, none or #rrggbb.", param, ctx)

    def get_metavar(self, param: click.Parameter, ctx: click.Context | None = None) -> str:
        return "env|none|#rrggbb"


class Layers(click.ParamType):
    """Names of layers with commas between, as a tuple in which each is once."""

    name = "layers"

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> tuple[str, ...]:
        names = value.split(",") if isinstance(value, str) else value
        unknown = [name for name in names if name not in LAYERS]
        if unknown:
            self.fail(f"no layer {unknown[0]!r}; there are {', '.join(LAYERS)}.", param, ctx)
        return tuple(dict.fromkeys(names))

    def get_metavar(self, param: click.Parameter, ctx: click.Context | None = None) -> str:
        return "NAME,..."


def _orbit_problem(orbit: tuple[float, ...]) -> str:
    return f"the distance {orbit[2]:g} is not positive." if len(orbit) == 3 and orbit[2] <= 0 else ""


def _light_problem(light: tuple[float, ...]) -> str:
    return f"{light[2]:g} lux is negative." if light[2] < 0 else ""


def _ends(name: str) -> tuple[Any, Any]:
    return RANGES[name].low, RANGES[name].high


MODE_OPTION = click.option(
    "--mode", type=click.Choice(get_args(Mode)), default="pbr", show_default=True,
    help="Physically based shading, Phong's, or light followed along its paths: the right answer, slowly.")
LOOK_OPTIONS = [
    click.option("--env", default="studio", metavar="FILE|NAME|none", show_default=True,
                 help="Light from all around: a panorama (.hdr, .exr), or studio, sky, furnace, none."),
    click.option("--env-rotation", type=Number(), default=0.0, metavar="DEG",
                 help="Turn it about the vertical axis, counter-clockwise seen from above."),
    click.option("--env-intensity", type=Number(0, 1e6), default=1.0, metavar="X", help="Multiply its light."),
    click.option("--background", type=BackgroundColor(), default="env", show_default=True,
                 help="Behind the model: the environment, nothing (alpha 0), or a colour, which is shown exactly so; "
                      "an .exr holds the colour as linear light."),
    click.option("--exposure", type=Number(-MAX_EXPOSURE, MAX_EXPOSURE), default=0.0, metavar="EV",
                 help="Make the picture 2^EV times as bright; an .exr is left as it is."),
    click.option("--tonemap", type=click.Choice(["neutral", "agx", "aces", "none"]), default="neutral",
                 show_default=True, help="How bright light is brought into the range of a screen."),
    click.option("--light", "lights", type=Numbers("AZ,EL,LUX", 3, check=_light_problem), multiple=True,
                 help="Add a distant light that shines from azimuth and elevation (degrees); repeatable."),
    click.option("--set", "assignments", multiple=True, metavar="NAME=VALUE",
                 help="Any other setting; `pbr-viewer info --settings` lists them; repeatable."),
]
SCENE_OPTIONS = [MODE_OPTION, *LOOK_OPTIONS]
CAMERA_OPTIONS = [
    click.option("--orbit", type=Numbers("AZ,EL[,DIST]", 2, 3, check=_orbit_problem),
                 help="Look from azimuth and elevation (degrees; 0,0 is the front) and a distance; without one, or "
                      "without any option for the camera, the model fills the picture. Default: 30,15."),
    click.option("--eye", type=Numbers("X,Y,Z", 3), help="Look from this point."),
    click.option("--target", type=Numbers("X,Y,Z", 3), help="Look at this point; default: the model's middle."),
    click.option("--fov", type=Number(0.01, 179), metavar="DEG", help="Vertical field of view; default: 45."),
    click.option("--camera", type=click.IntRange(0), metavar="N", help="The file's own camera N, counted from 0."),
]
PATH_OPTIONS = [
    click.option("--spp", type=click.IntRange(*_ends("spp")), metavar="N",
                 help=f"Mode path: samples a pixel; with one of the next two options the most it gets. Default: "
                      f"{DEFAULT_SPP}, or no end with one of them."),
    click.option("--time-budget", type=Number(*_ends("time_budget")), metavar="SECONDS",
                 help="Make the best picture there is time for, by the method that suits; with --mode path by that."),
    click.option("--error", type=Number(*_ends("error")), metavar="TARGET",
                 help="Make a picture of at most this relative error, 0.02 for 2 %, in the least time; with "
                      "--mode path by that, as estimated from the samples."),
    click.option("--seed", type=click.IntRange(*_ends("seed")), default=0, metavar="N",
                 help="Mode path: another N, another noise; the same N, the same picture."),
    click.option("--denoise", type=click.Choice(get_args(Denoise)), default="off", show_default=True,
                 help="Mode path: take the noise away, and some truth with it: fast (a filter of our own), oidn (Intel "
                      "Open Image Denoise, an extra)."),
]
AOV_OPTION = click.option("--aov", type=Layers(), default=(), help=(
    f"Mode path: put these layers into the .exr, of {', '.join(LAYERS)}, with commas between."))
QUIET_OPTION = click.option("-q", "--quiet", is_flag=True, help="No warnings and no progress bar.")
NO_CACHE_OPTION = click.option("--no-cache", is_flag=True,
                               help="Neither read nor write what `pbr-viewer cache` tells of.")
BACKEND_OPTION = click.option("--backend", type=click.Choice(["auto", "egl", "osmesa", "window"]), default="auto",
                              show_default=True, help="Where OpenGL comes from; `pbr-viewer doctor` tells what works "
                                                      "here.")


def size_option(default: str) -> Callable[[Any], Any]:
    return click.option("--size", type=Size(), default=default, show_default=True,
                        help="In pixels; one number: a square.")


COMMON_OPTIONS = [
    size_option("1280x720"),
    NO_CACHE_OPTION,
    QUIET_OPTION,
    click.option("-v", "--verbose", is_flag=True, help="Tell what is done and how long it takes."),
]
JSON_OPTION = click.option("--json", "json_file", metavar="FILE", help="Write JSON to FILE ('-': standard output).")


def with_options(options: Sequence[Callable[[Any], Any]]) -> Callable[[Any], Any]:
    """A decorator that adds them all, to be listed in this order."""

    def decorate(command: Any) -> Any:
        for option in reversed(options):
            command = option(command)
        return command

    return decorate


def check_camera_options(options: dict[str, Any]) -> None:
    """Raises UsageError for options that contradict each other, before anything is loaded."""
    given = [f"--{name}" for name in ("orbit", "eye", "camera") if options[name] is not None]
    if len(given) > 1:
        raise UsageError(f"{' and '.join(given)} exclude one another")
    if options["target"] is not None and options["camera"] is not None:
        raise UsageError("--target does not go with --camera")
    if options["eye"] is not None and options["eye"] == options["target"]:
        raise UsageError("--eye and --target are the same point")
