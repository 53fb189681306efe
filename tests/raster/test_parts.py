"""A picture drawn in parts, each with its own settings."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import viewer
from viewer.base.resources import resource_folder
from viewer.gpu.context import open_context
from viewer.raster.renderer import Renderer
from viewer.scene.camera import Camera
from viewer.settings import Settings

SIZE = (96, 64)


@pytest.fixture(scope="module")
def scene():
    return viewer.load(resource_folder("assets") / "scenes" / "textures.glb")


def test_two_parts_are_the_halves_of_two_whole_pictures(scene, renderer):
    camera = Camera.framing(scene.center, scene.radius, SIZE[0] / SIZE[1])
    phong, pbr = Settings(mode="phong", background="none"), Settings()
    whole = {}
    for settings in (phong, pbr):
        renderer.draw(scene, camera, settings, SIZE)
        whole[settings.mode] = renderer.read_display(settings)
    renderer.draw(scene, camera, phong, SIZE, part=(0, 0, 40, 64))
    renderer.draw(scene, camera, pbr, SIZE, part=(40, 0, 56, 64))
    split = renderer.read_display(pbr)
    assert np.array_equal(split[:, :40], whole["phong"][:, :40])
    assert np.array_equal(split[:, 40:], whole["pbr"][:, 40:])
    assert not np.array_equal(whole["phong"], whole["pbr"])
    renderer.draw(scene, camera, pbr, SIZE)
    assert np.array_equal(renderer.read_display(pbr), whole["pbr"])


def test_two_parts_may_differ_in_samples(scene, renderer):
    """As at rest, where the quality supersamples mode pbr alone."""
    camera = Camera.framing(scene.center, scene.radius, SIZE[0] / SIZE[1])
    phong, pbr = Settings(mode="phong"), Settings(antialias="ssaa-4")
    whole = {}
    for settings in (phong, pbr):
        renderer.draw(scene, camera, settings, SIZE)
        whole[settings.mode] = renderer.read_display(settings)
    for _ in range(2):
        renderer.draw(scene, camera, phong, SIZE, part=(0, 0, 40, 64))
        renderer.draw(scene, camera, pbr, SIZE, part=(40, 0, 56, 64))
        split = renderer.read_display(pbr)
        assert np.array_equal(split[:, :40], whole["phong"][:, :40])
        assert np.array_equal(split[:, 40:], whole["pbr"][:, 40:])


def test_two_settings_in_turn_are_planned_once_each(scene, renderer):
    camera = Camera.framing(scene.center, scene.radius, SIZE[0] / SIZE[1])
    plans = []
    for settings in (Settings(), Settings(mode="phong")) * 2:
        renderer.draw(scene, camera, settings, SIZE)
        plans.append(renderer.plan)
    assert plans[0] is plans[2] and plans[1] is plans[3] and plans[0] is not plans[1]


def test_each_plan_keeps_its_own_shadows_and_environment(scene, renderer):
    """Frames in turn are the same as each for itself: two lights, two environments' rotations, two modes."""
    light = viewer.Light.from_angles(0.3, 0.8, 3.0)
    turned = replace(scene, lights=(light,), environment=replace(scene.environment, rotation=1.0))
    camera = Camera.framing(scene.center, scene.radius, SIZE[0] / SIZE[1])
    shots = [(scene, Settings()), (turned, Settings()), (turned, Settings(mode="phong"))]
    first = [renderer.display(s, camera, settings, SIZE).srgb for s, settings in shots]
    again = [renderer.display(s, camera, settings, SIZE).srgb for s, settings in shots]
    assert all(np.array_equal(a, b) for a, b in zip(first, again, strict=True))
    with open_context() as context:
        alone = Renderer(context)
        assert np.array_equal(first[2], alone.display(*shots[2][:1], camera, shots[2][1], SIZE).srgb)
        alone.release()
