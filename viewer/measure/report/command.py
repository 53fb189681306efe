"""The command line that renders a picture of the report."""

from __future__ import annotations

import shlex
from collections.abc import Iterator, Mapping
from typing import Any

from ...quality import POINTS
from ...settings import ignored, setting_name
from .ladder import Method
from .stand_in_lights import light_option

_OPTIONS = ("mode", "spp", "denoise", "error")
"""Settings with an option of their own; the others are given by --set."""


def command_line(model: str, options: Mapping[str, Any], method: Method) -> str:
    """`pbr-viewer render` of `model` by `method`, with the `options` of the report's own command line."""
    words = ["pbr-viewer", "render", model, "-o", "picture.png", *_given(options, method)]
    if method.mode == "pbr":
        words += ["--quality", method.quality or "draft"]
    said = POINTS[method.quality] if method.quality else {}
    for name, value in method.changes.items():
        if name in said:
            continue
        words += [f"--{name}", str(value)] if name in _OPTIONS else ["--set", f"{name}={value}"]
    return shlex.join(words)


def _given(options: Mapping[str, Any], method: Method) -> Iterator[str]:
    """The size, and the options that are not the defaults of `render`."""
    width, height = options["size"]
    yield from ("--size", f"{width}x{height}")
    if method.lights is not None:
        yield from ("--env", "none")
    elif options["env"] != "studio":
        yield from ("--env", options["env"])
    for name, default in (("env_rotation", 0.0), ("env_intensity", 1.0), ("exposure", 0.0), ("tonemap", "neutral")):
        if options[name] != default:
            yield from (f"--{name.replace('_', '-')}", _plain(options[name]))
    if options["background"] != "env":
        yield from ("--background", "none")
    for light in options["lights"]:
        yield f"--light={_plain(light)}"
    for light in method.lights or ():
        yield f"--light={light_option(light)}"
    for orbit in options["orbit"]:
        yield f"--orbit={_plain(orbit)}"
    for name in ("eye", "target"):
        if options[name] is not None:
            yield f"--{name}={_plain(options[name])}"
    if options["view"] is not None:
        yield from ("--view", ",".join(options["view"]))
    if options["ortho"]:
        yield "--ortho"
    if options["up"] != "y":
        yield f"--up={options['up']}"
    for file in options["with_files"]:
        yield from ("--with", file)
    for name in ("fov", "camera", "variant", "scene", "material"):
        if options[name] is not None:
            yield from (f"--{name}", _plain(options[name]))
    for assignment in options["assignments"]:
        name = setting_name(assignment)
        is_left = name not in ignored(method.mode) and (method.is_traced or name not in ("caustics", "photons"))
        if name not in method.changes and is_left:
            yield from ("--set", assignment)


def _plain(value: object) -> str:
    if isinstance(value, tuple):
        return ",".join(map(_plain, value))
    return f"{value:.10g}" if isinstance(value, float) else str(value)
