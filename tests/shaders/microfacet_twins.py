"""Microfacets, the equations of Fresnel and their albedos in float64, from the papers, of which lobes are made.

Directions are (..., 3) in the local frame, z the normal; functions without a struct take arrays of one shape.
"""

from __future__ import annotations

from functools import cache, lru_cache
from math import lgamma

import numpy as np

_log_gamma = np.vectorize(lgamma, otypes=[float])


def dot(a, b):
    return (a * b).sum(axis=-1)


def unit(v):
    return v / np.linalg.norm(v, axis=-1, keepdims=True)


def schlick(f0, f90, mu):
    """Schlick 1994, eq. 15; colours (..., 3), mu (...)."""
    return f0 + (f90 - f0) * (1 - np.asarray(mu)[..., None]) ** 5


def fresnel(mu, index):
    """Unpolarised reflectance at an interface of relative complex `index` (Born & Wolf, sections 1.5.2 and 14.2)."""
    index = np.asarray(index, complex)
    transmitted = np.sqrt(1 - (1 - mu**2) / index**2)
    s = (mu - index * transmitted) / (mu + index * transmitted)
    p = (index * mu - transmitted) / (index * mu + transmitted)
    return (np.abs(s) ** 2 + np.abs(p) ** 2) / 2


def f82_tint(f0, tint, mu):
    """Kutz et al. 2021: Schlick's curve less a multiple of mu (1 - mu)^6 that makes it `tint` times itself at 1/7."""
    mu = np.asarray(mu)[..., None]
    bar = 1 / 7
    s_bar = f0 + (1 - f0) * (1 - bar) ** 5
    b = s_bar * (1 - tint) / (bar * (1 - bar) ** 6)
    return np.maximum(f0 + (1 - f0) * (1 - mu) ** 5 - b * mu * (1 - mu) ** 6, 0)


def hemispherical_mean(f, nodes: int = 200):
    """2 int f(mu) mu dmu."""
    x, weight = np.polynomial.legendre.leggauss(nodes)
    return sum(w * (t + 1) / 2 * f((t + 1) / 2) for t, w in zip(x, weight))


def ggx_d(h, alpha):
    """Heitz 2014, eqs. 83 to 85: the density of slopes over cos^4."""
    slope = -h[..., :2] / h[..., 2:]
    p22 = 1 / (np.pi * alpha[..., 0] * alpha[..., 1] * (1 + ((slope / alpha) ** 2).sum(axis=-1)) ** 2)
    return p22 / h[..., 2] ** 4


def ggx_lambda(w, alpha):
    """Heitz 2014, eqs. 72 and 86, by the roughness along w and the tangent of its angle."""
    s2 = w[..., 0] ** 2 + w[..., 1] ** 2
    projected2 = np.where(s2 > 0, ((alpha * w[..., :2]) ** 2).sum(axis=-1) / np.maximum(s2, 1e-300), 0)
    return _ggx_lambda_of(projected2 * s2 / w[..., 2] ** 2)


def _ggx_lambda_of(x):
    """By x = (alpha tan theta)^2."""
    return np.where(x > 1e-6, (np.sqrt(1 + x) - 1) / 2, x / 4 - x * x / 16)


def ggx_reflection(alpha, wo, wi):
    """D G2 / (4 NoV NoL) and VoH."""
    h = unit(wo + wi)
    g2 = 1 / (1 + ggx_lambda(wo, alpha) + ggx_lambda(wi, alpha))
    return ggx_d(h, alpha) * g2 / (4 * wo[..., 2] * wi[..., 2]), dot(wo, h)


def beta(x, y):
    return np.exp(_log_gamma(x) + _log_gamma(y) - _log_gamma(x + y))


def ggx_albedo(NoV, alpha: float, f0=1.0, f90=1.0):
    """Directional albedo by Heitz 2018's visible normals ("Sampling the GGX Distribution of Visible Normals").

    On a Fibonacci lattice, to 3e-4.
    """
    white, grazing = _ggx_albedos(tuple(np.asarray(NoV, float).ravel()), alpha)
    return f0 * (white - grazing) + f90 * grazing  # Schlick's F is linear in f0 and f90


@lru_cache(maxsize=256)
def _ggx_albedos(cosines: tuple[float, ...], alpha: float):
    """The albedo at F = 1, and at f0 = 0, f90 = 1."""
    out = np.empty((2, len(cosines)))
    for k, NoV in enumerate(cosines):
        VoH, share = visible_normals(NoV, alpha)
        out[:, k] = share.sum(), (share * (1 - VoH) ** 5).sum()
    return out


@cache
def _disk():
    """A Fibonacci lattice on the unit disk: its points x and y, and sqrt(1 - x^2)."""
    i = np.arange(17711)
    u1, u2 = (i + 0.5) / len(i), (i * 10946 / len(i)) % 1
    r, phi = np.sqrt(u1), 2 * np.pi * u2
    x = r * np.cos(phi)
    return x, r * np.sin(phi), np.sqrt(np.maximum(1 - x**2, 0))


@lru_cache(maxsize=256)
def visible_normals(NoV: float, alpha: float):
    """VoH of visible normals that reflect upwards, and G2 / G1(o) over their number.

    Heitz 2018's steps by components: o and v lie in the plane of x and z, and T1 is along y.
    """
    p1, across, side = _disk()
    o_x, o_z = np.sqrt(1 - NoV**2), NoV
    v_x, v_z = np.array([alpha * o_x, o_z]) / np.hypot(alpha * o_x, o_z)
    s = (1 + v_z) / 2
    p2 = (1 - s) * side + s * across
    along_v = np.sqrt(np.maximum(1 - p1**2 - p2**2, 0))
    h_x, h_y, h_z = alpha * (along_v * v_x - p2 * v_z), alpha * p1, np.maximum(along_v * v_z + p2 * v_x, 1e-9)
    length = np.sqrt(h_x**2 + h_y**2 + h_z**2)
    OoH = (o_x * h_x + o_z * h_z) / length
    wi_z = 2 * OoH * h_z / length - o_z
    up = wi_z > 1e-12
    lambda_o, lambda_i = (_ggx_lambda_of(alpha**2 * (1 - z**2) / z**2) for z in (o_z, wi_z[up]))
    return np.clip(OoH[up], 0, 1), (1 + lambda_o) / (1 + lambda_o + lambda_i) / len(p1)


@lru_cache
def ggx_mean_albedo(alpha: float, f0=1.0, f90=1.0) -> float:
    x, weight = np.polynomial.legendre.leggauss(24)
    mu = (x + 1) / 2
    return float((weight * mu * ggx_albedo(mu, alpha, f0, f90)).sum())


def kulla_conty(alpha: float, mean, NoV, NoL):
    """Kulla & Conty 2017, isotropic; `mean` (..., 3) is the hemispherical mean of F."""
    return compensation(mean, ggx_mean_albedo(alpha), ggx_albedo(NoV, alpha), ggx_albedo(NoL, alpha))


def compensation(mean, E_mean, E_o, E_i):
    """The same for given albedos."""
    scale = mean**2 * E_mean / (1 - mean * (1 - E_mean))
    return scale * ((1 - E_o) * (1 - E_i) / (np.pi * (1 - E_mean)))[..., None]


def stretched_albedo(w, alphas: tuple[float, float], f0=1.0, f90=1.0):
    """Directional albedo of an anisotropic lobe for directions w (..., 3), by Heitz 2018's visible normals."""
    found = np.array([_stretched_albedos(*map(float, direction), *alphas) for direction in w.reshape(-1, 3)])
    white, grazing = found.T.reshape(2, *w.shape[:-1])
    return f0 * (white - grazing) + f90 * grazing


@cache
def _stretched_albedos(x: float, y: float, z: float, alpha_x: float, alpha_y: float):
    """As `_ggx_albedos`. Listing 1 of Heitz 2018, with T1 in the plane of x and y."""
    alphas, wo = np.array([alpha_x, alpha_y]), np.array([x, y, z])
    v = unit(wo * [alpha_x, alpha_y, 1])
    first = unit(np.array([-v[1], v[0], 0])) if np.hypot(x, y) > 0 else np.array([1.0, 0, 0])
    t1, across, side = _disk()
    s = (1 + v[2]) / 2
    t2 = (1 - s) * side + s * across
    t3 = np.sqrt(np.maximum(1 - t1**2 - t2**2, 0))
    h = np.outer(t1, first) + np.outer(t2, np.cross(v, first)) + np.outer(t3, v)
    h = unit(np.column_stack([h[:, :2] * alphas, np.maximum(h[:, 2], 1e-9)]))
    VoH = h @ wo
    wi = 2 * VoH[:, None] * h - wo
    wi, VoH = wi[wi[:, 2] > 1e-12], np.clip(VoH[wi[:, 2] > 1e-12], 0, 1)
    lambda_o, lambda_i = ggx_lambda(wo, alphas), ggx_lambda(wi, alphas)
    share = (1 + lambda_o) / (1 + lambda_o + lambda_i) / len(t1)
    return share.sum(), (share * (1 - VoH) ** 5).sum()


@cache
def stretched_mean_albedo(alphas: tuple[float, float], f0=1.0, f90=1.0) -> float:
    """2 int E mu dmu, and the mean over azimuths."""
    x, weight = np.polynomial.legendre.leggauss(12)
    mu, phi = (x + 1) / 2, (np.arange(8) + 0.5) / 8 * np.pi / 2
    s = np.sqrt(1 - mu**2)[:, None]
    w = np.stack([s * np.cos(phi), s * np.sin(phi), mu[:, None] + 0 * phi], axis=-1)
    return float(weight * mu @ stretched_albedo(w, alphas, f0, f90).mean(axis=1))
