"""Light that fibres scatter to each other: their density, its optical depths, and a furnace."""

from __future__ import annotations

import math
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from viewer.bake.fibre import fibre_table
from viewer.bake.fibre_grid import FibreGrid, fibre_grid
from viewer.bake.fibre_medium import ORDERS, fibre_medium
from viewer.bake.hair_light import HairLight, HairMedium
from viewer.bake.many_lights import uniform_lights
from viewer.gpu.call import call_glsl
from viewer.scene.curves import Curves
from viewer.scene.fibre import Fibre, longitudinal_variance
from viewer.scene.light import Light

sys.path.append(str(Path(__file__).parents[1] / "shaders"))
from fibre_twin import longitudinal

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


@pytest.fixture(scope="module")
def white(grid) -> HairMedium:
    return HairMedium(grid, WHITE)


@pytest.fixture(scope="module")
def brown(grid) -> HairMedium:
    return HairMedium(grid, BROWN)


def row_of(direction: tuple[float, float, float], count: int = 200) -> Curves:
    """Parallel strands in a cube of side 1."""
    roots = np.random.default_rng(1).uniform(-0.5, 0.5, (count, 3))
    points = np.stack([roots, roots + 0.4 * np.array(direction)], axis=1).reshape(-1, 3)
    return Curves("row", points, np.full(2 * count, 0.01), 2 * np.arange(count + 1), np.zeros(count, bool))


def test_the_density_is_that_of_all_fibres(grid):
    curves = tuft()
    lengths = np.linalg.norm(curves.points[1::2] - curves.points[::2], axis=1)
    total = grid.density.sum() * grid.cell**2
    assert total == pytest.approx(2 * 0.01 * lengths.sum(), rel=0.05)  # other random strands
    filled = grid.centers[grid.density.ravel() > 0]
    assert (filled > curves.corners[0] - grid.cell).all() and (filled < curves.corners[7] + grid.cell).all()


def test_the_share_that_fibres_fill_is_that_of_their_volume(grid):
    curves = tuft()
    lengths = np.linalg.norm(curves.points[1::2] - curves.points[::2], axis=1)
    assert grid.filled.sum() * grid.cell**3 == pytest.approx(np.pi * 0.01**2 * lengths.sum(), rel=0.05)


def test_the_share_that_others_fill_is_that_of_all_less_the_fibres_own():
    """At the places of 4000 parallel fibres by chance, with values interpolated between cells."""
    x, z = np.random.default_rng(2).uniform(-0.5, 0.5, (2, 4000))
    ends = np.stack([np.stack([x, np.full(4000, y), z], axis=1) for y in (-0.5, 0.5)], axis=1).reshape(-1, 3)
    grid = fibre_grid([Curves("row", ends, np.full(8000, 0.005), 2 * np.arange(4001), np.zeros(4000, bool))])
    middle = grid.filled_by_others[:, grid.shape[1] // 2]
    at = np.stack([x, z], axis=1)[np.maximum(np.abs(x), np.abs(z)) < 0.4]
    at = (at - grid.low[[0, 2]]) / grid.cell - 0.5
    (i, k), (a, b) = np.floor(at).astype(int).T, (at % 1).T
    found = (1 - b) * ((1 - a) * middle[k, i] + a * middle[k, i + 1]) + b * (
        (1 - a) * middle[k + 1, i] + a * middle[k + 1, i + 1])
    assert found.mean() == pytest.approx(3999 * np.pi * 0.005**2, rel=0.02)


@pytest.mark.parametrize("degrees", [30, 60, 90, 120, 150, 180])
def test_what_hides_two_directions_in_common_is_the_area_of_both_strips(degrees):
    """By counting places on a grid, for fibres of radius 1. The strips begin at the place of the fibre that is seen."""
    steps = (np.arange(-900, 900) + 0.5) / 200
    y, z = np.meshgrid(steps, steps)
    sine, cosine = np.sin(np.radians(degrees)), np.cos(np.radians(degrees))
    seen = (z > 0) & (np.abs(y) < 1) | (y**2 + z**2 < 1)
    lit = (sine * y + cosine * z > 0) & (np.abs(cosine * y - sine * z) < 1)
    found = call_glsl("raster/depth_in_common.glsl", "depth_in_common", filled=np.pi, y=0.7 * sine, z=0.7 * cosine)
    assert float(found) == pytest.approx((seen & lit).sum() / 200**2, rel=2e-3)


def box_of_fibres() -> FibreGrid:
    density = np.pad(np.full((20, 16, 24), 0.3, np.float32), 1)
    none = np.zeros((6, *density.shape), np.float32)  # as if all fibres were across the light
    return FibreGrid(np.array([-1.0, -2.0, 0.5]), 0.1, density, none, none[:3], none[0])


@pytest.mark.parametrize("direction", [(0, 0, 1), (0, -1, 0), (0.6, -0.64, 0.48), (-0.36, 0.48, -0.8), (0.8, 0.6, 0)])
def test_the_depth_of_a_box_is_its_way_out(direction):
    box = box_of_fibres()
    direction = np.array(direction, float)
    low = box.low + 0.1
    high = low + 0.1 * np.array([24, 16, 20])
    centers = box.centers.reshape(22, 18, 26, 3)[1:-1, 1:-1, 1:-1]
    with np.errstate(divide="ignore", invalid="ignore"):
        ways = np.where(direction > 0, (high - centers) / direction, (low - centers) / direction)
    way = np.where(direction == 0, np.inf, ways).min(axis=-1)
    found = box.depth(direction)[1:-1, 1:-1, 1:-1]
    assert np.abs(found - 3 * way).mean() < 0.1 and found.mean() == pytest.approx(3 * way.mean(), rel=0.03)


def test_light_of_fibres_comes_through_those_before_them():
    """Of a layer at the top, from 3 cells on: nothing comes from below, and from above what the others leave of it."""
    box, kept = box_of_fibres(), np.array([1.0, 0.5])
    source = np.zeros((2, *box.shape), np.float32)
    source[:, :, -4:] = 2.0
    inside = np.s_[:, 11, 1:-4, 13]  # of a column in the middle
    above = box.gathered(np.array([0.0, 1, 0]), source, kept)[inside]
    before = 0.3 * (np.arange(13)[::-1] + 0.5) * kept[:, None]  # the optical depth up to the layer, 3 cells thick
    np.testing.assert_allclose(above, 2 * np.exp(-before) * (1 - np.exp(-0.9 * kept[:, None])), rtol=1e-4)
    assert not box.gathered(np.array([0.0, -1, 0]), source, kept)[inside].any()
    slanting = np.array([0.6, 0.64, -0.48])
    all_around = box.gathered(slanting, np.ones_like(source), kept)  # interpolated after the exponential, not before
    np.testing.assert_allclose(all_around[0], 1 - np.exp(-box.depth(slanting)), atol=0.05)


def test_a_far_point_is_a_direction(grid):
    direction = np.array([0.6, 0.64, -0.48])
    one, two = grid.depth(direction), grid.depth_to(direction * 1e4)
    assert np.abs(one - two).mean() < 0.2 * one.mean() and two.mean() == pytest.approx(one.mean(), rel=0.05)
    near = grid.depth_to(np.array([0.0, 0.5, 0.0]))
    assert near.max() < two.max() and near[grid.shape[0] // 2].min() < 0.2


@pytest.mark.parametrize("along", [(0, 1, 0), (0.6, 0, -0.8)])
def test_light_along_fibres_meets_few_of_them(along):
    row = fibre_grid((row_of(along),))
    direction = np.array([0.48, 0.6, 0.64])
    sine = math.sqrt(1 - (direction @ along)**2)
    np.testing.assert_allclose(row.extinction(direction), row.density * sine, rtol=1e-3, atol=1e-6)
    assert row.extinction(np.array(along)).max() < 1e-2 * row.density.max()
    point = np.array([0.3, 4e3, -0.2])
    far = row.depth(np.array([0.0, 1, 0])).mean()
    np.testing.assert_allclose(row.depth_to(point).mean(), far, rtol=0.05, atol=1e-3)


def test_a_fibre_does_not_hide_light_from_itself():
    """Among strands that stand by chance, as Poisson has it, the depth is that of the others."""
    rng = np.random.default_rng(3)
    count, radius = 300, 0.01
    roots = rng.uniform(-0.5, 0.5, (count, 3)) * (1, 0, 1)
    points = np.stack([roots, roots + (0, 1, 0)], axis=1).reshape(-1, 3)
    grid = fibre_grid((Curves("row", points, np.full(2 * count, radius), 2 * np.arange(count + 1),
                              np.zeros(count, bool)),))
    alone = fibre_grid((Curves("one", points[:2] * (0, 1, 0), np.full(2, radius), [0, 2], [False]),))
    np.testing.assert_allclose(grid.own[grid.density > 0], 0.71 * radius / grid.cell, rtol=1e-3)
    assert alone.depth(np.array([1.0, 0, 0]))[alone.density > 0].mean() < 0.35 * 2 * radius / alone.cell / 2
    across = np.array([0.6, 0.0, 0.8])
    at = ((roots - grid.low) / grid.cell).astype(int)
    found = grid.depth(across)[at[:, 2], grid.shape[1] // 2, at[:, 0]]
    apart = roots[:, None] - roots
    along, beside = apart @ -across, np.abs(apart @ np.array([0.8, 0, -0.6]))
    met = ((along > 0) & (beside < radius)).sum(axis=1)  # fibres on the way of light
    assert np.mean(met - found) == pytest.approx(0, abs=0.1)


def test_the_axis_of_fibres():
    axis, order = fibre_grid((row_of((0, -0.6, 0.8)),)).moments()
    filled = order[0] > 0
    np.testing.assert_allclose(axis[:, filled].T, np.tile([0, -0.6, 0.8], (filled.sum(), 1)), atol=1e-3)
    np.testing.assert_allclose(order[:, filled], 1, atol=1e-3)
    there, back = row_of((0, 1, 0)), row_of((0, -1, 0))
    _, order = fibre_grid((there, replace(back, points=back.points + (0, 0.4, 0)))).moments()
    filled = order[0] > 0  # two strands at each place, one up and one down
    assert order[1, filled].max() < 0.1 and order[2, filled].min() > 0.99


def test_white_fibres_in_a_furnace_scatter_what_they_hide(grid, white):
    light = white.lit((), uniform_lights(32, np.ones(3)))
    inside = grid.density > 0
    np.testing.assert_allclose(light.scattered[inside], 1, atol=5e-3)
    assert np.abs(light.inclined[inside]).max() < 0.02  # from all sides alike
    assert np.abs(light.across[inside]).max() < 0.05


def test_fibres_in_a_furnace_that_absorb_some_channels_scatter_the_others_whole(grid):
    """From no side more than from others, though each channel is hidden by another share."""
    red = HairMedium(grid, Fibre((0.0, 3.0, 10.0)))
    light, inside = red.lit((), uniform_lights(32, np.ones(3))), grid.density > 0
    assert red.medium.kept[0] < 0.8 * red.medium.kept.mean()
    scattered = light.scattered[inside][:, 0]
    assert np.abs(scattered - 1).max() < 0.08 and abs(scattered.mean() - 1) < 0.02
    assert np.abs(light.across[inside]).max() < 0.15


def test_the_upper_side_is_open_above(grid, white):
    top = white.open[:, -3][grid.density[:, -3] > 0]
    assert (top[:, 2] > 0).mean() > 0.95


def test_how_open_fibres_are_follows_the_depth_to_the_outside(grid, white):
    """In directions that were not fitted, so that deep fibres get no light from where others hide it."""
    inside = grid.density > np.quantile(grid.density[grid.density > 0], 0.3)
    axis = grid.moments()[0][:, inside]
    terms, passed = white.open[inside], []
    for d in uniform_lights(21, np.ones(3)).directions:
        found = np.clip(terms[:, 0] + terms[:, 1:4] @ d + terms[:, 4] * (d @ axis)**2, 1e-3, 1)
        passed.append((np.exp(1 - 1 / found), np.exp(-grid.depth(d)[inside])))
    found, right = np.array(passed).transpose(1, 0, 2)
    assert abs((found - right).mean()) < 0.02 and np.sqrt(np.square(found - right).mean()) < 0.1
    assert found[right < 0.1].mean() < right[right < 0.1].mean() + 0.05


def test_dark_fibres_scatter_less_and_lights_add_up(white, brown):
    sun = Light("directional", direction=(0, -1, 0), intensity=2.0, color=(1, 0.5, 0))
    lamp = Light("point", position=(0, 1e3, 0), intensity=2e6, color=(0, 0, 1))
    both, bright = brown.lit((sun, lamp), None).scattered, white.lit((sun, lamp), None).scattered
    assert (both <= bright + 1e-5).all() and both.mean() < 0.3 * bright.mean()
    np.testing.assert_allclose(bright[..., 2], bright[..., 0], rtol=0.1, atol=0.02 * bright.max())
    np.testing.assert_allclose(bright[..., 1], bright[..., 0] / 2, rtol=1e-3, atol=1e-4)
    aside = Light("spot", position=(0, 5, 0), direction=(0, 1, 0), intensity=9.0, outer_cone=0.5)
    assert not brown.lit((aside,), None).scattered.any()


def radiance_at(light: HairLight, where: np.ndarray, sine: float) -> np.ndarray:
    """The series of Legendre polynomials, over its mean."""
    orders = np.arange(1, ORDERS)
    legendre = np.polynomial.legendre.legvander(np.array([sine]), ORDERS - 1)[0, 1:]
    return 1 + light.inclined[where] @ ((2 * orders + 1) * legendre)


def test_light_keeps_its_inclination_between_parallel_fibres(grid, brown):
    """Sunlight that comes down at 45 degrees does not go up after it has been scattered, and little goes across."""
    sun = Light("directional", direction=(0.8**0.5 * 0.5**0.5, -0.5**0.5, 0.1**0.5))
    light = brown.lit((sun,), None)
    inside = grid.density > np.quantile(grid.density[grid.density > 0], 0.5)
    down, across, up = (radiance_at(light, inside, s).mean() for s in (0.7, 0.0, -0.7))
    assert down > 1.5 and across < 0.75 * down and up < 0.3 * down
    inside[:, grid.shape[1] // 2:] = False
    down, across = (radiance_at(light, inside, s).mean() for s in (0.7, 0.0))
    assert across < 0.22 * down  # less comes across in the lower half, where all of it comes from above


def test_light_between_fibres_comes_from_where_they_are_lit(grid, white):
    """Across the fibres, which stand: light along them is in the moments of their inclination."""
    sun = Light("directional", direction=(-0.8, -0.6, 0))
    across = white.lit((sun,), None).across[grid.density > np.quantile(grid.density[grid.density > 0], 0.5)]
    assert across[:, 0].mean() > 0.2 and (across[:, 0] > 0).mean() > 0.8
    assert np.abs(across[:, 1:].mean(axis=0)).max() < 0.1
    axis = np.moveaxis(grid.moments()[0], 0, -1)[grid.density > np.quantile(grid.density[grid.density > 0], 0.5)]
    np.testing.assert_allclose((across * axis).sum(axis=1), 0, atol=1e-5)


def test_the_medium_of_fibres():
    medium = fibre_medium(WHITE)
    np.testing.assert_allclose(medium.albedo, 1, atol=2e-3)
    assert (medium.kept > 0.2).all() and (medium.kept < 0.35).all()
    medium = fibre_medium(BROWN)
    assert 0.35 > medium.albedo[0] > medium.albedo[1] > medium.albedo[2] > 0.05 and (np.diff(medium.kept) > 0).all()


@pytest.mark.parametrize("tilt", [0.0, 0.1])
def test_what_fibres_do_to_the_inclination_of_light(tilt):
    """Against an integral over M: what light of the radiance P_l(sin theta_i) makes of the radiance towards theta_o,
    which reaches the next fibre from -theta_o."""
    fibre = Fibre((0.0, 0.0, 0.0), 0.4, 0.3, tilt)
    medium = fibre_medium(fibre)
    np.testing.assert_allclose(medium.inclined[0, :, 0], np.eye(ORDERS)[0], atol=1e-9)  # light from all around stays so
    theta = (np.arange(400) + 0.5) / 400 * math.pi - math.pi / 2
    measure = np.cos(theta) * math.pi / 400
    polynomials = np.polynomial.legendre.legvander(np.sin(theta), ORDERS - 1)
    table = fibre_table(fibre.beta_n, fibre.ior)[0].mean(axis=1, dtype=np.float64) * 2 * math.pi
    met = np.cos(theta) * measure / (np.cos(theta) @ measure)
    found = np.zeros((ORDERS, ORDERS))
    for p, turn in enumerate((2, -1, -4, 0)):
        share = met @ np.interp(np.cos(theta), np.linspace(0, 1, len(table)), table[:, p])
        v = longitudinal_variance(fibre.beta_m) * (1, 0.25, 4, 4)[p]
        mean = theta + turn * tilt  # with theta_o = -theta
        mean = np.arctan2(np.sin(mean), np.abs(np.cos(mean)))  # beyond a right angle on the other side
        M = np.stack([longitudinal(t, m, v) for t, m in zip(*np.broadcast_arrays(theta, mean[:, None]), strict=True)])
        found += share * (polynomials.T * measure) @ M @ (polynomials * (measure[:, None] * (np.arange(ORDERS) + 0.5)))
    straight = 1 - medium.kept[0]
    np.testing.assert_allclose(straight * np.eye(ORDERS) + (1 - straight) * medium.inclined[0], found, atol=0.02)


def test_what_goes_straight_on_counts_as_not_scattered(grid, brown, white):
    sun = Light("directional", direction=(0, -1, 0))
    depth = white.lit((sun,), None).depths[0]
    np.testing.assert_allclose(depth, grid.depth(np.array([0.0, 1, 0])), atol=1e-9)
    assert (brown.medium.kept > white.medium.kept).all()
