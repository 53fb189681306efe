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


@pytest.mark.parametrize(("albedo", "g"), [(0.5, 0.3), (0.9, 0.0), (0.99, 0.4), (1.0, 0.0)])
def test_light_below_a_face_leaves_it_as_transport_theory_says(context, albedo, g):
    """The Laplace transform of the fluence, by quadrature, with H of Hapke 1981. At one angle there is a pole."""
    y = math.sqrt((1 - albedo) / (1 - albedo * g))
    x, w = leggauss(200)
    t = 0.5 * (x + 1)
    z, dz = 80 * t**3, 40 * w * 3 * t**2  # optical depths of the reduced extinction
    for mu in (0.2, 0.5 / max(y, 0.5), 1.0):
        phi = call_glsl(FILE, FUNCTION, context=context, albedo=albedo, g=g, mu=mu, depth=z / (1 - albedo * g))
        for nu in (0.4, 1.0):
            h = [(1 + 2 * m) / (1 + 2 * m * y) for m in (mu, nu)]
            expected = mu / (mu + nu) * (h[0] * h[1] - 1)
            assert (phi * np.exp(-z / nu) / nu * dz).sum() == pytest.approx(expected, rel=2e-3), (mu, nu)


@pytest.mark.parametrize(("albedo", "mu"), [(0.9, 0.4), (0.9, 1.0), (0.99, 0.6), (0.3, 0.8)])
def test_light_at_a_face_is_that_of_transport_theory(context, albedo, mu):
    """H(mu) - 1 (Chandrasekhar 1960)."""
    found = float(call_glsl(FILE, FUNCTION, context=context, albedo=albedo, g=0.0, mu=mu, depth=0.0))
    assert found == pytest.approx(h_function(albedo, mu) - 1, rel=0.1)


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
        assert picture[..., channel].mean() == pytest.approx(expected, rel=0.05)
