"""Volumes too dense for the grid of scattered light: half-spaces in the sun, by other ways in float64."""

from __future__ import annotations

import math

import numpy as np
import pytest
from numpy.polynomial.legendre import leggauss
from shapes import orthographic

from viewer.gpu.call import call_glsl
from viewer.scene.light import Light
from viewer.scene.scene import Scene
from viewer.scene.volume import Volume

FILE, FUNCTION = "raster/dense_light.glsl", "half_space_fluence"


def fluence_by_differences(albedo: float, g: float, mu: float, depth: float) -> float:
    """phi / E at `depth` of the equation in shaders/raster/dense_light.glsl, on 4000 points, by Thomas's algorithm."""
    D, length, n = 1 / (3 * (1 - albedo * g)), depth + 25 / max(math.sqrt(3 * (1 - albedo)), 0.2), 4000
    h = length / n
    z = (np.arange(n) + 0.5) * h
    beam = np.exp(-z / mu)
    lower, upper = np.full(n, -D / h**2), np.full(n, -D / h**2)
    middle = np.full(n, 2 * D / h**2 + 1 - albedo)
    source = albedo * (1 + 3 * D * g) * beam
    # phi + 2 J = 0 at the face: with phi_0 half a step inside, and J = -D (phi_0 - phi_f) / (h / 2) + 3 D g a mu
    middle[0] -= D / h**2
    carried = 3 * D * g * albedo * mu
    pull = 2 * D / (h / 2)
    middle[0] += D / (h**2 / 2) * (1 - pull / (1 + pull))
    source[0] += D / (h**2 / 2) * (-2 * carried / (1 + pull))
    for i in range(1, n):
        w = lower[i] / middle[i - 1]
        middle[i] -= w * upper[i - 1]
        source[i] -= w * source[i - 1]
    phi = np.empty(n)
    phi[-1] = source[-1] / middle[-1]
    for i in range(n - 2, -1, -1):
        phi[i] = (source[i] - upper[i] * phi[i + 1]) / middle[i]
    return float(np.interp(depth, z, phi))


def h_function(albedo: float, mu: float) -> float:
    """Chandrasekhar 1960, section 36, by iteration."""
    x, w = leggauss(48)
    x, w = 0.5 * (x + 1), 0.5 * w
    h = np.ones_like(x)

    def at(m):
        return 1 / (math.sqrt(1 - albedo) + 0.5 * albedo * (w * x * h / (m[:, None] + x)).sum(axis=1))

    for _ in range(300):
        h = 0.5 * (h + at(x))
    return float(at(np.array([mu]))[0])


CASES = [(0.9, 0.0, 0.413, 1.0), (0.9, 0.0, 1.0, 0.05), (0.5, 0.3, 0.7, 2.0), (0.99, 0.4, 0.2, 4.0)]


@pytest.mark.parametrize(("albedo", "g", "mu", "depth"), CASES)
def test_light_below_a_face_obeys_the_diffusion_equation(context, albedo, g, mu, depth):
    found = float(call_glsl(FILE, FUNCTION, context=context, albedo=albedo, g=g, mu=mu, depth=depth))
    assert found == pytest.approx(fluence_by_differences(albedo, g, mu, depth), rel=0.01, abs=1e-4)


@pytest.mark.parametrize(("albedo", "mu"), [(0.9, 0.4), (0.9, 1.0), (0.99, 0.6), (0.3, 0.8)])
def test_light_at_a_face_is_that_of_transport_theory(context, albedo, mu):
    """H(mu) - 1 (Chandrasekhar 1960)."""
    found = float(call_glsl(FILE, FUNCTION, context=context, albedo=albedo, g=0.0, mu=mu, depth=0.0))
    assert found == pytest.approx(h_function(albedo, mu) - 1, rel=0.12)


@pytest.mark.parametrize("height", [0.45, 2.0])
def test_a_dense_cube_in_the_sun(radiance, height):
    """Its face is a half-space: a E / (4 pi) mu_0 / (mu + mu_0) H(mu) H(mu_0) (Chandrasekhar 1960, section 34)."""
    sun = np.array([0.3, 0.2, height]) / math.hypot(0.3, 0.2, height)
    cube = Volume.in_box(np.ones((1, 1, 1), np.float32), [[-1, -1, -1], [1, 1, 1]])
    model = Scene("cube", volumes=(cube,), lights=(Light("directional", intensity=math.pi, direction=tuple(-sun)),))
    camera = orthographic(azimuth=0.4, elevation=0.2, height=0.3)
    picture = radiance(model, camera, (8, 8), volume_density=60.0, volume_albedo=(0.9, 0.9, 0.3), background="none")
    mu, mu_0 = -camera.forward[2], sun[2]
    for channel, albedo in ((0, 0.9), (2, 0.3)):
        expected = albedo / 4 * mu_0 / (mu + mu_0) * h_function(albedo, mu) * h_function(albedo, mu_0)
        assert picture[..., channel].mean() == pytest.approx(expected, rel=0.08)
