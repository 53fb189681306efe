"""The options that say from where a model is looked at."""

from __future__ import annotations

import math
import re
from typing import Any

import click

from ..errors import UsageError
from .options import Number, Numbers, Whole

VIEWS = {"front": (0.0, 0.0), "back": (180.0, 0.0), "left": (-90.0, 0.0), "right": (90.0, 0.0), "top": (0.0, 90.0),
         "bottom": (0.0, -90.0), "iso": (45.0, math.degrees(math.atan(math.sqrt(0.5))))}
"""Azimuth and elevation in degrees. From "iso" the three axes are seen alike: its elevation is 35.26 degrees."""


class Grid(click.ParamType):
    """COLSxROWS, as (columns, rows)."""

    name = "grid"

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> tuple[int, int]:
        match = re.fullmatch(r"([1-9][0-9]{0,3})[xX]([1-9][0-9]{0,3})", value)
        if not match:
            self.fail(f"{value!r} is not COLSxROWS, such as 4x2.", param, ctx)
        return int(match[1]), int(match[2])

    def get_metavar(self, param: click.Parameter, ctx: click.Context | None = None) -> str:
        return "COLSxROWS"


class Views(click.ParamType):
    """Names of views separated by commas, as a tuple without repetitions."""

    name = "views"

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> tuple[str, ...]:
        names = value.split(",") if isinstance(value, str) else value
        unknown = [name for name in names if name not in VIEWS]
        if unknown:
            self.fail(f"there is no view {unknown[0]!r}; choose from {', '.join(VIEWS)}.", param, ctx)
        return tuple(dict.fromkeys(names))

    def get_metavar(self, param: click.Parameter, ctx: click.Context | None = None) -> str:
        return "NAME,..."


def _orbit_problem(orbit: tuple[float, ...]) -> str:
    return f"the distance {orbit[2]:g} is not positive." if len(orbit) == 3 and orbit[2] <= 0 else ""


CAMERA_OPTIONS = [
    click.option("--orbit", type=Numbers("AZ,EL[,DIST]", 2, 3, check=_orbit_problem), multiple=True,
                 help="Place the camera at this azimuth and elevation (degrees) and distance. 0,0 is the front: the "
                      "camera looks along -Z. Without a distance the model fills the picture. Default: 30,15. `render` "
                      "accepts several and makes a picture for each."),
    click.option("--view", type=Views(),
                 help=f"Look from this side: {', '.join(VIEWS)}. left is the left of the front view; iso shows three "
                      "sides. `render` accepts several, separated by commas, and makes a picture for each."),
    click.option("--ortho", is_flag=True, help="Use an orthographic camera, without perspective. With --eye or a "
                                               "distance, it shows as much as a perspective camera shows at the "
                                               "target."),
    click.option("--eye", type=Numbers("X,Y,Z", 3), help="Look from this point (metres; +Y is up)."),
    click.option("--target", type=Numbers("X,Y,Z", 3), help="Look at this point; default: the model's centre."),
    click.option("--fov", type=Number(0.01, 179), metavar="DEG", help="Vertical field of view; default: 45."),
    click.option("--camera", type=Whole(0, 10**9), metavar="N", help="Use camera N of the file, counted from 0."),
]
VIEWS_OPTIONS = [
    click.option("--cameras", metavar="FILE.json",
                 help="Make a picture for each camera in a transforms.json, the format of nerfstudio and instant-ngp. "
                      "Without --size, the pictures have the size that the file gives."),
    click.option("--write-cameras", metavar="FILE.json",
                 help="Write the cameras and the names of all pictures to a transforms.json. For one file per model: a "
                      "folder, which ends in /, or a pattern with {name}, as for -o."),
    click.option("--sheet", type=Grid(),
                 help="Make one picture with a grid of labelled views around the model, or of the views that --view, "
                      "--orbit or --cameras give. Several models with one OUT make a contact sheet with a view of each "
                      "model. --size is the size of each view, by default 320x320."),
]


def check_camera_options(options: dict[str, Any], takes_several: bool = False) -> None:
    """Raises UsageError for options that contradict each other, before anything is loaded, and for several views
    where one is needed."""
    given = {name: options[name] for name in ("orbit", "view", "eye", "camera", "cameras")
             if options.get(name) not in (None, ())}
    names = [f"--{name}" for name in given]
    if len(given) > 1 and given.keys() != {"orbit", "view"}:
        raise UsageError(f"{' and '.join(names)} cannot be used together")
    if not takes_several and len(options["orbit"] or ()) + len(options["view"] or ()) > 1:
        raise UsageError(f"{' and '.join(names)}: only `render` takes several views")
    for file_has in given.keys() & {"camera", "cameras"}:
        for name in ("target", "ortho", *(("fov",) if file_has == "cameras" else ())):
            if options[name]:
                raise UsageError(f"--{name} and --{file_has} cannot be used together")
    if options["eye"] is not None and options["eye"] == options["target"]:
        raise UsageError("--eye and --target are the same point")


def chooses_camera(options: dict[str, Any]) -> bool:
    """Whether any option says from where to look."""
    return any(options[name] for name in ("orbit", "view", "ortho", "target")) or any(
        options[name] is not None for name in ("eye", "camera", "fov"))
