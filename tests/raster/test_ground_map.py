"""The map of the ground: what the model hides of the environment's light, drawn once for all cameras."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from shapes import lopsided, moved, plate, scene, sphere

import viewer.raster.ground
from viewer.gpu.call import call_glsl
from viewer.raster.ground_map import to_map
from viewer.raster.renderer import Renderer
from viewer.scene.camera import Camera
from viewer.scene.material import Material
from viewer.settings import Settings

GREY = Material(metallic=0.0, perceptual_roughness=1.0, double_sided=True)
SIZE = (48, 40)


def still_life(offset=(0.0, 0.0, 0.0)):
    return scene((sphere(0, 16), moved(np.add(offset, (-0.5, 0.2, 0.3)), 0.5)), (plate(0), moved(offset)),
                 materials=(GREY,), environment=lopsided())


def shadow(renderer: Renderer, shown, height: float = 4.0, offset=(0.0, 0.0, 0.0)) -> np.ndarray:
    camera = replace(Camera.look_at(np.add(offset, (0.1, 5, 3)), offset), height=height)
    settings = Settings.of(background="none", ground="shadow", antialias="none", shadows="off")
    renderer.draw(shown, camera, settings, SIZE, half=False)
    return renderer.read_radiance()[..., 3]


def test_places_in_the_map(context):
    x = np.array([-1e6, -30, -1.001, -1, -0.7, 0, 1e-3, 0.999, 1, 1.5, 400])
    s = call_glsl("raster/ground_map.glsl", "to_map", x=x, context=context)
    np.testing.assert_allclose(s, to_map(x), rtol=1e-6)
    np.testing.assert_allclose(s[[3, 5, 8]], [-0.5, 0, 0.5], rtol=1e-6)
    assert np.abs(s).max() <= 1 and (np.diff(s) > 0).all()
    back = call_glsl("raster/ground_map.glsl", "from_map", s=s[1:], context=context)
    np.testing.assert_allclose(back, x[1:], rtol=1e-4)


@pytest.mark.parametrize("height", [4.0, 60.0])
def test_nothing_hides_a_light_outside_of_its_rectangle(renderer, monkeypatch, height):
    expected = shadow(renderer, still_life(), height)
    monkeypatch.setattr("viewer.raster.ground_map._shadow_boxes",
                        lambda scene, directions: np.tile([-1, -1, 1, 1], (len(directions), 1)))
    whole = shadow(renderer, still_life(), height)
    assert (whole > 0.01).mean() > 0.002 and (whole[whole < 1] > 0.0001).mean() > 0.02
    np.testing.assert_allclose(expected, whole, atol=1e-6)


def test_it_is_drawn_again_where_it_changes_alone(renderer, context, monkeypatch):
    drawn = 0
    draw = viewer.raster.ground.draw_ground_map

    def count(*arguments):
        nonlocal drawn
        drawn += 1
        return draw(*arguments)

    monkeypatch.setattr(viewer.raster.ground, "draw_ground_map", count)
    first = still_life()
    turned = replace(first, environment=replace(first.environment, rotation=1.0))
    pose = replace(first, instances=(replace(first.instances[0], transform=moved((0.3, 0.4, 0), 0.5)),
                                     *first.instances[1:]))
    pictures = []
    for number, shown in enumerate((first, turned, pose), 1):
        for height in (5.0, 4.0):
            picture = shadow(renderer, shown, height)
        assert drawn == number
        pictures.append(picture)
    for shown, picture in zip((first, turned, pose), pictures):
        other = Renderer(context)
        np.testing.assert_array_equal(shadow(other, shown), picture)
        other.release()
    for picture in pictures[1:]:
        assert np.abs(picture - pictures[0]).max() > 0.05


def test_it_moves_with_the_model(renderer):
    offset = (300.0, -20.0, 1000.0)
    here, there = shadow(renderer, still_life()), shadow(renderer, still_life(offset), offset=offset)
    np.testing.assert_allclose(there, here, atol=2e-3)
