"""What a view shows as a command line of `pbr-viewer render`, which makes the same picture."""

from __future__ import annotations

import math
import shlex
from collections.abc import Iterator
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from ..quality import POINTS
from ..scene.camera import DEFAULT_FOV
from ..scene.color import linear_to_srgb
from ..scene.environment_files import environment_spec
from ..scene.light import Light
from ..settings import STOPPING, Settings, ignored, setting_meanings
from .model_files import ModelFiles
from .orbit import OrbitController
from .state import ADDED_LIGHT, ViewState


@dataclass(frozen=True)
class CommandLine:
    """`words` are those after `pbr-viewer render`. `lost` are things in the view that no option describes."""

    words: tuple[str, ...]
    lost: tuple[str, ...]

    def __str__(self) -> str:
        return shlex.join(("pbr-viewer", "render", *self.words))


def command_line(state: ViewState, orbit: OrbitController, size: tuple[int, int], files: ModelFiles,
                 samples: float | None = None) -> CommandLine:
    """The line for the picture at rest of `size` pixels. Of a split it is the right side.

    `samples` are those that a pixel of a path-traced picture has by now; the line asks for as many if the settings do
    not say when to stop.
    """
    lost: list[str] = []
    settings = Settings(**{**vars(state.settings), "mode": state.modes[-1]})
    if state.before_furnace is not None:
        lost.append("the white furnace")
    if state.has_edited_lights:
        lost.append("changes of the file's lights")
    path = files.shown if files.shown is not None else "MODEL"
    if files.shown is None:
        lost.append("the model, which has no file")
    words = [path, "-o", f"{Path(path).stem}.png", "--size", f"{size[0]}x{size[1]}", *files.words(path)]
    if state.scene.variant:
        words += ["--variant", state.scene.variant]
    if state.playback.animation is not None:
        words += ["--animation", str(state.playback.animation), "--time", _number(state.playback.time)]
    words += [*_camera(state, orbit, lost), *_light(state, lost), *_look(settings), *_settings(state, settings)]
    if settings.mode == "path" and samples is not None and all(getattr(settings, name) is None for name in STOPPING):
        words += ["--spp", str(max(round(samples), 1))]
    return CommandLine(tuple(words), tuple(lost))


def _camera(state: ViewState, orbit: OrbitController, lost: list[str]) -> Iterator[str]:
    camera = orbit.camera
    for number, own in enumerate(state.scene.cameras):
        if own.height == camera.height and own.fov_y == camera.fov_y and np.allclose(own.pose, camera.pose, 1e-9, 1e-9):
            yield from ("--camera", str(number))
            return
    if orbit.roll:
        lost.append("the camera's roll")
    angles = [math.degrees(orbit.azimuth), math.degrees(orbit.elevation)]
    yield from ("--orbit", _numbers([*angles, orbit.distance]), "--target", _numbers(orbit.target))
    if orbit.fov_y != DEFAULT_FOV:
        yield from ("--fov", _number(math.degrees(orbit.fov_y)))
    if orbit.is_orthographic:
        yield "--ortho"


def _light(state: ViewState, lost: list[str]) -> Iterator[str]:
    environment = state.scene.environment
    spec = environment_spec(environment)
    if spec is None:
        lost.append("the environment, which has no file")
    elif spec != "studio":
        yield from ("--env", spec)
    if environment is not None and environment.rotation:
        yield from ("--env-rotation", _number(math.degrees(environment.rotation)))
    if environment is not None and environment.intensity != 1:
        yield from ("--env-intensity", _number(environment.intensity))
    for light in state.scene.lights:
        if light.name == ADDED_LIGHT:
            if light.color != (1.0, 1.0, 1.0):
                lost.append("the colour of an added light")
            yield from ("--light", _numbers([*map(math.degrees, angles_of(light)), light.intensity]))


def angles_of(light: Light) -> tuple[float, float]:
    """Azimuth and elevation in radians from which a directional light shines, as `Light.from_angles` has them."""
    x, y, z = (-d for d in light.direction)
    return math.atan2(x, z), math.atan2(y, math.hypot(x, z))


def _look(settings: Settings) -> Iterator[str]:
    default = Settings()
    for name in ("mode", "tonemap", "ground"):
        if getattr(settings, name) != getattr(default, name):
            yield from (f"--{name}", getattr(settings, name))
    if settings.exposure:
        yield from ("--exposure", _number(settings.exposure))
    if isinstance(settings.background, tuple):
        codes = np.round(255 * linear_to_srgb(np.array(settings.background)))
        yield from ("--background", "#" + bytes(codes.astype(np.uint8)).hex())
    elif settings.background != default.background:
        yield from ("--background", settings.background)
    if settings.mode == "path":
        for name in (*STOPPING, "seed", "denoise"):
            if getattr(settings, name) != getattr(default, name):
                yield from (f"--{name.replace('_', '-')}", _value(getattr(settings, name)))


def _settings(state: ViewState, settings: Settings) -> Iterator[str]:
    """The quality, and what `--set` says beside it. Without its name `render` would choose one by itself."""
    named, shown, unused = Settings(), state.quality.applied(settings), ignored(settings.mode)
    if settings.mode == "pbr":
        named = replace(named, **POINTS[state.quality.name])
        yield from ("--quality", state.quality.name)
    for name in setting_meanings():
        value = getattr(shown, name)
        if value != getattr(named, name) and name not in unused:
            yield from ("--set", f"{name.replace('_', '-')}={_value(value)}")


def _value(value: Any) -> str:
    if isinstance(value, tuple):
        return _numbers(value)
    return "none" if value is None else _number(value) if isinstance(value, float) else str(value)


def _numbers(values: Any) -> str:
    return ",".join(map(_number, values))


def _number(value: float) -> str:
    """With twelve digits, so that 30 degrees are 30."""
    return f"{float(value):.12g}"
