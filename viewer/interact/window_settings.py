"""The settings that a window begins with."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Any

from ..settings import Settings


def window_settings(settings: Settings, is_given: Callable[[str], bool]) -> Settings:
    """What a window begins with. `is_given` says which settings the user has chosen, by name.

    Who asks for a time or an error gets paths, mixed with the real-time picture, as `render` does it without a mode.
    """
    if settings.time_budget is None and settings.error is None:
        return settings
    defaults: dict[str, Any] = {"denoise": "raster"} | ({"mode": "path"} if settings.show == "shaded" else {})
    return replace(settings, **{name: value for name, value in defaults.items() if not is_given(name)})
