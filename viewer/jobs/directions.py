"""From where models are looked at: directions about the model, by name or by angles."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from ..scene.camera import DEFAULT_AZIMUTH, DEFAULT_ELEVATION
from .camera_options import VIEWS

_ALL = ".15g"
"""All digits, so that no two directions are one file."""


@dataclass(frozen=True)
class Direction:
    """Angles in radians, as `Camera.orbit` has them; `distance` is that to the target, None to fit the model. `label`
    is part of file names, and `title` what a reader sees."""

    label: str
    title: str
    azimuth: float
    elevation: float
    distance: float | None = None


def directions_of(options: dict[str, Any]) -> tuple[Direction, ...]:
    """Those of --view and --orbit, each once, or the default one, which has no label."""
    given = [*map(_named, options["view"] or ()), *map(_orbit, options["orbit"] or ())]
    return tuple(dict.fromkeys(given)) or (Direction("", "", DEFAULT_AZIMUTH, DEFAULT_ELEVATION),)


def _named(name: str) -> Direction:
    azimuth, elevation = VIEWS[name]
    return Direction(name, name, math.radians(azimuth), math.radians(elevation))


def _orbit(numbers: Sequence[float]) -> Direction:
    azimuth, elevation, *distance = numbers
    label, title = f"az{azimuth:{_ALL}}_el{elevation:{_ALL}}", f"{azimuth:g}°, {elevation:g}°"
    label += "".join(f"_d{value:{_ALL}}" for value in distance)
    return Direction(label, title, math.radians(azimuth), math.radians(elevation), *distance)
