"""What the shaders should give: the formulas in float64, from the papers (in long double where that cancels).

Each function takes arrays that broadcast. Angles enter by their cosines, distributions by the angle itself, so that
nothing is lost before the formula begins. Nothing here follows the shaders' own rearrangements.

tests/shaders/microfacet_twins.py writes the same formulas a second time, from other equations of the papers: a slip
that this file shared with the shaders would go unnoticed by `pbr-viewer check`, but not by the tests.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from ...bake.dfg import directional_albedo

Array = Any


def d_ggx(theta: Array, alpha: Array) -> Array:
    """Walter et al. 2007, eq. 33."""
    return alpha**2 / (np.pi * np.cos(theta) ** 4 * (alpha**2 + np.tan(theta) ** 2) ** 2)


def d_beckmann(theta: Array, alpha: Array) -> Array:
    """Walter et al. 2007, eq. 25."""
    return np.exp(-((np.tan(theta) / alpha) ** 2)) / (np.pi * alpha**2 * np.cos(theta) ** 4)


def d_blinn_phong(theta: Array, alpha: Array) -> Array:
    """Walter et al. 2007, eq. 30, with s = 2 / alpha^2 - 2; the power by a logarithm that keeps its digits."""
    s = 2 / alpha**2 - 2
    return (s + 2) / (2 * np.pi) * np.exp(s / 2 * np.log1p(-np.sin(theta) ** 2))


def lambda_ggx(mu: Array, alpha: Array) -> Array:
    """Heitz 2014, eq. 72, with a = mu / (alpha sin): (sqrt(1 + 1 / a^2) - 1) / 2."""
    return (np.sqrt(1 + alpha**2 * (1 - mu**2) / mu**2) - 1) / 2


def v_smith_ggx(NoV: Array, NoL: Array, alpha: Array) -> Array:
    """G2 / (4 NoV NoL), height-correlated (Heitz 2014, eq. 99)."""
    return 1 / ((1 + lambda_ggx(NoV, alpha) + lambda_ggx(NoL, alpha)) * 4 * NoV * NoL)


def v_smith_separable_ggx(NoV: Array, NoL: Array, alpha: Array) -> Array:
    """G1 G1 / (4 NoV NoL) (Heitz 2014, eq. 98)."""
    return 1 / ((1 + lambda_ggx(NoV, alpha)) * (1 + lambda_ggx(NoL, alpha)) * 4 * NoV * NoL)


def lambda_beckmann(mu: Array, alpha: Array) -> Array:
    """The rational fit of Walter et al. 2007, eq. 15, which is what the model is: Lambda = 1 / G1 - 1."""
    with np.errstate(divide="ignore", invalid="ignore"):
        a = mu / (alpha * np.sqrt(1 - mu**2))
        g1 = (3.535 * a + 2.181 * a**2) / (1 + 2.276 * a + 2.577 * a**2)
        return np.where(a < 1.6, 1 / g1 - 1, 0.0)


def v_smith_beckmann(NoV: Array, NoL: Array, alpha: Array) -> Array:
    """G2 / (4 NoV NoL), height-correlated."""
    return 1 / ((1 + lambda_beckmann(NoV, alpha) + lambda_beckmann(NoL, alpha)) * 4 * NoV * NoL)


def v_smith_separable_beckmann(NoV: Array, NoL: Array, alpha: Array) -> Array:
    return 1 / ((1 + lambda_beckmann(NoV, alpha)) * (1 + lambda_beckmann(NoL, alpha)) * 4 * NoV * NoL)


def v_cavity(NoV: Array, NoL: Array, NoH: Array, VoH: Array) -> Array:
    """Cook & Torrance 1982, eq. 2, over 4 NoV NoL."""
    g = np.minimum(1, np.minimum(2 * NoH * NoV / VoH, 2 * NoH * NoL / VoH))
    return g / (4 * NoV * NoL)


def f_schlick(f0: Array, f90: Array, mu: Array) -> Array:
    """Schlick 1994, eq. 15."""
    return f0 + (f90 - f0) * (1 - mu) ** 5


def f_dielectric(mu: Array, eta: Array) -> Array:
    """Fresnel's equations for unpolarised light, by Snell's law (Born & Wolf 1999, section 1.5.2)."""
    mu, eta = np.longdouble(mu), np.longdouble(eta)
    cos2_t = (eta**2 - 1 + mu**2) / eta**2
    cos_t = np.sqrt(np.maximum(cos2_t, 0))
    with np.errstate(divide="ignore", invalid="ignore"):
        r_s = (mu - eta * cos_t) / (mu + eta * cos_t)
        r_p = (eta * mu - cos_t) / (eta * mu + cos_t)
    return np.where(cos2_t < 0, 1.0, (r_s**2 + r_p**2) / 2).astype(np.float64)


def f_conductor(mu: Array, eta: Array, k: Array) -> Array:
    """Fresnel's equations with the complex index eta + i k."""
    mu, index = np.longdouble(mu), np.longdouble(eta) + 1j * np.longdouble(k)
    cos_t = np.sqrt(index**2 - 1 + mu**2) / index
    r_s = (mu - index * cos_t) / (mu + index * cos_t)
    r_p = (index * mu - cos_t) / (index * mu + cos_t)
    return ((np.abs(r_s) ** 2 + np.abs(r_p) ** 2) / 2).astype(np.float64)


def srgb_from_linear(c: Array) -> Array:
    """IEC 61966-2-1."""
    return np.where(c <= 0.0031308, 12.92 * c, 1.055 * np.maximum(c, 1e-30) ** (1 / 2.4) - 0.055)


def smith_lambda(w: Array, alpha: Array) -> Array:
    """Lambda of directions (..., 3) over facets of alpha (..., 2): Heitz 2014, eqs. 72 and 80."""
    projected2 = alpha[..., 0] ** 2 * w[..., 0] ** 2 + alpha[..., 1] ** 2 * w[..., 1] ** 2
    return (np.sqrt(1 + projected2 / w[..., 2] ** 2) - 1) / 2


def d_ggx_anisotropic(h: Array, alpha: Array) -> Array:
    """Walter et al. 2007, eq. 33, stretched as in Burley 2012, eq. 13."""
    tangent, across = h[..., 0] / h[..., 2] / alpha[..., 0], h[..., 1] / h[..., 2] / alpha[..., 1]
    return 1 / (np.pi * alpha[..., 0] * alpha[..., 1] * h[..., 2] ** 4 * (1 + tangent**2 + across**2) ** 2)


def ggx_reflection(wo: Array, wi: Array, alpha: Array) -> tuple[Array, Array]:
    """D G2 / (4 NoV NoL) and VoH for directions on one side (Walter et al. 2007, eq. 20, with F = 1)."""
    h = normalized(wo + wi)
    g2 = 1 / (1 + smith_lambda(wo, alpha) + smith_lambda(wi, alpha))
    dv = d_ggx_anisotropic(h, alpha) * g2 / (4 * wo[..., 2] * wi[..., 2])
    return dv, (wo * h).sum(axis=-1)


def ggx_transmission(wo: Array, wi: Array, alpha: Array, eta: Array) -> Array:
    """Radiance through a rough dielectric, Walter et al. 2007, eq. 21, with the shared heights of Heitz et al. 2016."""
    h = normalized(-(wo + eta[..., None] * wi))
    h = h * np.where(h[..., 2:] < 0, -1, 1)
    VoH, LoH = (wo * h).sum(axis=-1), (wi * h).sum(axis=-1)
    x, y = 1 + smith_lambda(wo, alpha), 1 + smith_lambda(wi, alpha)
    g2 = np.exp(_log_gamma(x) + _log_gamma(y) - _log_gamma(x + y))
    f = np.abs(VoH * LoH / (wo[..., 2] * wi[..., 2])) * eta**2 / (VoH + eta * LoH) ** 2
    return f * (1 - f_dielectric(np.abs(VoH), eta)) * d_ggx_anisotropic(h, alpha) * g2 / eta**2


def thin_walled_transmission(wo: Array, wi: Array, alpha: Array, eta: Array) -> Array:
    """Light that passes a thin wall, summed over the reflections inside: T^2 (1 + R^2 + R^4 + ...)."""
    dv, VoH = ggx_reflection(wo, wi * [1, 1, -1], alpha)
    R = f_dielectric(np.abs(VoH), eta)
    return dv * (1 - R) ** 2 / np.maximum(1 - R**2, 1e-300)


def eon(wo: Array, wi: Array, sigma: Array) -> Array:
    """White EON: Portsmouth, Kutz & Hill 2024, eqs. 13 to 29."""
    scale = 1 / (1 + (0.5 - 2 / (3 * np.pi)) * sigma)

    def albedo(mu: Array) -> Array:
        theta, s = np.arccos(np.minimum(mu, 1)), np.sqrt(np.maximum(1 - mu**2, 0))
        g = s * (theta - s * mu) + 2 / 3 * (s / mu * (1 - s**3) - s)
        return scale * (1 + sigma * g / np.pi)

    mean = scale * (1 + sigma * (2 / 3 - 28 / (15 * np.pi)))
    s = (wo * wi).sum(axis=-1) - wo[..., 2] * wi[..., 2]
    single = scale * (1 + sigma * s / np.where(s > 0, np.maximum(wo[..., 2], wi[..., 2]), 1))
    return (single + (1 - albedo(wo[..., 2])) * (1 - albedo(wi[..., 2])) / (1 - mean)) / np.pi


def burley(wo: Array, wi: Array, perceptual_roughness: Array) -> Array:
    """White, Burley 2012, section 5.3."""
    LoH = (wi * normalized(wo + wi)).sum(axis=-1)
    f90 = 0.5 + 2 * perceptual_roughness * LoH**2
    return (1 + (f90 - 1) * (1 - wi[..., 2]) ** 5) * (1 + (f90 - 1) * (1 - wo[..., 2]) ** 5) / np.pi


def standard_dielectric(wo: Array, wi: Array, alpha: Array) -> Array:
    """A white base under an interface of f0 = 0.04: D V F, Kulla & Conty 2017, and Kelemen & Szirmay-Kalos 2001.

    The albedos are integrals themselves, at 512 cosines for each alpha, which is one number for each wo.
    """
    dv, VoH = ggx_reflection(wo, wi, np.stack([alpha, alpha], axis=-1))
    f = dv * f_schlick(0.04, 1.0, VoH)
    NoV, NoL = (np.broadcast_to(w[..., 2], f.shape) for w in (wo, wi))
    for a in np.unique(alpha):
        chosen = np.broadcast_to(alpha == a, f.shape)
        f[chosen] += _plastic_diffuse(float(a), NoV[chosen], NoL[chosen])
    return f


def _plastic_diffuse(alpha: float, NoV: Array, NoL: Array) -> Array:
    """What `standard_dielectric` has beside D V F: scattered more than once by its facets, and from the base."""
    v = np.linspace(1e-2, 1, 512)
    rows = directional_albedo("ggx", "smith", v**2, alpha, 64)
    x, weight = np.polynomial.legendre.leggauss(32)
    mean = weight * (x + 1) / 2 @ directional_albedo("ggx", "smith", (x + 1) / 2, alpha, 64)
    E_mean, F_mean = mean.sum(), 0.04 + 0.96 / 21
    returned = F_mean**2 * E_mean / (1 - F_mean * (1 - E_mean))

    def lost(ab: Array) -> Array:
        return 1 - ab.sum(axis=-1)

    def through(ab: Array) -> Array:
        return 1 - 0.04 * ab[..., 0] - ab[..., 1] - returned * lost(ab)

    o, i = (np.stack([np.interp(np.sqrt(mu), v, part) for part in rows.T], axis=-1) for mu in (NoV, NoL))
    return (returned * lost(o) * lost(i) / lost(mean) + through(o) * through(i) / through(mean)) / np.pi


def normalized(v: Array) -> Array:
    return v / np.linalg.norm(v, axis=-1, keepdims=True)


_log_gamma = np.vectorize(math.lgamma, otypes=[np.float64])
