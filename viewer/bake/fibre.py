"""Light scattered about a fibre that is seen from afar: the lobes of Chiang et al. (2016), their mean over the fibre's
width.

A fibre that is thinner than a pixel shows the mean over all offsets h at which rays meet it:

    a_p(phi) = 1/2 integral_-1^1 A_p(h) D(phi - Phi_p(h)) dh

A_p is what the fibre lets through, Phi_p the angle by which it turns light, and D the trimmed logistic distribution
(shaders/bsdf/fibre/fibre.glsl). It depends on the angle phi about the fibre, on the inclination of the view and, for
each channel by itself, on the absorption.
"""

from __future__ import annotations

import math
from functools import lru_cache

import numpy as np

ANGLES, COSINES, ABSORPTIONS = 128, 16, 24
"""The texels of the table along each axis."""
HALF_ABSORPTION = 0.5
"""Absorption at the middle of its axis: x = sigma / (sigma + HALF_ABSORPTION)."""
_OFFSETS = 256


@lru_cache(maxsize=4)
def fibre_table(beta_n: float, ior: float) -> np.ndarray:
    """a_p of R, TT, TRT and of all that is reflected inside more often, (ABSORPTIONS, COSINES, ANGLES, 4) float32.

    Texel centres lie at phi = pi (i + 1/2) / ANGLES, cos theta_o = j / (COSINES - 1) and x = k / (ABSORPTIONS - 1),
    where the last x is that of a very large absorption. Each texel has the mean over its range of phi, so that lobes
    narrower than a texel keep their light.
    """
    # h = sin gamma_o: equal steps of gamma_o follow the lobes to both edges, where R turns fast.
    gamma_o = ((np.arange(_OFFSETS) + 0.5) / _OFFSETS - 0.5) * math.pi
    h, weights = np.sin(gamma_o), np.cos(gamma_o)
    weights /= weights.sum()
    x = np.minimum(np.arange(ABSORPTIONS) / (ABSORPTIONS - 1), 0.999)
    sigma = HALF_ABSORPTION * x / (1 - x)
    scale = _scale(beta_n)
    edges = np.arange(ANGLES + 1) * math.pi / ANGLES
    out = np.empty((ABSORPTIONS, COSINES, ANGLES, 4))
    for j in range(COSINES):
        cosine = max(j / (COSINES - 1), 1e-3)
        delta = ior * ior - 1 + cosine * cosine  # eta^2 - sin^2 theta_o
        gamma_t = np.arcsin(np.clip(h * cosine / math.sqrt(delta), -1, 1))
        fresnel = _fresnel(cosine * np.cos(gamma_o), ior)
        way = 2 * np.cos(gamma_t) * ior / math.sqrt(delta)
        passed = np.exp(-sigma[:, None] * way)
        shares = [np.broadcast_to(fresnel, passed.shape), (1 - fresnel)**2 * passed]
        shares.append(shares[1] * fresnel * passed)
        rest = (shares[2] * fresnel * passed / np.maximum(1 - fresnel * passed, 1e-12)) @ weights
        for p, share in enumerate(shares):
            turned = _turned(edges[:, None] - (2 * p * gamma_t - 2 * gamma_o + p * math.pi), scale)
            # No product of matrices: where other processes are busy, its threads wait for each other for seconds.
            out[:, j, :, p] = np.einsum("ko,io->ki", share * weights, turned)
        out[:, j, :, 3] = rest[:, None] / (2 * math.pi)
    return out.astype(np.float32)


def _turned(edges: np.ndarray, scale: float) -> np.ndarray:
    """The mean density of D between neighbouring `edges` (n + 1, offsets), (n, offsets).

    It is even in the mean over all offsets, h and -h, so that angles from 0 to pi are enough.
    """
    whole = np.round(edges / (2 * math.pi))
    wrapped = edges - 2 * math.pi * whole
    keep = math.tanh(math.pi / (2 * scale))
    upto = 0.5 + 0.5 * np.tanh(wrapped / (2 * scale)) / keep + whole
    return np.diff(upto, axis=0) * ANGLES / math.pi


def _scale(beta_n: float) -> float:
    """As fibre_scale() in shaders/bsdf/fibre/fibre.glsl."""
    return max(math.sqrt(math.pi / 8) * (0.265 * beta_n + 1.194 * beta_n**2 + 5.372 * beta_n**22), 1e-3)


def _fresnel(cosine: np.ndarray, ior: float) -> np.ndarray:
    """Of a dielectric, exact."""
    inside = np.sqrt(ior * ior - 1 + cosine * cosine)
    parallel = (ior * ior * cosine - inside) / np.maximum(ior * ior * cosine + inside, 1e-12)
    perpendicular = (cosine - inside) / np.maximum(cosine + inside, 1e-12)
    return (parallel**2 + perpendicular**2) / 2
