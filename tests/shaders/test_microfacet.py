"""shaders/bsdf/: the distributions and masking functions against the papers' forms in float64."""

from __future__ import annotations

from math import erf

import numpy as np
import pytest

ALPHA = np.array([1e-4, 1e-3, 0.01, 0.045**2, 0.1, 0.5, 1.0])
NDF = ["ggx", "beckmann", "blinn_phong"]


def ggx(theta, alpha):
    """Walter et al. 2007, eq. 33."""
    return alpha**2 / (np.pi * np.cos(theta) ** 4 * (alpha**2 + np.tan(theta) ** 2) ** 2)


def beckmann(theta, alpha):
    """Walter et al. 2007, eq. 25."""
    return np.exp(-((np.tan(theta) / alpha) ** 2)) / (np.pi * alpha**2 * np.cos(theta) ** 4)


def blinn_phong(theta, alpha):
    """Walter et al. 2007, eq. 30, with its exponent from alpha."""
    s = 2 / alpha**2 - 2
    return (s + 2) / (2 * np.pi) * np.cos(theta) ** s


def lambda_ggx(mu, alpha):
    """Heitz 2014, eq. 72."""
    return (np.sqrt(1 + alpha**2 * (1 / mu**2 - 1)) - 1) / 2


def lambda_beckmann(mu, alpha):
    """Heitz 2014, eq. 68: not the rational fit that the shader takes."""
    a = mu / (alpha * np.sqrt(1 - mu**2))
    return (np.vectorize(erf)(a) - 1) / 2 + np.exp(-a * a) / (2 * a * np.sqrt(np.pi))


def d_inputs(theta, alpha) -> np.ndarray:
    return np.stack([np.cos(theta), np.sin(theta) ** 2, alpha, 0 * alpha], axis=-1)


@pytest.mark.parametrize(("ndf", "bound"), [("ggx", 2e-6), ("beckmann", 3e-5), ("blinn_phong", 3e-5)])
def test_distribution(evaluate, ndf, bound):
    # Angles in units of the lobe's own width, as wide as there is anything to see.
    theta, alpha = (a.ravel() for a in np.meshgrid(np.linspace(0, 1, 200) ** 2, ALPHA))
    theta = np.minimum(np.arctan(theta * alpha * (300 if ndf == "ggx" else 5)), np.pi / 2 - 1e-3)
    found = evaluate(f"bsdf/{ndf}", f"vec4(d_{ndf}(i.x, i.y, i.z))", d_inputs(theta, alpha))[:, 0]
    expected = globals()[ndf](theta, alpha)
    assert np.isfinite(found).all()
    seen = expected > 1e-9 * globals()[ndf](0 * theta, alpha)
    assert np.abs(found / expected - 1)[seen].max() < bound
    assert (found[~seen] <= 1e-8 * globals()[ndf](0 * theta, alpha)[~seen]).all()


@pytest.mark.parametrize("ndf", NDF)
@pytest.mark.parametrize("alpha", ALPHA)
def test_projected_area_of_the_microfacets_is_one(evaluate, ndf, alpha):
    """The integral of D NoH over the hemisphere (Walter et al. 2007, eq. 4)."""
    x, weight = np.polynomial.legendre.leggauss(200)
    s = (x + 1) / 2 * np.pi / 2
    theta = np.arctan(alpha * np.tan(s))
    jacobian = alpha * np.cos(theta) ** 2 / np.cos(s) ** 2 * weight * np.pi / 4
    d = evaluate(f"bsdf/{ndf}", f"vec4(d_{ndf}(i.x, i.y, i.z))", d_inputs(theta, 0 * theta + alpha))[:, 0]
    integral = 2 * np.pi * (d * np.cos(theta) * np.sin(theta) * jacobian).sum()
    assert integral == pytest.approx(1, abs=1e-5)


@pytest.fixture
def directions() -> np.ndarray:
    """NoV, NoL, alpha: from the normal to a millionth above the horizon."""
    mu = np.concatenate([np.linspace(1e-2, 0.9999, 20), [1e-3, 1e-4, 1e-6]])
    return np.stack([a.ravel() for a in np.meshgrid(mu, mu, ALPHA, [0.0])], axis=-1)


@pytest.mark.parametrize(("name", "ndf", "correlated", "bound"), [
    ("smith_ggx", "ggx", True, 3e-6), ("smith_separable_ggx", "ggx", False, 3e-6),
    ("smith_beckmann", "beckmann", True, 0.007), ("smith_separable_beckmann", "beckmann", False, 0.008)])
def test_smith(evaluate, directions, name, ndf, correlated, bound):
    """V = G2 / (4 NoV NoL), G2 = 1 / (1 + Lambda_v + Lambda_l) or G1 G1 (Heitz 2014, eqs. 99 and 98)."""
    found = evaluate(f"bsdf/{ndf}", f"vec4(v_{name}(i.x, i.y, i.z))", directions)[:, 0]
    NoV, NoL, alpha = directions[:, :3].astype("f4").astype(float).T
    lambda_v, lambda_l = ({"ggx": lambda_ggx, "beckmann": lambda_beckmann}[ndf](mu, alpha) for mu in (NoV, NoL))
    g2 = 1 / (1 + lambda_v + lambda_l) if correlated else 1 / ((1 + lambda_v) * (1 + lambda_l))
    assert np.isfinite(found).all()
    assert np.abs(found / (g2 / (4 * NoV * NoL)) - 1).max() < bound


def test_v_cavity(evaluate, directions):
    """Cook & Torrance 1982, eq. 2, for half vectors in the plane of n, v and l."""
    theta_v, theta_l = np.arccos(directions[:, :2].T)
    inputs = np.stack([*directions[:, :2].T, np.cos((theta_v - theta_l) / 2), np.cos((theta_v + theta_l) / 2)], axis=-1)
    found = evaluate("bsdf/v_cavity", "vec4(v_cavity(i.x, i.y, i.z, i.w), v_none(i.x, i.y), 0.0, 0.0)", inputs)
    NoV, NoL, NoH, VoH = inputs.T
    g = np.minimum(1, np.minimum(2 * NoH * NoV / VoH, 2 * NoH * NoL / VoH))
    assert np.abs(found[:, 0] / (g / (4 * NoV * NoL)) - 1).max() < 1e-5
    assert np.abs(found[:, 1] * 4 * NoV * NoL - 1).max() < 1e-5


@pytest.mark.parametrize("ndf", range(3))
@pytest.mark.parametrize("masking", range(4))
def test_every_choice_of_factors_is_the_one_named(evaluate, ndf, masking):
    """microfacet.glsl: the dispatcher returns the function its switches ask for."""
    inputs = np.random.default_rng(1).uniform(0.05, 1, (64, 4))
    defines = {"NDF": ndf, "MASKING": masking}
    expression = "vec4(d_microfacet(i.x, 0.3, i.y), v_microfacet(i.x, i.y, i.z, i.w, 0.4), 0.0, 0.0)"
    found = evaluate("bsdf/microfacet", expression, inputs, defines=defines)
    smith = "ggx" if ndf == 0 else "beckmann"
    v = (f"v_smith_{smith}(i.x, i.y, 0.4)", f"v_smith_separable_{smith}(i.x, i.y, 0.4)", "v_cavity(i.x, i.y, i.z, i.w)",
         "v_none(i.x, i.y)")[masking]
    expected_d = evaluate(f"bsdf/{NDF[ndf]}", f"vec4(d_{NDF[ndf]}(i.x, 0.3, i.y))", inputs)[:, 0]
    expected_v = evaluate("bsdf/v_cavity" if masking >= 2 else f"bsdf/{smith}", f"vec4({v})", inputs)[:, 0]
    assert np.allclose(found[:, :2], np.stack([expected_d, expected_v], axis=-1), rtol=1e-6)
