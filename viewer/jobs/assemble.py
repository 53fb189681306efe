"""Makes settings, environment, scene and camera from the options of the command line."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any

import numpy as np

from ..errors import InputError, UsageError
from ..interact.playback import Playback
from ..plan.unused import unused_settings
from ..plan.warnings import picture_warnings
from ..quality import Quality
from ..scene.camera import DEFAULT_FOV, Camera
from ..scene.color import srgb_to_linear
from ..scene.environment import Environment
from ..scene.environment_files import load_environment
from ..scene.join import join
from ..scene.light import Light
from ..scene.load import load_scene
from ..scene.material import Material
from ..scene.scene import Scene
from ..scene.upright import upright
from ..settings import Settings, setting_name, with_dashes
from .directions import Direction, directions_of

_SETTINGS = ("mode", "background", "exposure", "tonemap", "spp", "time_budget", "error", "seed", "denoise", "ground")


def make_settings(options: dict[str, Any]) -> Settings:
    """The settings that the options describe. Raises UsageError for an invalid --set."""
    given = {name: options[name] for name in _SETTINGS if name in options}
    settings = Settings(**given)
    for assignment in options["assignments"]:
        settings = settings.with_option(assignment)
    return settings


def make_quality(options: dict[str, Any], settings: Settings, scene: Scene, size: tuple[int, int]) -> Quality:
    """The quality that the options describe for pictures of `scene`, which leaves alone what they --set."""
    return Quality.of(options["quality"], map(setting_name, options["assignments"]), settings, scene, size)


def make_environment(options: dict[str, Any]) -> Environment | None:
    """The environment that the options describe, or None. Raises InputError for a file that cannot be used."""
    environment = load_environment(options["env"])
    if environment is None:
        return None
    return replace(environment, rotation=math.radians(options["env_rotation"]), intensity=options["env_intensity"])


def make_scene(model: str, environment: Environment | None, options: dict[str, Any]) -> Scene:
    """The scene of the file `model`, with `environment` and the files and lights that the options add, at the time they
    name.

    Raises InputError for a file that cannot be used or that does not have the scene, variant or animation.
    """
    scene = load_model(model, options)
    scene = scene.relit(environment=environment, lights=(*scene.lights, *map(make_light, options["lights"])))
    time = options.get("time")
    if options.get("animation") is None and time is None:
        return scene
    number, time = find_animation(model, scene, options["animation"]), time or 0.0
    name, duration = scene.animations[number].name, scene.animations[number].duration
    if time > duration and options.get("turntable") is None:  # which begins anew at the end
        problem = f"--time {time:g}: the animation {name!r} takes {duration:g} s; its end is shown"
        scene = replace(scene, warnings=(*scene.warnings, problem))
    return pose(model, scene, time, number)


def load_model(model: str, options: dict[str, Any]) -> Scene:
    """The scene of the file `model` at rest, in its own light, with the files that the options add. Raises as
    `make_scene`."""
    wanted = options.get("scene")
    if wanted is not None and wanted.isdecimal():
        wanted = int(wanted)
    scene = load_scene(model, wanted, options.get("variant"))
    scene = upright(join(scene, *map(load_scene, options.get("with_files", ()))), options.get("up", "y"))
    return scene if options.get("material") is None else scene.with_material(make_material(options["material"]))


def pose(model: str, scene: Scene, time: float, animation: int) -> Scene:
    """As `Scene.at`, with errors that name the file `model`. The scene knows only its own name."""
    try:
        return scene.at(time, animation)
    except InputError as error:
        raise InputError(model, error.place, error.problem) from error


def make_playback(model: str, scene: Scene, options: dict[str, Any]) -> Playback:
    """Where the window begins: an animation that is named plays, and one whose time is given stands still."""
    if options["animation"] is None and options["time"] is None:
        return Playback()
    number, time = find_animation(model, scene, options["animation"]), options["time"]
    return Playback(number, min(time or 0.0, scene.animations[number].duration), is_playing=time is None)


def find_animation(model: str, scene: Scene, wanted: str | None) -> int:
    """The number of the animation `wanted`, a name or a number in digits; None is the first. Raises InputError."""
    names = [animation.name for animation in scene.animations]
    if wanted in names:
        return names.index(wanted)
    number = 0 if wanted is None else int(wanted) if wanted.isdecimal() else len(names)
    if number >= len(names):
        option = "--time" if wanted is None else f"--animation {wanted}"
        known = f"{', '.join(names)}, counted from 0" if names else "none" + why_no_animations(scene)
        raise InputError(model, "animations", f"{option}: the file has {known}")
    return number


def why_no_animations(scene: Scene) -> str:
    """What is wrong with animations that the file has, but that cannot be played; "" if it has none."""
    lost = next((line for line in scene.warnings if line.startswith("animations[")), None)
    return f" that can be played: {lost}" if lost is not None else ""


def make_material(text: str) -> Material:
    """The material of "#rrggbb,METALLIC,ROUGHNESS" (sRGB). It is double-sided: triangles may be wound either way."""
    color, metallic, roughness = text.split(",")
    red, green, blue = srgb_to_linear(np.array(list(bytes.fromhex(color[1:]))) / 255).tolist()
    return Material(name="--material", base_color=(red, green, blue, 1.0), metallic=float(metallic),
                    perceptual_roughness=float(roughness), double_sided=True)


def make_light(numbers: tuple[float, float, float]) -> Light:
    """A directional light from (azimuth, elevation, illuminance), in degrees and lux."""
    azimuth, elevation, lux = numbers
    return Light.from_angles(math.radians(azimuth), math.radians(elevation), lux)


def known_warnings(scene: Scene, settings: Settings) -> list[str]:
    """What is known to be left out or ignored before a picture of `scene` is drawn, a line each."""
    of_settings = [*picture_warnings(scene, settings), *unused_settings(scene, settings)]
    return [*scene.all_warnings, *map(with_dashes, of_settings)]


def make_camera(model: str, scene: Scene, options: dict[str, Any], direction: Direction | None = None) -> Camera:
    """The camera that the options describe, of several views that from `direction`; without such options, one that
    frames the scene.

    Raises InputError if `model` does not have the requested camera, and UsageError if eye and target are the same.
    """
    number, fov, eye = options["camera"], options["fov"], options["eye"]
    if number is not None:
        return _own_camera(model, scene, number, fov)
    fov_y = DEFAULT_FOV if fov is None else math.radians(fov)
    center = scene.center if options["target"] is None else np.array(options["target"])
    if eye is not None and np.array_equal(eye, center):
        raise UsageError(f"--eye is the centre of {model}: give a --target to look at")
    (width, height), ortho = options["size"], options["ortho"]
    direction = directions_of(options)[0] if direction is None else direction
    angles = direction.azimuth, direction.elevation
    if eye is not None:
        camera, depth = Camera.look_at(eye, center, fov_y=fov_y), float(np.linalg.norm(center - eye))
    elif direction.distance is not None:
        camera, depth = Camera.orbit(center, direction.distance, *angles, fov_y), direction.distance
    else:
        return scene.framing_camera(width / height, *angles, fov_y, options["target"], orthographic=ortho)
    return camera.orthographic(depth) if ortho else camera


def _own_camera(model: str, scene: Scene, number: int, fov: float | None) -> Camera:
    if number >= len(scene.cameras):
        has = f"{len(scene.cameras)}, counted from 0" if scene.cameras else "none"
        raise InputError(model, "cameras", f"--camera {number}: the file has {has}")
    camera = scene.cameras[number]
    return camera if fov is None else replace(camera, fov_y=math.radians(fov), height=None)
