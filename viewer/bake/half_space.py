"""How much of the light that enters a scattering medium through its boundary comes out again: an endless half-space
under a flat boundary, solved in float64.

The medium is made of layers of its optical depth 2^k: R reflects and T transmits radiance at discrete cosines, and two
equal layers make one of twice the depth (van de Hulst 1963; Grant & Hunt 1969, "Discrete space theory of radiative
transfer I", which also has the start). The boundary is a smooth dielectric; its Fresnel reflectance is exact. Rough
boundaries let as much light through to a per cent.
"""

from __future__ import annotations

from functools import lru_cache
from itertools import pairwise
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    from .rough_boundary import RoughBoundary

_NODES = 10
"""Gauss points on each side of the critical cosine. Twice as many change the albedo by less than 1e-4."""
_FIRST_DEPTH = 1e-6
_DOUBLINGS = 60

Matrix = NDArray[np.float64]


def fresnel(mu: Matrix, eta: float) -> Matrix:
    """Reflectance of a smooth dielectric at the cosines `mu`; `eta` is the index on the far side over that on this one.

    In the form of shaders/bsdf/fresnel.glsl, which has no cancellation at eta = 1.
    """
    delta = (eta - 1.0) * (eta + 1.0)
    squared = delta + mu * mu
    g = np.sqrt(np.maximum(squared, 0.0))
    s = -delta / np.maximum(mu + g, 1e-300) ** 2
    p = delta * ((eta * eta + 1.0) * mu * mu - 1.0) / np.maximum(eta * eta * mu + g, 1e-300) ** 2
    return np.where(squared <= 0.0, 1.0, 0.5 * (s * s + p * p)) if eta != 1.0 else np.zeros_like(mu)


@lru_cache(maxsize=64)
def internal_reflectance(ior: float) -> float:
    """The share of light from inside that a smooth boundary reflects back in, where radiance is the same in all
    directions: 1 - (1 - F) / ior^2, with F the mean for light from outside."""
    x, w = np.polynomial.legendre.leggauss(256)
    mu = 0.5 * (x + 1.0)
    entering = 1.0 - float((w * mu) @ fresnel(mu, ior))
    return 1.0 - entering / (ior * ior)


@lru_cache(maxsize=256)
def returned_light(albedo: float, g: float, ior: float, rough: RoughBoundary | None = None) -> float:
    """The share, from 0 to 1, of uniform light that comes out of a half-space again, of what has entered it.

    `albedo` is that of single scattering, in [0, 1], and below 1 behind a boundary that is `rough`; `g` is the mean
    cosine of a Henyey-Greenstein phase function; `ior` >= 1 is the index of the medium, as in `rough`.
    """
    if albedo <= 0.0:
        return 0.0
    if albedo >= 1.0:
        return 1.0
    mu, w = cosines(ior)
    forward, backward, peak = _phase(mu, w, g)
    depth = _FIRST_DEPTH * mu.min()
    reflect, transmit = _thin_layer(mu, w, albedo * (1.0 - peak) / (1.0 - albedo * peak), forward, backward, depth)
    identity = np.eye(len(mu))
    for _ in range(_DOUBLINGS):
        between = np.linalg.inv(identity - reflect @ reflect)
        reflect, transmit = (reflect + transmit @ between @ reflect @ transmit, transmit @ between @ transmit)
        if np.abs(transmit).max() < 1e-9:
            break
    if rough is None:
        inside = fresnel(mu, 1.0 / ior)
        back, leaving = np.diag(inside), 1.0 - inside
    else:
        back, leaving = rough.from_inside(mu, w)
    entering = leaving  # of radiance 1 outside, per ior^2: the same, by reciprocity
    upward = np.linalg.solve(identity - reflect @ back, reflect @ entering)
    flux = w * mu
    return float(np.clip(flux @ (leaving * upward) / (flux @ entering), 0.0, 1.0))


def cosines(ior: float) -> tuple[Matrix, Matrix]:
    """Gauss points and weights on (0, 1), in two parts that meet at the critical cosine, where the reflectance bends.
    """
    critical = np.sqrt(max(1.0 - 1.0 / (ior * ior), 0.0))
    ends = [0.0, critical, 1.0] if critical > 0.0 else [0.0, 1.0]
    x, w = np.polynomial.legendre.leggauss(_NODES)
    parts = [(a + 0.5 * (b - a) * (x + 1.0), 0.5 * (b - a) * w) for a, b in pairwise(ends)]
    return np.concatenate([mu for mu, _ in parts]), np.concatenate([weight for _, weight in parts])


def _phase(mu: Matrix, w: Matrix, g: float) -> tuple[Matrix, Matrix, float]:
    """The phase function's mean over azimuths, for directions on the same and on opposite sides, and the share of it
    that is taken for light that goes straight on (Wiscombe 1977, "The delta-M method"). Columns keep their energy."""
    order = np.arange(len(mu))
    peak = g ** len(mu)
    moments = (2.0 * order + 1.0) * (g ** order.astype(float) - peak) / (1.0 - peak)
    values = np.array([np.polynomial.legendre.legval(mu, row) for row in np.eye(len(mu))])
    forward = np.einsum("l,li,lj->ij", moments, values, values)
    backward = np.einsum("l,li,lj->ij", moments * (-1.0) ** order, values, values)
    total = 0.5 * w @ (forward + backward)
    return forward / total, backward / total, float(peak)


def _thin_layer(mu: Matrix, w: Matrix, albedo: float, forward: Matrix, backward: Matrix,
                depth: float) -> tuple[Matrix, Matrix]:
    """R and T of a layer whose optical depth is far below 1."""
    identity, per_cosine = np.eye(len(mu)), 0.5 * depth / mu[:, None]
    a = np.linalg.inv(identity + per_cosine * (identity - 0.5 * albedo * forward * w))
    b = per_cosine * (0.5 * albedo * backward * w)
    g = np.linalg.inv(identity - (a @ b) @ (a @ b)) @ a
    return 2.0 * g @ b @ a, 2.0 * g - identity
