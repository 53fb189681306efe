"""Lights that stand for what volumes emit: all of the light that leaves the volumes, where it leaves them."""

from __future__ import annotations

import math

import numpy as np
import pytest

from viewer.bake.volume_lights import volume_lights
from viewer.scene.medium import Medium
from viewer.scene.volume import Volume

BOX = [[-1, -2, -3], [2, 4, 7]]
FIRE = (3.0, 1.0, 0.0)


def power(lights) -> np.ndarray:
    return 4 * math.pi * sum(np.multiply(light.color, light.intensity) for light in lights)


def ball(density: float = 1.0, side: int = 32) -> Volume:
    centers = (np.arange(side) + 0.5) / side * 2 - 1
    squares = centers[:, None, None] ** 2 + centers[:, None] ** 2 + centers**2
    return Volume.in_box(np.where(squares < 1, density, 0).astype(np.float32), [[-1] * 3, [1] * 3])


def test_what_hides_nothing_sends_all_that_it_emits_from_where_it_does():
    values = np.random.default_rng(1).uniform(0, 1, (5, 3, 4)).astype(np.float32)
    values[values < 0.5] = 0
    volume = Volume.in_box(values, BOX)
    lights = volume_lights([volume], Medium(emission=FIRE))
    assert len(lights) == 8 and all(light.kind == "point" and light.radius > 0 for light in lights)
    assert power(lights) == pytest.approx(4 * math.pi * values.mean(dtype=float) * 3 * 6 * 10 * np.array(FIRE))
    index = np.argwhere(values)[:, ::-1]
    middle = np.average(index, axis=0, weights=values[values > 0]) * [3 / 4, 2, 2] + [-1 + 3 / 8, -1, -2]
    weights = [light.intensity for light in lights]
    assert np.average([light.position for light in lights], axis=0, weights=weights) == pytest.approx(middle, abs=0.1)


def test_one_light_for_a_ball_has_its_radius():
    [light] = volume_lights([ball()], Medium(emission=FIRE), count=1)
    assert light.position == pytest.approx((0, 0, 0), abs=0.03) and light.radius == pytest.approx(1, rel=0.02)


@pytest.mark.parametrize("depth", [0.5, 4.0, 12.0])
def test_a_ball_keeps_what_it_absorbs(depth):
    """A ball that absorbs shines as its mean opacity does: 4 pi^2 r^2 e times 1 - (1 - (1 + x) e^-x) 2 / x^2, with x
    its depth along a diameter."""
    lights = volume_lights([ball()], Medium((depth / 2,) * 3, emission=FIRE))
    opacity = 1 - 2 / depth**2 * (1 - (1 + depth) * math.exp(-depth))
    volume = float((ball().density > 0).mean()) * 8 / (4 / 3 * math.pi)  # voxels are no ball
    assert power(lights) == pytest.approx(
        4 * math.pi**2 * np.array(FIRE) / (depth / 2) * opacity * volume, rel=0.05)


def test_what_scatters_all_keeps_nothing_and_shines_from_its_faces():
    clear, white = (volume_lights([ball()], Medium((20.0,) * 3, (albedo,) * 3, g, emission=FIRE))
                    for albedo, g in ((1.0, 0.5), (0.0, 0.0)))
    assert power(clear) == pytest.approx(4 / 3 * math.pi * 4 * math.pi * np.array(FIRE), rel=0.03)
    assert power(white)[0] < 0.1 * power(clear)[0]
    for lights in (clear, white):
        assert np.mean([np.linalg.norm(light.position) for light in lights]) > 0.6


def test_volumes_share_the_lights_by_their_power():
    weak, strong = (Volume.in_box(np.full((2, 2, 2), value, np.float32), [[x, 0, 0], [x + 1, 1, 1]])
                    for value, x in ((0.5, -5), (2.0, 5)))
    lights = volume_lights([weak, strong], Medium(emission=FIRE))
    left = [light for light in lights if light.position[0] < 0]
    assert power(left)[0] / power(lights)[0] == pytest.approx(0.2, rel=0.01)
    assert 0 < len(left) < len(lights)


def test_nothing_shines_of_what_does_not_emit():
    assert not volume_lights([ball()], Medium((1.0,) * 3)) and not volume_lights([ball(0.0)], Medium(emission=FIRE))
