"""The command line's words turned into cameras, colours, lights and sizes."""

from __future__ import annotations

import math
import re

import click
import numpy as np

from .scene.camera import DEFAULT_AZIMUTH, DEFAULT_ELEVATION, Camera
from .scene.color import srgb_to_linear
from .scene.light import Light
from .scene.scene import Scene
from .settings import Background


class Numbers(click.ParamType):
    """Finite numbers with commas between, as many as `counts` allows."""

    name = "numbers"

    def __init__(self, form: str, *counts: int) -> None:
        self.form, self.counts = form, counts

    def convert(self, value, param, ctx):
        try:
            numbers = tuple(float(part) for part in value.split(","))
        except ValueError:
            self.fail(f"{value!r} is not {self.form}", param, ctx)
        if len(numbers) not in self.counts or not all(map(math.isfinite, numbers)):
            self.fail(f"{value!r} is not {self.form}", param, ctx)
        return numbers

    def get_metavar(self, param, ctx=None):
        return self.form


class Size(click.ParamType):
    """WxH in pixels, or one number for a square."""

    name = "size"

    def convert(self, value, param, ctx):
        match = re.fullmatch(r"(\d{1,6})(?:[xX](\d{1,6}))?", value) if isinstance(value, str) else None
        if isinstance(value, tuple):
            return value
        if not match or not all(int(n) for n in match.groups() if n):
            self.fail(f"{value!r} is not WxH", param, ctx)
        return int(match[1]), int(match[2] or match[1])

    def get_metavar(self, param, ctx=None):
        return "WxH"


class BackgroundColor(click.ParamType):
    """env, none or #rrggbb (sRGB) to what Settings.background holds."""

    name = "background"

    def convert(self, value, param, ctx) -> Background:
        if value in ("env", "none") or isinstance(value, tuple):
            return value
        match = re.fullmatch(r"#?([0-9a-fA-F]{6})", value)
        if not match:
            self.fail(f"{value!r} is not env, none or #rrggbb", param, ctx)
        code = np.array([int(match[1][k : k + 2], 16) for k in (0, 2, 4)]) / 255
        return tuple(float(c) for c in srgb_to_linear(code))

    def get_metavar(self, param, ctx=None):
        return "env|none|#rrggbb"


def make_light(numbers: tuple[float, ...]) -> Light:
    azimuth, elevation, lux = numbers
    if lux < 0:
        raise click.UsageError(f"--light: {lux:g} lux is negative")
    return Light.from_angles(math.radians(azimuth), math.radians(elevation), lux)


def make_camera(
    scene: Scene,
    size: tuple[int, int],
    *,
    orbit: tuple[float, ...] | None = None,
    eye: tuple[float, ...] | None = None,
    target: tuple[float, ...] | None = None,
    fov: float | None = None,
    number: int | None = None,
) -> Camera:
    """The camera the options ask for; without any the one that frames the scene.

    `orbit` is azimuth and elevation in degrees and perhaps a distance; `number` counts the file's own cameras from 0.
    """
    if sum(option is not None for option in (orbit, eye, number)) > 1:
        raise click.UsageError("--orbit, --eye and --camera exclude one another")
    if target is not None and number is not None:
        raise click.UsageError("--target does not go with --camera")
    if number is not None:
        return _own_camera(scene, number, fov)
    fov_y = math.radians(45.0 if fov is None else fov)
    center = scene.center if target is None else np.array(target)
    if eye is not None:
        if np.array_equal(eye, center):
            raise click.UsageError("--eye and --target are the same point")
        return Camera.look_at(eye, center, fov_y=fov_y)
    azimuth, elevation = DEFAULT_AZIMUTH, DEFAULT_ELEVATION
    if orbit is not None:
        azimuth, elevation = math.radians(orbit[0]), math.radians(orbit[1])
    if orbit is not None and len(orbit) == 3:
        if orbit[2] <= 0:
            raise click.UsageError(f"--orbit: the distance {orbit[2]:g} is not positive")
        return Camera.orbit(center, orbit[2], azimuth, elevation, fov_y)
    return Camera.framing(center, scene.radius, size[0] / size[1], azimuth, elevation, fov_y)


def _own_camera(scene: Scene, number: int, fov: float | None) -> Camera:
    if not 0 <= number < len(scene.cameras):
        have = f"0 to {len(scene.cameras) - 1}" if scene.cameras else "none"
        raise click.UsageError(f"--camera {number}: {scene.name} has {have}")
    camera = scene.cameras[number]
    return camera if fov is None else Camera(camera.pose, math.radians(fov), None, camera.name)
