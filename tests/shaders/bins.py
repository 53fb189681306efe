"""A density's integral over bins of half vectors, in which lobes of every width show."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from viewer.measure.check.half_vector import reflect, refract

BINS = (16, 10)  # of (theta_h / (pi / 2))^(1/5) and of the azimuth from wo's
NODES = (56, 10)  # in each bin; 56 * 16 has a cell end at 45 degrees, where what a steep view reflects stops at once
POWER = 5


def expected_shares(density: Callable[[np.ndarray], np.ndarray], wo: np.ndarray, eta: np.ndarray | None) -> np.ndarray:
    """Integrals (K, bins) of `density` over the directions reflected or, with eta (K,), refracted.

    `density` takes wi (K, Q, 3) and gives (K, Q). Midpoints in theta_h, Gauss-Legendre in phi up to where the horizon
    cuts the bin.
    """
    x = (np.arange(BINS[0] * NODES[0]) + 0.5) / (BINS[0] * NODES[0])
    theta = np.pi / 2 * x**POWER
    d_theta = np.pi / 2 * POWER * x ** (POWER - 1) / len(x)
    limit = np.full((len(wo), len(x)), np.pi)
    if eta is None:
        cos_o, sin_o = wo[:, 2:], np.sqrt(1 - wo[:, 2:] ** 2)
        cut = (cos_o / (2 * np.cos(theta)) - cos_o * np.cos(theta)) / np.maximum(sin_o * np.sin(theta), 1e-300)
        limit = np.arccos(np.clip(cut, -1, 1))
    edges = np.linspace(-np.pi, np.pi, BINS[1] + 1)
    low, high = (np.clip(e, -limit[..., None], limit[..., None])[..., None] for e in (edges[:-1], edges[1:]))
    node, weight = np.polynomial.legendre.leggauss(NODES[1])
    phi = low + (high - low) * (node + 1) / 2
    solid_angle = (high - low) * weight / 2 * (np.sin(theta) * d_theta)[:, None, None]
    thetas = np.broadcast_to(theta[:, None, None], phi.shape)
    flat = [a.reshape(len(wo), -1) for a in (thetas, phi, solid_angle)]
    wi, jacobian = reflect(wo, *flat[:2]) if eta is None else refract(wo, eta, *flat[:2])
    found = np.where(jacobian > 0, density(wi) * jacobian * flat[2], 0.0)
    return found.reshape(len(wo), BINS[0], NODES[0], BINS[1], NODES[1]).sum(axis=(2, 4)).reshape(len(wo), -1)


def counts(wo: np.ndarray, wi: np.ndarray, eta: float | None) -> np.ndarray:
    """How many of wi (N, 3), sampled for wo (3,), fall into each bin."""
    h = wo + wi if eta is None else wo + eta * wi
    h = h * np.where(h[:, 2:] < 0, -1, 1)
    x = (np.arctan2(np.hypot(h[:, 0], h[:, 1]), h[:, 2]) / (np.pi / 2)) ** (1 / POWER)
    phi = (np.arctan2(h[:, 1], h[:, 0]) - np.arctan2(wo[1], wo[0]) + np.pi) % (2 * np.pi) - np.pi
    return np.histogram2d(x, phi, BINS, ((0, 1), (-np.pi, np.pi)))[0].ravel()
