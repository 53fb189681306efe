"""Directions wi by their half vector h: where lobes of every width are smooth, and integrals over them converge.

Reflection: wi = 2 (wo.h) h - wo,  dwi = 4 (wo.h) dh. Transmission: h ~ -(wo + eta wi), turned to wo's side, and
dwi = (cos_t - VoH / eta)^2 / cos_t dh, cos_t = |wi.h| (Walter et al. 2007, eqs. 13 to 17). h is given in polar angles
about the normal, phi from wo's own azimuth.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

PANEL_NODES, AZIMUTH_NODES = 40, 64
BIN_POWER = 5  # theta_h = pi / 2 x^5: the bins in x see lobes of alpha 1e-3 and of alpha 1 alike


@dataclass(frozen=True)
class Directions:
    """Directions wi (K, Q, 3) for each of K directions wo, and the solid angle each stands for, (K, Q)."""

    wi: np.ndarray
    solid_angle: np.ndarray


def reflected_grid(wo: np.ndarray, azimuth_nodes: int = AZIMUTH_NODES) -> Directions:
    """Nodes and weights of an integral over the hemisphere, for wo (K, 3) above the horizon.

    Gauss-Legendre, between the angles where the horizon begins and ends to cut the circle of h, and in phi up to the
    horizon itself, so that no step is left in the integrand.
    """
    theta_o = np.arccos(np.clip(wo[:, 2], -1, 1))
    edges = np.stack([0 * theta_o, (np.pi / 2 - theta_o) / 2, (np.pi / 2 + theta_o) / 2], axis=1)
    s, ds = _unit_nodes(PANEL_NODES)
    graded, d_graded = s**3 * (10 + s * (6 * s - 15)), 30 * (s * (1 - s)) ** 2 * ds
    theta = np.concatenate([low + (high - low) * graded for low, high in _pairs(edges)], axis=1)
    d_theta = np.concatenate([(high - low) * d_graded for low, high in _pairs(edges)], axis=1)
    sin_o, cos_o = np.sin(theta_o)[:, None], wo[:, 2:]
    phi_max = _horizon(sin_o, cos_o, theta)
    s, ds = _unit_nodes(azimuth_nodes)
    phi = phi_max[..., None] * (2 * s - 1)
    d_phi = 2 * phi_max[..., None] * ds
    theta, d_theta = (np.broadcast_to(a[..., None], phi.shape) for a in (theta, d_theta))
    wi, jacobian = reflect(wo, *(a.reshape(len(wo), -1) for a in (theta, phi)))
    solid_angle = jacobian * (np.sin(theta) * d_theta * d_phi).reshape(len(wo), -1)
    return Directions(wi, np.where(wi[..., 2] > 0, solid_angle, 0.0))


def refracted_grid(wo: np.ndarray, eta: np.ndarray, azimuth_nodes: int = AZIMUTH_NODES) -> Directions:
    """As `reflected_grid`, for the directions beyond the surface; eta (K,)."""
    s, ds = _unit_nodes(3 * PANEL_NODES)
    theta, d_theta = np.pi / 2 * s**3, np.pi / 2 * 3 * s**2 * ds
    phi = (np.arange(azimuth_nodes) + 0.5) / azimuth_nodes * 2 * np.pi
    theta, phi = (np.tile(a.ravel(), (len(wo), 1)) for a in np.meshgrid(theta, phi, indexing="ij"))
    weight = np.repeat(np.sin(np.pi / 2 * s**3) * d_theta, azimuth_nodes) * 2 * np.pi / azimuth_nodes
    wi, jacobian = refract(wo, eta, theta, phi)
    return Directions(wi, jacobian * weight)


def mirrored(directions: Directions) -> Directions:
    """The same seen in the surface's plane, from z to -z: beyond a thin wall."""
    return Directions(directions.wi * [1, 1, -1], directions.solid_angle)


def reflect(wo: np.ndarray, theta: np.ndarray, phi: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """wi (K, Q, 3) and dwi / dh (K, Q), 0 where h faces away or wi lies below."""
    h = _half_vector(wo, theta, phi)
    VoH = np.einsum("kc,kqc->kq", wo, h)
    wi = 2 * VoH[..., None] * h - wo[:, None]
    return wi, np.where((VoH > 0) & (wi[..., 2] > 0), 4 * VoH, 0.0)


def refract(wo: np.ndarray, eta: np.ndarray, theta: np.ndarray, phi: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """As `reflect`, through the surface; 0 at total reflection, too."""
    h, eta = _half_vector(wo, theta, phi), eta[:, None]
    VoH = np.einsum("kc,kqc->kq", wo, h)
    cos2_t = 1 - (1 - VoH**2) / eta**2
    cos_t = np.sqrt(np.maximum(cos2_t, 0))
    wi = (VoH / eta - cos_t)[..., None] * h - wo[:, None] / eta[..., None]
    goes = (VoH > 0) & (cos2_t > 0) & (wi[..., 2] < 0)
    with np.errstate(divide="ignore", invalid="ignore"):
        return wi, np.where(goes, (cos_t - VoH / eta) ** 2 / cos_t, 0.0)


def bin_coordinates(wo: np.ndarray, wi: np.ndarray, eta: Any = None) -> tuple[np.ndarray, np.ndarray]:
    """(x, phi) of wi (K, Q, 3), x in [0, 1] and phi in [-pi, pi], by reflection or, with eta (K,), by transmission."""
    h = wo[:, None] + wi if eta is None else wo[:, None] + np.asarray(eta)[:, None, None] * wi
    h = h * np.where(h[..., 2:] < 0, -1, 1)
    theta = np.arctan2(np.hypot(h[..., 0], h[..., 1]), h[..., 2])
    phi = np.arctan2(h[..., 1], h[..., 0]) - np.arctan2(wo[:, 1], wo[:, 0])[:, None]
    return (theta / (np.pi / 2)) ** (1 / BIN_POWER), (phi + np.pi) % (2 * np.pi) - np.pi


def binned_grid(wo: np.ndarray, bins: tuple[int, int], nodes: tuple[int, int],
                eta: np.ndarray | None = None) -> Directions:
    """`nodes` along x and phi in each of `bins` of `bin_coordinates`, bin after bin in one axis: (K, bins * nodes).

    Midpoints in x, Gauss-Legendre in phi.
    """
    inner_x, inner_phi = nodes
    x = (np.arange(bins[0] * inner_x) + 0.5) / (bins[0] * inner_x)
    theta = np.pi / 2 * x**BIN_POWER
    d_theta = np.pi / 2 * BIN_POWER * x ** (BIN_POWER - 1) / len(x)
    edges = np.linspace(-np.pi, np.pi, bins[1] + 1)
    low, high = (np.broadcast_to(e, (len(wo), len(theta), bins[1])) for e in (edges[:-1], edges[1:]))
    if eta is None:  # a bin ends at the horizon where that cuts it
        theta_o = np.arccos(np.clip(wo[:, 2:], -1, 1))
        phi_max = _horizon(np.sin(theta_o), wo[:, 2:], theta)[..., None]
        low, high = (np.clip(e, -phi_max, phi_max) for e in (low, high))
    s, ds = _unit_nodes(inner_phi)
    phi = low[..., None] + (high - low)[..., None] * s
    weight = (high - low)[..., None] * ds * (np.sin(theta) * d_theta)[:, None, None]
    # From (x, inner_x, bin of phi, inner_phi) to a bin's nodes side by side.
    thetas = np.broadcast_to(theta[:, None, None], phi.shape)
    grouped = [a.reshape(len(wo), bins[0], inner_x, bins[1], inner_phi).transpose(0, 1, 3, 2, 4)
               for a in (thetas, phi, weight)]
    thetas, phi, weight = (a.reshape(len(wo), -1) for a in grouped)
    wi, jacobian = reflect(wo, thetas, phi) if eta is None else refract(wo, eta, thetas, phi)
    return Directions(wi, jacobian * weight)


def bin_integrals(density: Callable[[np.ndarray], np.ndarray], grid: Directions, bins: tuple[int, int]) -> np.ndarray:
    """Integrals over each bin of a `binned_grid` of `density`, which takes wi (K, Q, 3) and gives (K, Q): (K, bins of x
    * bins of phi)."""
    values = np.where(grid.solid_angle > 0, density(grid.wi), 0.0)  # else wi is no direction
    return (values * grid.solid_angle).reshape(len(values), bins[0] * bins[1], -1).sum(axis=2)


def bin_counts(wo: np.ndarray, wi: np.ndarray, counted: np.ndarray, bins: tuple[int, int],
               eta: np.ndarray | None = None) -> np.ndarray:
    """How many of the directions wi (K, Q, 3) that are `counted` (K, Q) fall into each bin: (K, bins), as above."""
    x, phi = bin_coordinates(wo, wi, eta)
    return np.stack([np.histogram2d(x[k, chosen], phi[k, chosen], bins, ((0, 1), (-np.pi, np.pi)))[0].ravel()
                     for k, chosen in enumerate(counted)])


def _horizon(sin_o: np.ndarray, cos_o: np.ndarray, theta: np.ndarray) -> np.ndarray:
    """The largest phi, in [0, pi], at which h of this theta still reflects upwards."""
    limit = (cos_o / (2 * np.cos(theta)) - cos_o * np.cos(theta)) / np.maximum(sin_o * np.sin(theta), 1e-300)
    return np.arccos(np.clip(limit, -1, 1))


def _half_vector(wo: np.ndarray, theta: np.ndarray, phi: np.ndarray) -> np.ndarray:
    turned, sine = phi + np.arctan2(wo[:, 1], wo[:, 0])[:, None], np.sin(theta)
    return np.stack([sine * np.cos(turned), sine * np.sin(turned), np.cos(theta)], axis=-1)


def _unit_nodes(count: int) -> tuple[np.ndarray, np.ndarray]:
    """Gauss-Legendre on [0, 1]."""
    x, weight = np.polynomial.legendre.leggauss(count)
    return (x + 1) / 2, weight / 2


def _pairs(edges: np.ndarray) -> list[tuple[np.ndarray, np.ndarray]]:
    return [(edges[:, k, None], edges[:, k + 1, None]) for k in range(edges.shape[1] - 1)]
