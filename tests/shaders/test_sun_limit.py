"""shaders/light/sun.glsl against means of GGX over what a pixel sees of a sun, in float64."""

from __future__ import annotations

import numpy as np
import pytest


def ggx(alpha, x, y):
    """Over slopes."""
    return alpha**2 / (np.pi * (alpha**2 + x**2 + y**2) ** 2)


@pytest.mark.parametrize("VoH", [1.0, 0.3, 0.05])
def test_a_sun_takes_an_ellipse_of_slopes(evaluate, VoH):
    alpha, radius = np.array([(a, r) for a in np.geomspace(2e-3, 1, 5) for r in (2e-3, 2e-2)]).T
    inputs = np.stack([alpha, radius**2, 0 * alpha + VoH, alpha], axis=-1)
    found = evaluate("light/sun", "vec4(max_sun_d(i.x, i.y, i.z, vec3(0.0), vec3(0.0)))", inputs)[:, 0]
    t, weight = np.polynomial.legendre.leggauss(200)
    t, weight = (1 + t[:, None]) / 2, weight[:, None] / 2
    phi = (np.arange(400) + 0.5) / 400 * 2 * np.pi
    for k, (a, r) in enumerate(zip(alpha, radius, strict=True)):
        x, y = t * r / 2 * np.cos(phi), t * r / 2 / VoH * np.sin(phi)
        assert found[k] == pytest.approx((ggx(a, x, y) * 2 * t * weight).sum() / len(phi), rel=1e-4)


def test_a_mirror_shows_the_sun_as_bright_as_it_is(evaluate):
    """f = D / (4 NoV NoL) where v, l and n lie in a plane, and the sun's irradiance is pi r^2 of its radiance."""
    VoH = np.linspace(0.05, 1, 20)
    inputs = np.stack([VoH, 0 * VoH, VoH, VoH], axis=-1)
    found = evaluate("light/sun", "vec4(max_sun_d(1e-5, 2.5e-5, i.x, vec3(0.0), vec3(0.0)))", inputs)[:, 0]
    assert found / (4 * VoH) * np.pi * 2.5e-5 == pytest.approx(np.ones(20), rel=1e-3)


def test_a_pixel_sees_a_parallelogram_of_slopes(evaluate):
    random = np.random.default_rng(1)
    edges = random.normal(size=(200, 4)) * 10 ** random.uniform(-1, 1, (200, 2)).repeat(2, axis=1)
    found = evaluate("light/sun", "vec4(max_sun_d(1.0, 0.0, 1.0, vec3(i.xy, 0.0), vec3(i.zw, 0.0)))", edges)[:, 0]
    s = (np.arange(200) + 0.5) / 200 - 0.5
    s, t = np.meshgrid(s, s)
    mean = np.array([ggx(1, s * x0 + t * y0, s * x1 + t * y1).mean() for x0, x1, y0, y1 in edges])
    assert (mean / found).min() > 0.88 and (mean / found).max() < 1.12
