"""What the raster draws for a view, and which part of the picture shows which mode."""

from __future__ import annotations

from dataclasses import replace

from ..estimate.mixture import raster_settings
from ..quality import DRAFT
from ..settings import Mode, Settings, ignored
from .state import ViewState

Part = tuple[int, int, int, int]
Shot = tuple[Settings, Part | None]
"""Settings of the raster, and the part of the picture (x, y, width, height) that it draws; None is all of it."""

CLEAR_GREY = (0.03, 0.03, 0.03)
"""The colour behind a model without background, in linear Rec. 709, since a window has no alpha."""


def on_screen(state: ViewState) -> Settings:
    """The settings for display in a window, which has no alpha: a background of `none` becomes CLEAR_GREY, and so does
    an environment where there is none, or which is not behind a view of values."""
    background = state.settings.background
    is_behind = state.scene.environment is not None and not state.settings.shows_values
    if background != "none" and (background != "env" or is_behind):
        return state.settings
    return replace(state.settings, background=CLEAR_GREY)


def shots(state: ViewState, settings: Settings, size: tuple[int, int]) -> list[Shot]:
    """What the raster draws for a picture of `size` pixels.

    If mode path is shown, the raster draws the whole picture in the mode beside it, or in mode pbr. The path-traced
    picture covers its part as soon as there is one.
    """
    plain = Settings()
    settings = replace(settings, **{name: getattr(plain, name) for name in ignored("pbr", "phong")})
    if state.shows("path"):
        beside: Mode = next((mode for mode in state.modes if mode != "path"), "pbr")
        return [(replace(settings, mode=beside), None)]
    return [(replace(settings, mode=mode), part) for mode, part in parts(state, size)]


def shots_of_quality(state: ViewState, settings: Settings, size: tuple[int, int], still: bool) -> list[Shot]:
    """As `shots`; only a picture at rest has the chosen quality, so that a moving one stays fast. Where paths were too
    few to be mixed with the raster's picture, the one that waited for them is shown."""
    plain = shots(state, settings, size)
    if still and state.modes == ("path",) and state.settings.denoise == "raster":
        return [(replace(raster_settings(shot), caustics=shot.caustics), part) for shot, part in plain]
    quality = state.quality if still else DRAFT
    return [(quality.applied(shot), part) for shot, part in plain]


def parts(state: ViewState, size: tuple[int, int]) -> list[tuple[Mode, Part | None]]:
    """The visible modes, each with its part of the picture; None means the whole picture."""
    if state.split is None:
        return [(state.settings.mode, None)]
    width, height = size
    line = min(max(round(state.split * width), 0), width)
    halves = zip(state.sides, ((0, 0, line, height), (line, 0, width - line, height)), strict=True)
    return [(mode, part) for mode, part in halves if part[2] > 0]
