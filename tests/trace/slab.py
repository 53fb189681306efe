"""Light in a plane slab of a homogeneous medium of index 1, in float64: discrete ordinates, without random numbers.

Chandrasekhar 1960, "Radiative Transfer": mu dI/dtau = -I + albedo/2 * integral of p(mu, mu') I(mu') dmu', for light
that does not depend on the azimuth. The phase function enters by its Legendre series, g^l for Henyey and Greenstein.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from numpy.polynomial.legendre import leggauss, legvander


class Slab(NamedTuple):
    """Light in a slab: the moments of its radiance at the optical depth t above its lower face, `(terms,)`, and
    2 l + 1 times those of the phase function, with half the albedo."""

    moments: Callable[[float], np.ndarray]
    series: np.ndarray

    def source(self, t: float, mu: float) -> float:
        """What is scattered there into a direction of this cosine to the vertical."""
        return float(self.moments(t) * self.series @ legvander(np.array([mu]), len(self.series) - 1)[0])


def slab_light(tau: float, albedo: float, g: float, above: float, below: float, nodes: int = 32,
               terms: int = 48) -> Slab:
    """That of a slab in uniform light from above and from below."""
    half, weights = leggauss(nodes)
    mu, w = (half + 1) / 2, weights / 2
    mu, w = np.r_[mu, -mu], np.r_[w, w]  # upwards, downwards
    order = np.arange(terms)
    series = albedo / 2 * (2 * order + 1) * g**order
    values = legvander(mu, terms - 1)
    phase = (values * series) @ values.T
    generator = (phase * w - np.eye(2 * nodes)) / mu[:, None]  # dI/dtau, tau counted upwards
    roots, vectors = np.linalg.eig(generator)
    # Growing modes are measured from the top, so that no exponential overflows.
    start = np.where(roots.real > 0, tau, 0.0)

    def modes(at: float) -> np.ndarray:
        return vectors * np.exp(roots * (at - start))

    top, bottom = modes(tau), modes(0.0)
    up, down = slice(0, nodes), slice(nodes, None)
    system = np.vstack([bottom[up], top[down]])
    strength = np.linalg.solve(system, np.r_[np.full(nodes, below), np.full(nodes, above)].astype(complex))
    return Slab(lambda t: ((modes(t) @ strength).real * w) @ values, series)


def slab_radiance(tau: float, albedo: float, g: float, above: float, below: float) -> tuple[float, float]:
    """The radiance that leaves the slab straight up and straight down, in uniform light from above and from below."""
    light = slab_light(tau, albedo, g, above, below)
    # The source along tau, integrated (the formal solution), at Gauss points
    points, measure = leggauss(64)
    at, measure = (points + 1) / 2 * tau, measure / 2 * tau
    source = np.array([[light.source(t, mu) for mu in (1.0, -1.0)] for t in at])
    upwards = below * np.exp(-tau) + (source[:, 0] * np.exp(-(tau - at)) * measure).sum()
    downwards = above * np.exp(-tau) + (source[:, 1] * np.exp(-at) * measure).sum()
    return float(upwards), float(downwards)
