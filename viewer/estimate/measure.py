"""Traces paths for a time and tells the error of a picture of the raster by them."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from ..plan.warnings import lost_light
from ..scene.camera import Camera
from ..scene.scene import Scene
from ..settings import Settings
from .paths import PathGroups, trace_for
from .raster_error import RasterError, raster_error

if TYPE_CHECKING:
    from ..trace.tracer import Tracer

_MEANT = {"shadows": "off", "subsurface": "off", "hair_scattering": "single", "media_scattering": "single"}
"""Settings that leave light out on purpose, which mode path does not have."""


def measure_error(tracer: Tracer, raster: np.ndarray, scene: Scene, camera: Camera, settings: Settings,
                  size: tuple[int, int], seconds: float,
                  wants_to_stop: Callable[[], bool] = lambda: False) -> RasterError | None:
    """The error of `raster`, the linear radiance (H, W, 4) of the picture that the raster draws with `settings`, with
    no colour laid behind it.

    Paths are traced for about so many seconds, and at least for some samples a pixel; preparing the scene comes on top.
    None if `wants_to_stop` was true before that. Raises as `Tracer.begin`.
    """
    paths = PathGroups.of_raster(tracer, scene, camera, settings, size)
    try:
        trace_for(paths, seconds, wants_to_stop)
        if not paths.is_enough:
            return None
        notes = error_notes(settings, paths.missing, paths.lost_share)
        error = raster_error(paths.of(raster), paths.groups, paths.shows_model, paths.samples, paths.seconds, notes,
                             1 - 1 / paths.every**2)
        return replace(error, map=paths.spread(error.map))
    finally:
        paths.release()


def error_notes(settings: Settings, missing: Sequence[str], lost_share: float = 0.0) -> tuple[str, ...]:
    """Lines for the user: what of the error is there on purpose, and what paths miss, too; of the
    light of photons it is the share `lost_share`."""
    meant = [f"{name.replace('_', '-')}={value}" for name, value in _MEANT.items() if getattr(settings, name) == value]
    return (*(f"{choice} leaves out light, which counts as error" for choice in meant),
            *(f"counts as error where the picture shows it: {line}" for line in missing),
            *[f"not counted as error: {line}" for line in lost_light(lost_share)])
