"""A background colour comes out as it was asked for, and only where nothing stands in front of it."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
import pytest

from viewer.base.resources import resource_folder
from viewer.gpu.context import open_context
from viewer.raster.renderer import Renderer
from viewer.scene.camera import Camera
from viewer.scene.load import load_scene
from viewer.scene.scene import Scene
from viewer.settings import Settings

BLUE = (51, 102, 153)
SIZE = (48, 48)


@pytest.fixture(scope="module")
def renderer() -> Iterator[Renderer]:
    with open_context() as context:
        yield Renderer(context, use_cache=False)


@pytest.fixture(scope="module")
def scene() -> Scene:
    return load_scene(resource_folder("assets") / "scenes" / "unlit.glb")


def picture(renderer: Renderer, scene: Scene, **settings):
    camera = Camera.framing(scene.center, scene.radius, 1.0)
    return renderer.render(scene, camera, Settings.of(**settings), SIZE)


@pytest.mark.parametrize("exposure", [0.0, 4.0])
@pytest.mark.parametrize("tonemap", ["neutral", "agx", "aces", "none"])
def test_the_colour_is_neither_exposed_nor_tone_mapped(renderer, scene, tonemap, exposure):
    image = picture(renderer, scene, background="#336699", tonemap=tonemap, exposure=exposure)
    bare = picture(renderer, scene, background="none", tonemap=tonemap, exposure=exposure)
    behind = bare.srgb[..., 3] == 0
    assert 100 < behind.sum() < behind.size - 100
    assert (image.srgb[behind] == (*BLUE, 255)).all()
    in_front = bare.srgb[..., 3] == 255
    assert np.array_equal(image.srgb[in_front], bare.srgb[in_front])


def test_at_an_edge_the_two_mix_as_light(renderer, scene):
    image, bare = (picture(renderer, scene, background=background) for background in ("#336699", "none"))
    edge = (bare.srgb[..., 3] > 0) & (bare.srgb[..., 3] < 255)
    assert edge.sum() > 20
    alpha = bare.srgb[edge][:, 3:] / 255
    light = [((np.divide(code, 255) + 0.055) / 1.055) ** 2.4 for code in (bare.srgb[edge][:, :3], BLUE)]
    expected = 255 * (1.055 * (alpha * light[0] + (1 - alpha) * light[1]) ** (1 / 2.4) - 0.055)
    assert np.abs(image.srgb[edge][:, :3] - expected).max() < 3  # dithered, and alpha has 8 bits


def test_radiance_gets_the_linear_colour(renderer, scene):
    image, bare = (picture(renderer, scene, background=background, exposure=2.0) for background in ("#336699", "none"))
    linear = ((np.divide(BLUE, 255) + 0.055) / 1.055) ** 2.4
    assert (image.linear[..., 3] == 1).all()
    expected = bare.linear[..., :3] + (1 - bare.linear[..., 3:]) * linear
    assert np.allclose(image.linear[..., :3], expected, atol=1e-6)


def test_another_colour_needs_no_other_plan(renderer, scene):
    picture(renderer, scene, background="#336699")
    plan = renderer.plan
    picture(renderer, scene, background="#ff0000")
    assert renderer.plan is plan
