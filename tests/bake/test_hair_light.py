"""Light that fibres scatter to each other: their density, its optical depths, and a furnace."""

from __future__ import annotations

import math

import numpy as np
import pytest

from viewer.bake.hair_light import FibreGrid, fibre_grid, fibre_medium, hair_light
from viewer.bake.many_lights import uniform_lights
from viewer.scene.curves import Curves
from viewer.scene.fibre import Fibre
from viewer.scene.light import Light

RNG = np.random.default_rng(0)
WHITE, BROWN = Fibre((0.0, 0.0, 0.0)), Fibre((0.5, 0.9, 1.8))


def tuft(count: int = 400, radius: float = 0.01) -> Curves:
    """Strands that stand on a disc."""
    roots = RNG.uniform(-0.4, 0.4, (count, 3)) * (1, 0, 1)
    points = np.stack([roots, roots + RNG.normal(0, 0.05, (count, 3)) + (0, 1, 0)], axis=1).reshape(-1, 3)
    return Curves("tuft", points, np.full(2 * count, radius), 2 * np.arange(count + 1), np.zeros(count, bool))


@pytest.fixture(scope="module")
def grid() -> FibreGrid:
    return fibre_grid((tuft(),))


def test_the_density_is_that_of_all_fibres(grid):
    curves = tuft()
    lengths = np.linalg.norm(curves.points[1::2] - curves.points[::2], axis=1)
    total = grid.extinction.sum() * grid.cell**3
    assert total == pytest.approx(2 * 0.01 * lengths.sum() * math.pi / 4, rel=0.05)  # other random strands
    filled = grid.centers[grid.extinction.ravel() > 0]
    assert (filled > curves.corners[0] - grid.cell).all() and (filled < curves.corners[7] + grid.cell).all()


@pytest.mark.parametrize("direction", [(0, 0, 1), (0, -1, 0), (0.6, -0.64, 0.48), (-0.36, 0.48, -0.8), (0.8, 0.6, 0)])
def test_the_depth_of_a_box_is_its_way_out(direction):
    box = FibreGrid(np.array([-1.0, -2.0, 0.5]), 0.1, np.pad(np.full((20, 16, 24), 3.0), 1))
    direction = np.array(direction, float)
    low = box.low + 0.1
    high = low + 0.1 * np.array([24, 16, 20])
    centers = box.centers.reshape(22, 18, 26, 3)[1:-1, 1:-1, 1:-1]
    with np.errstate(divide="ignore", invalid="ignore"):
        ways = np.where(direction > 0, (high - centers) / direction, (low - centers) / direction)
    way = np.where(direction == 0, np.inf, ways).min(axis=-1)
    found = box.depth(direction)[1:-1, 1:-1, 1:-1]
    assert np.abs(found - 3 * way).mean() < 0.1 and found.mean() == pytest.approx(3 * way.mean(), rel=0.03)


def test_a_far_point_is_a_direction(grid):
    direction = np.array([0.6, 0.64, -0.48])
    one, two = grid.depth(direction), grid.depth_to(direction * 1e4)
    assert np.abs(one - two).mean() < 0.2 * one.mean() and two.mean() == pytest.approx(one.mean(), rel=0.05)
    near = grid.depth_to(np.array([0.0, 0.5, 0.0]))
    assert near.max() < two.max() and near[grid.extinction.shape[0] // 2].min() < 0.2


def test_white_fibres_in_a_furnace_scatter_what_they_hide(grid):
    light = hair_light(grid, WHITE, (), uniform_lights(32, np.ones(3)))
    scattered, hidden = light.scattered, light.hidden
    inside = grid.extinction > 0
    np.testing.assert_allclose(scattered[inside], np.tile(hidden[inside][:, :1], 3), atol=2e-3)
    assert hidden[inside][:, 0].max() > 0.7 and hidden[..., 0].min() >= 0


def test_the_upper_side_hides_what_is_below(grid):
    hidden = hair_light(grid, WHITE, (), None).hidden
    top = hidden[:, -3][grid.extinction[:, -3] > 0]
    assert (top[:, 2] < 0).mean() > 0.95


def test_dark_fibres_scatter_less_and_lights_add_up(grid):
    sun = Light("directional", direction=(0, -1, 0), intensity=2.0, color=(1, 0.5, 0))
    lamp = Light("point", position=(0, 1e3, 0), intensity=2e6, color=(0, 0, 1))
    both = hair_light(grid, BROWN, (sun, lamp), None).scattered
    white = hair_light(grid, WHITE, (sun, lamp), None).scattered
    assert (both <= white + 1e-5).all() and both.mean() < 0.3 * white.mean()
    np.testing.assert_allclose(white[..., 2], white[..., 0], rtol=0.1, atol=0.02 * white.max())
    np.testing.assert_allclose(white[..., 1], white[..., 0] / 2, rtol=1e-3, atol=1e-4)
    aside = Light("spot", position=(0, 5, 0), direction=(0, 1, 0), intensity=9.0, outer_cone=0.5)
    assert not hair_light(grid, BROWN, (aside,), None).scattered.any()


def test_the_medium_of_fibres():
    (red, green, blue), g = fibre_medium(WHITE)
    assert (red, green, blue) == pytest.approx((1, 1, 1), abs=2e-3) and 0.5 < g < 0.9
    (red, green, blue), _ = fibre_medium(BROWN)
    assert 0.5 > red > green > blue > 0.05


def test_what_goes_straight_on_counts_as_not_scattered(grid):
    sun = Light("directional", direction=(0, -1, 0))
    light = hair_light(grid, WHITE, (sun,), None)
    g = fibre_medium(WHITE)[1]
    assert light.onward == pytest.approx(1 - g * g, abs=1e-3)
    np.testing.assert_allclose(light.depths[0], grid.depth(np.array([0.0, 1, 0])) * light.onward, atol=1e-9)
    assert hair_light(grid, BROWN, (), None).onward > light.onward
