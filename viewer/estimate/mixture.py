"""`--denoise raster`: path-traced pictures, mixed with one of the raster where that is nearer to the truth."""

from __future__ import annotations

from dataclasses import fields, replace
from typing import TYPE_CHECKING, Any

import numpy as np

from ..scene.camera import Camera
from ..scene.scene import Scene
from ..settings import Settings, ignored

if TYPE_CHECKING:
    from ..raster.renderer import Renderer

_CHOSEN: dict[str, Any] = {"antialias": "ssaa-4", "environment_shadows": "64", "caustics": "off"}
"""What a picture of the raster gains most by, at the price of few samples."""


def draw_guide(renderer: Renderer, scene: Scene, camera: Camera, settings: Settings,
               size: tuple[int, int]) -> np.ndarray | None:
    """The guide of `Tracer.begin` for `settings` of mode path: linear radiance, (H, W, 3) float32, row 0 at the top, or
    None if they need none.

    Raises as `Renderer.draw`.
    """
    if settings.denoise != "raster":
        return None
    renderer.draw(scene, camera, raster_settings(settings), size, half=False, still=True)
    return renderer.read_radiance()[..., :3]


def raster_settings(settings: Settings) -> Settings:
    """The settings of the raster's picture for one of mode path, with no colour behind it."""
    others: dict[str, Any] = {f.name: f.default for f in fields(Settings) if f.name in ignored("pbr")}
    if isinstance(settings.background, tuple):
        others["background"] = "none"
    return replace(settings, **others | _CHOSEN, mode="pbr")
