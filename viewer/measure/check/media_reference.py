"""What the shaders of media should give, in float64 from the papers, as `reference.py` has it of surfaces."""

from __future__ import annotations

from typing import Any

import numpy as np

Array = Any


def henyey_greenstein(g: Array, mu: Array) -> Array:
    """Henyey & Greenstein 1941, normalised over the sphere; in long double, since the denominator cancels."""
    g, mu = np.longdouble(g), np.longdouble(mu)
    return ((1 - g**2) / (4 * np.longdouble(np.pi) * (1 + g**2 - 2 * g * mu) ** 1.5)).astype(np.float64)


def bounded_distance(sigma_t: Array, limit: Array, u: Array) -> Array:
    """The distance below which a collision before `limit` lies with probability u: inverse of exponential distances."""
    return -np.log1p(u * np.expm1(-sigma_t * limit)) / sigma_t


def passing_weight(tau: Array, ratio: Array) -> Array:
    """exp(-tau) over its mean over three channels, of which the others have the optical depths tau times `ratio`."""
    with np.errstate(over="ignore"):
        return 3 / (1 + 2 * np.exp(-tau * (ratio - 1)))


def collision_weight(tau: Array, ratio: Array) -> Array:
    """As `passing_weight`, of sigma_t exp(-tau)."""
    with np.errstate(over="ignore"):
        return 3 / (1 + 2 * ratio * np.exp(-tau * (ratio - 1)))
