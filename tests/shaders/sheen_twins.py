"""The fibres of a sheen in float64, from the papers, as twins.py has the lobes."""

from __future__ import annotations

from functools import lru_cache

import numpy as np
from microfacet_twins import unit


def charlie_lobe(wo, wi, r):
    """Estevez & Kulla 2017, eqs. 2 and 3, without the limit at grazing angles; `r` is the perceptual roughness."""
    a, mu_h = r * r, unit(wo + wi)[..., 2]
    d = (2 + 1 / a) / (2 * np.pi) * np.exp(np.log(np.maximum(1 - mu_h**2, 1e-300)) / (2 * a))

    def L(x):
        fitted = [(21.5473, 25.3245), (3.82987, 3.32435), (0.19823, 0.16801), (-1.9776, -1.27393), (-4.32054, -4.85967)]
        A, B, C, D, E = (smooth * (1 - a) ** 2 + rough * (1 - (1 - a) ** 2) for rough, smooth in fitted)
        return A / (1 + B * x**C) + D * x + E

    def Lambda(mu):
        return np.exp(np.where(mu < 0.5, L(np.minimum(mu, 0.5)), 2 * L(0.5) - L(1 - np.maximum(mu, 0.5))))

    return d / ((1 + Lambda(wo[..., 2]) + Lambda(wi[..., 2])) * 4 * wo[..., 2] * wi[..., 2])


@lru_cache(maxsize=8)
def charlie_albedos(r: float):
    """Cosines and the directional albedo there."""
    x, weight = np.polynomial.legendre.leggauss(64)
    mu, phi = ((x + 1) / 2) ** 2, (np.arange(128) + 0.5) / 128 * np.pi
    weights = (weight * (x + 1) / 2 * mu)[:, None] * 2 * np.pi / 128
    s = np.sqrt(1 - mu**2)[:, None]
    wi = np.stack([s * np.cos(phi), s * np.sin(phi), mu[:, None] + 0 * phi], axis=-1)
    cosines = np.linspace(0.05, 1, 200) ** 2
    return cosines, np.array([(charlie_lobe(np.array([np.sqrt(1 - c * c), 0, c]), wi, r) * weights).sum()
                              for c in cosines])


def zeltner_albedo(mu, r):
    """The fit of MaterialX 1.39 to the table of Zeltner et al. 2022: a Gaussian of the cosine and an offset."""
    width = r * (0.0206607 + 1.58491 * r) / (0.0379424 + 1.32227 * r + r**2)
    middle = (-0.193854 * r - 1.14885 * r**2 + 1.7932 * r**3 - 0.95943 * r**5) / (0.046391 + r)
    offset = (0.000654023 * r - 0.0207818 * r**2 + 0.119681 * r**3) / (1.26264 - 1.92021 * r + r**2)
    return np.exp(-((mu - middle) ** 2) / (2 * width**2)) / (width * np.sqrt(2 * np.pi)) + offset


def zeltner_lobe(wo, wi, r):
    """Zeltner et al. 2022, eqs. 5 to 7: E times the density of a linearly transformed cosine, by its matrix."""
    mu = wo[..., 2]
    a = (2.58126 * mu * r + 0.813703 * r**2) / (1 + 0.310327 * mu**2 + 2.60994 * mu * r)
    b = np.sqrt(1 - mu) * (r - 1) * r**3 / (0.0000254053 + 1.71228 * mu - 1.71506 * mu * r + 1.34174 * r**2)
    tangent = unit(np.where(mu[..., None] < 1, wo * [1, 1, 0], [1.0, 0, 0]))  # any along the normal, where b is 0
    across = np.cross([0, 0, 1.0], tangent)
    local = np.stack([(wi * tangent).sum(axis=-1), (wi * across).sum(axis=-1), wi[..., 2]], axis=-1)
    none = 0 * mu
    matrix = np.stack([np.stack([a, none, b], -1), np.stack([none, a, none], -1), np.stack([none, none, 1 + none], -1)],
                      axis=-2)
    back = (matrix @ local[..., None])[..., 0]
    length = np.linalg.norm(back, axis=-1)
    density = back[..., 2] / length / np.pi * np.linalg.det(matrix) / length**3
    return zeltner_albedo(mu, r) * density / wi[..., 2]
