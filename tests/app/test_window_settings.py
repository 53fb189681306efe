"""What a window begins with."""

from __future__ import annotations

from dataclasses import replace

import pytest

from viewer.interact.window_settings import window_settings
from viewer.settings import Settings


@pytest.mark.parametrize("wish, given, begins", [
    ({}, (), {}),
    ({"time_budget": 2.0}, (), {"mode": "path", "denoise": "raster"}),
    ({"error": 0.1}, ("mode",), {"denoise": "raster"}),
    ({"time_budget": 2.0}, ("mode", "denoise"), {}),
    ({"time_budget": 2.0, "show": "normal"}, (), {"denoise": "raster"}),
])
def test_who_asks_for_a_time_or_an_error_gets_both_methods(wish, given, begins):
    settings = Settings(denoise="fast", **wish)
    assert window_settings(settings, given.__contains__) == replace(settings, **begins)
