"""Light that is scattered in media: the diffusion equation, and the environment convolved with a phase function."""

from __future__ import annotations

from dataclasses import replace
from functools import partial

import numpy as np
import pytest
from media_twins import droplet_phase, henyey_greenstein

from viewer.bake.diffusion import scattered_light
from viewer.bake.irradiance import HEIGHT
from viewer.bake.many_lights import uniform_lights
from viewer.bake.phase import MAPS, scattered_sky
from viewer.bake.prefilter import MARGIN, row_angles
from viewer.bake.similarity import without_peak
from viewer.scene.equirect import texel_directions, texel_solid_angles
from viewer.scene.medium import Medium
from viewer.scene.phase import mean_cosine, spectrum

SIDE = 24


def ball(tau: float, directions: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """The extinction of a ball of radius 1 and optical depth `tau` to its middle, in a cube of side 2, and the
    transmittance from each cell along each direction."""
    points = np.moveaxis((np.indices((SIDE,) * 3)[::-1] + 0.5) / SIDE * 2 - 1, 0, -1)
    r2 = (points**2).sum(-1)
    along = points @ directions.T
    half = np.sqrt(np.maximum(1 - r2[..., None] + along**2, 0))
    length = np.maximum(half - along, 0) - np.maximum(-half - along, 0)
    return np.where(r2 < 1, tau, 0.0), np.exp(-tau * length)


@pytest.mark.parametrize("tau", [1e-4, 0.5, 3.0, 30.0])
@pytest.mark.parametrize("g", [0.0, 0.8])
def test_a_white_furnace_is_exact(tau, g):
    extinction, transmittance = ball(tau, uniform_lights(32, (1, 1, 1)).directions)
    arriving = transmittance.mean(-1)
    light = np.stack([4 * np.pi * arriving] * 3 + [arriving], axis=-1)
    flux = np.zeros((3, *light.shape))
    found = scattered_light(extinction, light, flux, 1 - arriving, 2 / SIDE, (1.0, 1.0, 1.0), g).fluence
    assert found[extinction > 0] == pytest.approx(
        np.repeat(4 * np.pi * (1 - arriving)[extinction > 0][:, None], 3, axis=1), rel=1e-3)


def test_a_grid_may_have_any_sides():
    """That of hair is no cube. With x and y exchanged it has the same light so."""
    rng = np.random.default_rng(5)
    extinction, light = rng.uniform(0, 4, (5, 8, 13)), rng.uniform(0, 1, (5, 8, 13, 4))
    flux, hidden = rng.uniform(-0.2, 0.2, (3, 5, 8, 13, 4)), rng.uniform(0.3, 1, (5, 8, 13))
    found = scattered_light(extinction, light, flux, hidden, 0.5, (0.9, 0.5, 0.2), 0.3)
    turned = scattered_light(extinction.swapaxes(1, 2), light.swapaxes(1, 2), flux[[1, 0, 2]].swapaxes(2, 3),
                             hidden.swapaxes(1, 2), 0.5, (0.9, 0.5, 0.2), 0.3)
    assert np.isfinite(found.fluence).all() and found.fluence.max() < 100
    np.testing.assert_allclose(found.fluence, turned.fluence.swapaxes(1, 2), rtol=1e-3, atol=1e-3)


@pytest.mark.parametrize(("tau", "albedo", "g"), [
    (0.5, 0.9, 0.0), (2.0, 0.9, 0.0), (2.0, 0.5, 0.0), (6.0, 0.95, 0.0), (6.0, 0.95, 0.7),
    (4.0, 0.95, -0.5)])
def test_a_sun_in_a_ball(tau, albedo, g):
    """All of the fluence at three points, against random walks that start there."""
    sun = np.array([[0.0, 1.0, 0.0]])
    directions = uniform_lights(32, (1, 1, 1)).directions
    medium = without_peak(Medium((tau,) * 3, (albedo,) * 3, g))
    extinction, open_ = ball(medium.sigma_t[0], directions)
    _, lit = ball(medium.sigma_t[0], sun)
    light = np.concatenate([np.repeat(lit, 3, axis=-1), open_.mean(-1, keepdims=True)], axis=-1)
    flux = np.zeros((3, *light.shape))
    flux[1] = -np.concatenate([lit, lit, lit, open_ @ directions[:, 1:2] / 32], axis=-1)
    found = scattered_light(extinction, light, flux, 1 - open_.mean(-1), 2 / SIDE, medium.albedo, medium.g).fluence
    total = found[..., 0] + lit[..., 0]
    for y in (-0.5, 0.0, 0.5):
        cell = round((y + 1) / 2 * SIDE)
        middle = total[SIDE // 2 - 1:SIDE // 2 + 1, cell - 1:cell + 1, SIDE // 2 - 1:SIDE // 2 + 1].mean()
        assert middle == pytest.approx(walks(tau, albedo, g, np.array([0.0, y, 0.0])), rel=0.3)


def walks(tau: float, albedo: float, g: float, start: np.ndarray, count: int = 4000) -> float:
    """The fluence at `start` under a sun of irradiance 1 from +Y, by walks against the direction of light."""
    rng = np.random.default_rng(1)
    points, weight = np.tile(start, (count, 1)), np.ones(count)
    direction = rng.normal(size=points.shape)
    total = np.exp(-tau * (1 - start[1]))
    for _ in range(200 if g > 0 else 60):
        direction /= np.linalg.norm(direction, axis=1, keepdims=True)
        points = points + direction * rng.exponential(1 / tau, (count, 1))
        weight = weight * ((points**2).sum(1) < 1) * albedo
        x, y, z = points.T
        depth = tau * (np.sqrt(np.maximum(1 - x * x - z * z, 0)) - y)
        phase = 4 * np.pi * henyey_greenstein(g, np.maximum(1 - direction[:, 1], 0))
        total += (weight * phase * np.exp(-np.maximum(depth, 0))).sum() / count
        direction = scattered(rng, direction, g)
    return total


def scattered(rng: np.random.Generator, direction: np.ndarray, g: float) -> np.ndarray:
    """Directions about `direction` (n, 3) by the phase function (Witt 1977), not of unit length."""
    u = rng.uniform(size=(len(direction), 1))
    mu = 2 * u - 1 if g == 0 else (1 + g * g - ((1 - g * g) / (1 - g + 2 * g * u)) ** 2) / (2 * g)
    across = np.cross(direction, rng.normal(size=direction.shape))
    across /= np.linalg.norm(across, axis=1, keepdims=True)
    return mu * direction + np.sqrt(np.maximum(1 - mu * mu, 0)) * across


@pytest.mark.parametrize("medium", [Medium(g=-0.99), Medium(g=0.0), Medium(g=1e-6), Medium(g=0.5), Medium(g=0.99),
                                    Medium(droplet_diameter=5.0), Medium(droplet_diameter=50.0)], ids=str)
def test_a_medium_without_its_forward_peak(medium):
    """It absorbs as much, and scatters as much out of the first moments of light."""
    medium = replace(medium, sigma_t=(3.0, 3.0, 3.0), albedo=(0.9, 0.9, 0.9))
    scaled = without_peak(medium)
    assert 0 <= scaled.albedo[0] <= 1 and 0 < scaled.sigma_t[0] <= 3
    orders = 3 if mean_cosine(medium) > 0 else 2
    for before, after in list(zip(spectrum(medium, 3), [1.0, scaled.g, 0.0]))[:orders]:
        assert scaled.sigma_t[0] * (1 - scaled.albedo[0] * after) == pytest.approx(3 * (1 - 0.9 * before))


def test_a_medium_of_several_albedos_without_its_forward_peak():
    scaled = without_peak(Medium((2.0, 2.0, 2.0), (1.0, 0.5, 0.0), 0.99))
    assert scaled.albedo[0] == pytest.approx(1) and scaled.albedo[2] == 0
    assert len(set(scaled.sigma_t)) == 1 and scaled.sigma_t[0] == pytest.approx(2 * (1 - 0.99**2))


@pytest.mark.parametrize("medium, phase", [
    *((Medium(g=g), partial(henyey_greenstein, g)) for g in (-0.5, 0.0, 0.6, 0.9)),
    (Medium(droplet_diameter=5.0), partial(droplet_phase, 5.0)),
], ids=["g -0.5", "g 0", "g 0.6", "g 0.9", "droplets"])
def test_the_environment_as_a_medium_scatters_it(medium, phase):
    """By quadrature over the texels of a map, at some of the directions."""
    rows = 128
    d = texel_directions(rows, 2 * rows)
    radiance = (0.5 + 0.4 * d + np.exp(8 * (d[..., :1] - 1))).astype(np.float32)
    margin = round(rows * MARGIN / (1 - 2 * MARGIN))
    level = np.concatenate([radiance[:margin], radiance, radiance[-margin:]])
    found = scattered_sky(level, medium).reshape(MAPS, HEIGHT, 2 * HEIGHT, 3)
    weights = texel_solid_angles(rows, 2 * rows)[:, None]
    for row, column in ((5, 3), (30, 64), (31, 100), (50, 10)):
        theta, phi = row_angles(HEIGHT)[row], 2 * np.pi * ((column + 0.5) / (2 * HEIGHT) - 0.5)
        axis = np.array([np.sin(theta) * np.cos(phi), np.cos(theta), np.sin(theta) * np.sin(phi)])
        scattered = radiance * (phase(1 - d @ axis) * weights)[..., None]
        assert found[0, row, column] == pytest.approx(scattered.sum((0, 1)), rel=0.02)
        for k in range(3):
            expected = (scattered * d[..., k, None]).sum((0, 1))
            assert found[1 + k, row, column] == pytest.approx(expected, abs=0.02 * scattered.sum() / 3)


def test_the_spectrum_of_a_phase_function():
    """Against the integral of p over Legendre polynomials."""
    mu, weight = np.polynomial.legendre.leggauss(2000)
    for medium, phase in ((Medium(g=0.7), partial(henyey_greenstein, 0.7)),
                          (Medium(droplet_diameter=20.0), partial(droplet_phase, 20.0))):
        found = spectrum(medium, 6)
        expected = [2 * np.pi * (phase(1 - mu) * np.polynomial.Legendre.basis(k)(mu) * weight).sum() for k in range(6)]
        assert found == pytest.approx(expected, abs=1e-6) and mean_cosine(medium) == pytest.approx(expected[1])
