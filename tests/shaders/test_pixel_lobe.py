"""shaders/bsdf/pixel_lobe.glsl against D, and against its mean over normals of a Gaussian distribution, in float64."""

from __future__ import annotations

import numpy as np
import pytest

# Of alpha along both axes, and of slopes of h along one axis or both: without a spread, with the same one by both of
# the pixel's axes, which is the fourth input, or with another by each; and of one alpha, a slope, and alpha with the
# spread within a texel.
LOBE = "vec4(d_over_pixel(i.xy, sqrt(i.x * i.y), vec3(1, 0, 0), vec3(0, 0, 1), normalize(vec3({}, 1)), {}))"
FLAT = LOBE.format("i.zw", "vec3(0), vec3(0)")
ROUND = LOBE.format("i.z, 0", "vec3(i.w, 0, 0), vec3(0, i.w, 0)")
LONG = LOBE.format("i.zw", "vec3(0.5, 0.2, 0), vec3(0.1, 0, 0)")
WITHIN = "vec4(d_over_pixel(i.zw, i.x, vec3(1, 0, 0), vec3(0, 0, 1), normalize(vec3(i.y, 0, 1)), vec3(0), vec3(0)))"


def test_without_a_spread_it_is_the_distribution(evaluate):
    random = np.random.default_rng(1)
    slopes = random.normal(size=(200, 2)) * 10 ** random.uniform(-2, 0, (200, 1))
    alpha = random.uniform(0.05, 1, 200)
    inputs = np.column_stack([alpha, alpha, slopes])
    for ndf, name in enumerate(("ggx", "beckmann")):
        found = evaluate("bsdf/pixel_lobe", FLAT, inputs, defines={"NDF": ndf})[:, 0]
        plain = "vec4(d_{}(inversesqrt(1 + dot(i.zw, i.zw)), dot(i.zw, i.zw) / (1 + dot(i.zw, i.zw)), i.x))"
        expected = evaluate(f"bsdf/{name}", plain.format(name), inputs)[:, 0]
        assert np.allclose(found, expected, rtol=2e-4, atol=1e-20)
    inputs[:, 1] *= random.uniform(0.05, 1, 200)
    found = evaluate("bsdf/pixel_lobe", FLAT, inputs, defines={"NDF": 0})[:, 0]
    expected = evaluate("bsdf/ggx_local", "vec4(d_ggx_local(normalize(vec3(i.zw, 1)), i.xy))", inputs)[:, 0]
    assert np.allclose(found, expected, rtol=1e-3)


@pytest.mark.parametrize("alpha, spread", [(0.002, 0.05), (0.02, 0.1), (0.1, 0.1), (0.3, 0.2)])
def test_it_is_near_the_mean_over_normals(evaluate, alpha, spread):
    """GGX is a mean of Gaussians, (1 / pi) int e^-u u / alpha^2 exp(-u tan^2 / alpha^2) du over slopes, and each is
    widened alike: alpha^2 / u gains 2 sigma^2 = spread^2 / pi."""
    gain = spread**2 / np.pi
    slope = np.sqrt(alpha**2 + gain) * np.array([0.0, 0.3, 0.7, 1.0, 1.5, 2.0, 3.0, 5.0, 10.0, 100.0])
    inputs = np.column_stack([alpha + 0 * slope, alpha + 0 * slope, slope, spread + 0 * slope])
    found = evaluate("bsdf/pixel_lobe", ROUND, inputs, defines={"NDF": 0})[:, 0] / (1 + slope**2) ** 2
    u = np.exp(np.linspace(-40, 5, 20001))
    width = alpha**2 / u + gain
    mean = (np.exp(-u - slope[:, None] ** 2 / width) / width * u).sum(axis=1) * 45 / 20000 / np.pi
    ratio = found / mean
    assert ratio.min() > 0.4 and ratio.max() < 1.3  # GGX as wide as that is up to 800 times as bright
    assert ratio[[0, 1, 2, 3, 9]] == pytest.approx(np.ones(5), rel=0.25)


@pytest.mark.parametrize("ndf", [0, 1])
def test_normals_spread_within_a_texel_as_they_do_over_a_pixel(evaluate, ndf):
    alpha, slope, spread = (m.ravel() for m in np.meshgrid([0.01, 0.1, 0.5], np.linspace(0, 2, 20), [0.1, 0.5, 1.0]))
    over = evaluate("bsdf/pixel_lobe", ROUND, np.column_stack([alpha, alpha, slope, spread]), defines={"NDF": ndf})
    widened = np.sqrt(alpha**2 + spread**2 / np.pi)
    inputs = np.column_stack([alpha, slope, widened, widened])
    within = evaluate("bsdf/pixel_lobe", WITHIN, inputs, defines={"NDF": ndf})
    assert np.allclose(within, over, rtol=2e-4, atol=1e-20)


def test_the_lobe_gets_wider_as_its_mean_does(evaluate):
    """On return alpha is as much wider as the covariance A = alpha^2 + spread^2 / pi is, at most 1; and nothing is
    infinite for light that grazes the surface or comes from below."""
    along, across, spread, height = (m.ravel() for m in np.meshgrid(
        [0.02, 0.3, 1.0], [0.02, 0.3], [0.0, 0.1, 0.5, 10.0], [0.0, 1e-3, -0.5]))
    along = np.maximum(along, across)
    widened = """vec4 widened(vec4 i) {
        vec2 a = i.xy;
        vec3 n = vec3(0, 0, 1), h = normalize(vec3(0.6, 0.8, i.w));
        float d = d_over_pixel(a, sqrt(i.x * i.y), vec3(1, 0, 0), n, h, vec3(i.z, 0, 0), vec3(0, i.z, 0));
        return vec4(d, a, 0);
    }"""
    found = evaluate("bsdf/pixel_lobe", "widened(i)", np.column_stack([along, across, spread, height]), widened,
                     {"NDF": 0})
    assert np.isfinite(found).all() and (found[:, 0] >= 0).all()
    wider = np.sqrt(np.sqrt((along**2 + spread**2 / np.pi) * (across**2 + spread**2 / np.pi)) / (along * across))
    for k, alpha in ((1, along), (2, across)):
        assert np.allclose(found[:, k], np.minimum(alpha * wider, 1), rtol=1e-3)


@pytest.mark.parametrize("ndf, across", [(0, 0.05), (0, 0.01), (1, 0.05), (1, 0.01)])
def test_no_light_is_lost_or_won(evaluate, ndf, across):
    """D NoH is the density of facets by solid angle: NoH^4 D, over slopes, has the integral 1."""
    radius, phi = np.meshgrid(np.geomspace(1e-4, 100, 250), (np.arange(60) + 0.5) / 60 * 2 * np.pi)
    slopes = np.column_stack([(radius * np.cos(phi)).ravel(), (radius * np.sin(phi)).ravel()])
    inputs = np.column_stack([0.05 + 0 * slopes[:, 0], across + 0 * slopes[:, 0], slopes])
    area = radius.ravel() ** 2 * np.log(1e6) / 249 * 2 * np.pi / 60
    found = evaluate("bsdf/pixel_lobe", LONG, inputs, defines={"NDF": ndf})[:, 0]
    assert (found / (1 + (slopes**2).sum(axis=1)) ** 2 * area).sum() == pytest.approx(1, abs=0.01)
