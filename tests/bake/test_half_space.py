"""Half-spaces of a scattering medium against Chandrasekhar's H function and against random walks, in float64."""

from __future__ import annotations

import math

import numpy as np
import pytest
from numpy.polynomial.legendre import leggauss

from viewer.bake.half_space import internal_reflectance, returned_light
from viewer.bake.interior import decay_rate, interior_of
from viewer.bake.rough_boundary import RoughBoundary
from viewer.scene.medium import Medium

MEDIANS = 1.4705
"""The x at which 1 - e^-x / 4 - 3/4 e^(-x/3) is 1/2: half of Burley's profile lies within x / s."""


def isotropic(albedo: float) -> float:
    """1 - 2 sqrt(1 - a) int H mu dmu, by iteration of Chandrasekhar 1960, "Radiative Transfer", section 36 (eq. 14)."""
    x, w = leggauss(64)
    mu, w = 0.5 * (x + 1), 0.5 * w
    h = np.ones_like(mu)
    for _ in range(400):
        inverse = math.sqrt(1 - albedo) + 0.5 * albedo * (w * mu * h / (mu[:, None] + mu)).sum(axis=1)
        h = 0.5 * (h + 1 / inverse)
    return 1 - 2 * math.sqrt(1 - albedo) * float((w * h * mu).sum())


def fresnel(mu, eta):
    """By the amplitudes for the two polarizations; `eta` is the index of the far side over that of this one."""
    sine2 = (1 - mu**2) / eta**2
    far = np.sqrt(np.maximum(1 - sine2, 0))
    s, p = (mu - eta * far) / (mu + eta * far), (eta * mu - far) / (eta * mu + far)
    return np.where(sine2 >= 1, 1.0, 0.5 * (s * s + p * p))


def facet(wo: np.ndarray, eta: float, alpha: float, masking: str,
          rng: np.random.Generator) -> tuple[np.ndarray, np.ndarray]:
    """The direction in which a facet of GGX sends light that leaves along `wo`, z > 0, and its weight |wo . h| G2 /
    (NoV NoH): facets are drawn by D NoH (Walter et al. 2007, eqs. 35 and 41)."""
    u, phi = rng.random(len(wo)), 2 * math.pi * rng.random(len(wo))
    cosine = np.sqrt((1 - u) / (1 - u + alpha**2 * u))
    sine = np.sqrt(1 - cosine**2)
    h = np.stack([sine * np.cos(phi), sine * np.sin(phi), cosine], axis=1)
    c = np.maximum((wo * h).sum(axis=1), 1e-9)
    reflects = rng.random(len(wo)) < fresnel(c, eta)
    through = (c / eta - np.sqrt(np.maximum(1 - (1 - c * c) / eta**2, 0)))[:, None] * h - wo / eta
    wi = np.where(reflects[:, None], 2 * c[:, None] * h - wo, through)
    o, i = (0.5 * (np.sqrt(1 + alpha**2 * np.maximum(1 / w[:, 2] ** 2 - 1, 0)) - 1) for w in (wo, wi))
    if masking == "smith-separable":
        g2 = 1 / ((1 + o) * (1 + i))
    else:
        beta = np.vectorize(lambda x, y: math.exp(math.lgamma(x) + math.lgamma(y) - math.lgamma(x + y)),
                            otypes=[float])
        g2 = np.where(reflects, 1 / (1 + o + i), beta(1 + o, 1 + i))
    stays = (wi[:, 2] > 0) == reflects
    return wi, np.where(stays, c * g2 / (wo[:, 2] * cosine), 0.0)


def walk(albedo: float, g: float, ior: float, count: int = 12000, alpha: float = 0.0,
         masking: str = "") -> tuple[float, float, float]:
    """What comes out of the entered light by random walks, its standard error, and the median distance of the exits."""
    rng = np.random.default_rng(7)
    mu = np.sqrt(rng.random(count))
    if alpha > 0:
        d, weight = facet(np.stack([np.sqrt(1 - mu * mu), 0 * mu, mu], axis=1), ior, alpha, masking, rng)
        weight[d[:, 2] >= 0] = 0
    else:
        weight = 1 - fresnel(mu, ior)
        sine, phi = np.sqrt(1 - mu * mu) / ior, 2 * math.pi * rng.random(count)
        d = np.stack([sine * np.cos(phi), sine * np.sin(phi), -np.sqrt(1 - sine * sine)], axis=1)
    entered = weight.copy()
    p, out, far = np.zeros((count, 3)), np.zeros(count), np.zeros(count)
    left = np.flatnonzero(weight > 0)
    for _ in range(600):
        p[left] += d[left] * -np.log(1 - rng.random(len(left)))[:, None]
        up = left[p[left, 2] > 0]
        p[up] -= d[up] * (p[up, 2] / d[up, 2])[:, None]
        if alpha > 0:  # of what comes from below, z points down
            turned, share = facet(d[up] * [-1, -1, 1], 1 / ior, alpha, masking, rng)
            weight[up] *= share
            d[up] = turned * [1, 1, -1]
            escapes = d[up, 2] > 0
        else:
            escapes = rng.random(len(up)) >= fresnel(d[up, 2], 1 / ior)
            d[up[~escapes], 2] *= -1
        gone = up[escapes]
        out[gone], far[gone] = weight[gone], np.hypot(p[gone, 0], p[gone, 1])
        left = np.setdiff1d(left, up, assume_unique=True)
        weight[left] *= albedo
        d[left] = _scattered(d[left], g, rng)
        left = np.sort(np.concatenate([left, up[~escapes]]))
        faint = left[weight[left] < 0.02]
        lives = rng.random(len(faint)) < 0.25
        weight[faint[lives]] *= 4
        left = np.setdiff1d(left, faint[~lives], assume_unique=True)
    order = np.argsort(far[out > 0])
    total = np.cumsum(out[out > 0][order])
    median = far[out > 0][order][np.searchsorted(total, 0.5 * total[-1])]
    return out.sum() / entered.sum(), out.std() / entered.mean() / math.sqrt(count), float(median)


def _scattered(d: np.ndarray, g: float, rng: np.random.Generator) -> np.ndarray:
    s = 2 * rng.random(len(d)) - 1
    cosine = s if g == 0 else (1 + g * g - ((1 - g * g) / (1 + g * s)) ** 2) / (2 * g)
    side = np.where(np.abs(d[:, :1]) > 0.9, [[0.0, 1.0, 0.0]], [[1.0, 0.0, 0.0]])
    x = np.cross(d, side)
    x /= np.linalg.norm(x, axis=1, keepdims=True)
    phi, sine = 2 * math.pi * rng.random(len(d)), np.sqrt(np.maximum(1 - cosine**2, 0))
    return (cosine[:, None] * d + (sine * np.cos(phi))[:, None] * x + (sine * np.sin(phi))[:, None] * np.cross(d, x))


@pytest.mark.parametrize("albedo", [0.01, 0.5, 0.9, 0.99, 0.9999])
def test_isotropic_scattering_behind_no_boundary(albedo):
    assert abs(returned_light(albedo, 0.0, 1.0) - isotropic(albedo)) < 2e-4


@pytest.mark.parametrize(("albedo", "g", "ior"), [
    (0.97, 0.0, 1.4), (0.7, 0.0, 1.4), (0.99, 0.5, 1.33), (0.9, -0.5, 2.0)])
def test_light_behind_a_boundary_against_random_walks(albedo, g, ior):
    share, error, median = walk(albedo, g, ior)
    assert abs(returned_light(albedo, g, ior) - share) < 4 * error
    shape = interior_of(Medium((1.0,) * 3, (albedo,) * 3, g), ior).shape[0]
    if g >= 0:  # of what is scattered backwards, more comes out near by
        assert abs(MEDIANS / shape / median - 1) < 0.2


@pytest.mark.parametrize(("albedo", "alpha", "masking"), [(0.97, 0.3, "smith-separable"), (0.9, 0.6, "smith")])
def test_light_behind_a_rough_boundary_against_random_walks(albedo, alpha, masking):
    """What meets a second facet is lost: more than a tenth here."""
    rough = RoughBoundary(1.4, alpha, masking)
    share, error, _ = walk(albedo, 0.3, 1.4, 8000, alpha, masking)
    found = returned_light(albedo, 0.3, 1.4, rough)
    assert abs(found - share) < 4 * error < 0.05 and found < 0.9 * returned_light(albedo, 0.3, 1.4)


@pytest.mark.parametrize("masking", ["smith", "smith-separable"])
def test_rough_boundaries_keep_energy_and_reciprocity(masking):
    for alpha in (1e-3, 0.05, 0.3, 1.0):
        rough = RoughBoundary(1.5, alpha, masking)
        (inside, leaving), (outside, entering) = rough.shares(is_outside=False), rough.shares(is_outside=True)
        assert abs(entering - 1.5**2 * leaving) < 2e-3
        assert inside + leaving < 1 + 1e-9 and outside + entering < 1 + 1e-9
        if alpha == 1e-3:
            assert abs(inside - internal_reflectance(1.5)) < 2e-3 and inside + leaving > 0.998


def test_a_rough_boundary_that_becomes_smooth():
    medium = Medium((2.0,) * 3, (0.9, 0.99, 1.0), 0.4)
    smooth, nearly = interior_of(medium, 1.5), interior_of(medium, 1.5, 1.1e-3)
    assert smooth.kept == 1 and abs(nearly.kept - 1) < 0.01
    for a, b in ((smooth.extrapolation, nearly.extrapolation), (smooth.attenuation, nearly.attenuation)):
        assert np.allclose(a, b, rtol=0.02)


@pytest.mark.parametrize("ior", [1.0, 1.0001, 1.5, 3.0])
@pytest.mark.parametrize("g", [-0.99, 0.0, 0.99])
def test_white_media_keep_nothing_and_black_ones_all(g, ior):
    shares = [returned_light(albedo, g, ior) for albedo in (0.0, 1e-6, 0.1, 0.5, 0.9, 0.999, 1 - 1e-9, 1.0)]
    assert shares[0] == 0 and shares[-1] == 1
    assert np.all(np.diff(shares) > 0)


def test_what_a_boundary_reflects_inside():
    assert internal_reflectance(1.0) == 0
    mu = (np.arange(200000) + 0.5) / 200000
    assert abs(internal_reflectance(1.5) - 2 * np.mean(mu * fresnel(mu, 1 / 1.5))) < 1e-4


@pytest.mark.parametrize("albedo", [0.0, 0.01, 0.5, 0.99, 1 - 1e-5, 1 - 1e-9])
def test_light_dies_away_at_the_rate_of_transport_theory(albedo):
    k = decay_rate(albedo)
    assert k == 1 if albedo < 0.05 else abs(albedo * math.atanh(k) / k - 1) < 1e-6


@pytest.mark.parametrize("sigma_t", [0.0, 1e-6, 1.0, 1e12])
@pytest.mark.parametrize("albedo", [0.0, 1e-9, 0.5, 1.0])
@pytest.mark.parametrize("g", [-0.999, 0.0, 0.999])
def test_every_medium_has_finite_coefficients(sigma_t, albedo, g):
    for alpha in (0.0, 1.0):
        inside = interior_of(Medium((sigma_t,) * 3, (albedo,) * 3, g), 1.4, alpha)
        values = np.array([inside.attenuation, inside.extrapolation, inside.shape])
        assert np.isfinite(values).all() and (values >= 0).all() and 0 < inside.kept <= 1
