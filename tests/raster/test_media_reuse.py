"""Light in media is baked when scene, lights or medium change, and not otherwise."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from shapes import constant, scene, sphere

from viewer.raster.media_light import MediaLight
from viewer.scene.environment import Environment
from viewer.scene.light import Light
from viewer.settings import Settings

SUN = Light("directional", intensity=3.0, direction=(0, -1, 0))


@pytest.fixture
def bakes(monkeypatch):
    """A line for each bake."""
    found, bake = [], MediaLight.bake

    def counted(self, *arguments):
        found.append("bake")
        return bake(self, *arguments)

    monkeypatch.setattr(MediaLight, "bake", counted)
    return found


def test_what_bakes_light_anew(renderer, bakes):
    model = scene(sphere(segments=8), lights=(SUN,), environment=constant())
    settings = Settings.of(fog=0.5)

    def bakes_for(model, settings, azimuth=0.0) -> int:
        before = len(bakes)
        renderer.draw(model, model.framing_camera(1.0, azimuth=azimuth), settings, (8, 8))
        return len(bakes) - before

    assert bakes_for(model, settings) == 1
    assert bakes_for(model, settings, azimuth=1.0) == 0
    assert bakes_for(model, replace(settings, exposure=1.0, media_steps="28", background="none")) == 0
    assert bakes_for(model, replace(settings, mode="phong")) == 1
    assert bakes_for(model, settings) == bakes_for(model, replace(settings, mode="phong")) == 0  # a split window
    assert bakes_for(model, replace(settings, fog=0.6)) == 1
    assert bakes_for(model.relit(lights=(replace(SUN, intensity=2.0),)), settings) == 1
    assert bakes_for(scene(sphere(segments=12), lights=(SUN,), environment=constant()), settings) == 1


def test_media_follow_environments_whose_arrays_come_and_go(renderer, bakes):
    """An array that is gone leaves its address to the next one."""
    model, settings = scene(sphere(segments=8)), Settings.of(fog=0.5)
    for k in range(1, 6):
        sky = Environment("grey", np.full((4, 8, 3), k, np.float32))
        renderer.draw(model.relit(environment=sky), model.framing_camera(1.0), settings, (8, 8))
        del sky
        assert len(bakes) == k
