"""shaders/bsdf/fresnel.glsl and multiscatter.glsl against Fresnel's equations and the furnace."""

from __future__ import annotations

import numpy as np
import pytest

ETA = np.array([1.0, 1.0001, 1.05, 1.33, 1.5, 2.4, 100.0, 1 / 1.5, 0.9999])
MU = np.concatenate([np.linspace(1e-3, 1, 200), [0.0, 1e-6]])


def fresnel(mu, eta):
    """Unpolarised reflectance of a dielectric by Snell's law (Born & Wolf, section 1.5.2)."""
    sine2 = (1 - mu**2) / eta**2
    transmitted = np.sqrt(np.maximum(1 - sine2, 0))
    with np.errstate(invalid="ignore"):
        s = (mu - eta * transmitted) / (mu + eta * transmitted)
        p = (eta * mu - transmitted) / (eta * mu + transmitted)
    return np.where(sine2 >= 1, 1.0, (s**2 + p**2) / 2)


def table() -> np.ndarray:
    mu, eta = (a.ravel().astype("f4").astype(float) for a in np.meshgrid(MU, ETA))
    return np.stack([mu, eta, 0 * mu, 0 * mu], axis=-1)


def test_exact_dielectric(evaluate):
    inputs = table()
    found = evaluate("bsdf/fresnel", "vec4(f_dielectric(i.x, i.y))", inputs)[:, 0]
    mu, eta = inputs[:, :2].T
    assert np.isfinite(found).all() and (found >= 0).all() and (found < 1 + 1e-6).all()
    assert (found[eta == 1] == 0).all()
    assert np.abs(found[(mu == 0) & (eta != 1)] - 1).max() < 1e-6
    clear = (eta != 1) & (mu > 0) & (np.abs(1 - (1 - mu**2) / eta**2) > 1e-4)  # not at the critical angle itself
    assert np.abs(found - fresnel(mu, eta))[clear].max() < 2e-5
    normal = (mu == 1) & (eta != 1)
    assert np.abs(found[normal] / ((eta[normal] - 1) / (eta[normal] + 1)) ** 2 - 1).max() < 1e-5


def test_matched_indices_keep_their_digits(evaluate):
    """At eta = 1.0001 the textbook form's numerators cancel; relative error is what tells."""
    mu = np.linspace(0.05, 1, 400).astype("f4").astype(float)
    eta = float(np.float32(1.0001))
    inputs = np.stack([mu, 0 * mu + eta, mu, mu], axis=-1)
    found = evaluate("bsdf/fresnel", "vec4(f_dielectric(i.x, i.y))", inputs)[:, 0]
    expected = fresnel(mu, eta)
    assert np.abs(found / expected - 1)[expected > 1e-11].max() < 1e-4


def test_schlick(evaluate):
    inputs = np.stack([MU, MU, MU, MU], axis=-1)
    found = evaluate("bsdf/fresnel", "vec4(f_schlick(vec3(0.04, 0.5, 1.0), vec3(1.0), i.x), 0.0)", inputs)[:, :3]
    f0 = np.array([0.04, 0.5, 1.0])
    assert np.abs(found - (f0 + (1 - f0) * (1 - MU[:, None]) ** 5)).max() < 1e-6
    # As good an approximation of glass as it is said to be, and no better.
    assert np.abs(found[:, 0] - fresnel(MU, 1.5)).max() == pytest.approx(0.036, abs=0.002)
    outside = evaluate("bsdf/fresnel", "vec4(f_schlick(vec3(0.04), vec3(1.0), i.x), 0.0)", inputs + [1e-3] * 4)[-3:, 0]
    assert np.isfinite(outside).all()


def test_schlick_mean(evaluate):
    x, weight = np.polynomial.legendre.leggauss(64)
    mu = (x + 1) / 2
    f0 = np.array([0.0, 0.04, 1.0])
    mean = 2 * ((f0 + (1 - f0) * (1 - mu[:, None]) ** 5) * (mu * weight / 2)[:, None]).sum(axis=0)
    expression = "vec4(f_schlick_mean(vec3(0.0, 0.04, 1.0), vec3(1.0)), 0.0)"
    found = evaluate("bsdf/fresnel", expression, np.zeros((1, 4)))[0, :3]
    assert np.abs(found - mean).max() < 1e-6


def test_compensation_makes_a_white_metal_white(evaluate):
    """Whatever single scattering loses comes back: Turquin's factor and Fdez-Aguera's share, at f0 = f90 = 1."""
    albedo = np.linspace(0.2, 1, 64)
    inputs = np.stack([albedo] * 4, axis=-1)
    direct = evaluate("bsdf/multiscatter", "vec4(turquin_factor(vec3(1.0), i.x), 0.0)", inputs)[:, 0] * albedo
    expression = "vec4(fdez_aguera_multiple(vec3(i.x), vec3(1.0), vec3(1.0), i.x), 0.0)"
    around = evaluate("bsdf/compare/fdez_aguera", expression, inputs)
    assert np.abs(direct - 1).max() < 1e-6
    assert np.abs(around[:, 0] + albedo - 1).max() < 1e-6
