"""Many thin fibres as a medium: what light does where it meets one of them."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from ..scene.fibre import Fibre, longitudinal_variance
from .fibre import ABSORPTIONS, ANGLES, COSINES, HALF_ABSORPTION, fibre_table

ORDERS = 5
"""Legendre moments of the inclination, from 0 on."""


@dataclass(frozen=True, eq=False)
class FibreMedium:
    """For red, green and blue, (3,) each.

    Most light goes through a fibre almost straight on. A share of it as great as the mean cosine of the phase function
    counts as not scattered, and the rest as scattered evenly (similarity; van de Hulst 1980, chapter 14). `kept` is
    what that leaves of the extinction, and `albedo` is that of the rest.

    A fibre scatters light onto the cone about it that the light comes on, so that its inclination to parallel fibres
    lasts. `inclined` (3, ORDERS, ORDERS) takes the Legendre moments of the inclination of light to those of what the
    rest scatters of it.

    What goes through a fibre (TT) is turned about it. `spread` is the variance of the angle, in radians squared: that
    of a wrapped normal distribution with the same mean cosine.
    """

    kept: np.ndarray
    albedo: np.ndarray
    inclined: np.ndarray
    spread: float


def fibre_medium(fibre: Fibre) -> FibreMedium:
    """The medium of such fibres, in the mean over light from all around.

    At the inclination theta light goes on at the angle with cosine sin^2 theta - cos^2 theta cos phi. Of all light,
    cos^2 theta d theta meets the fibre there.
    """
    table = fibre_table(fibre.beta_n, fibre.ior).astype(np.float64) * (2 * math.pi / ANGLES)
    cosine = np.arange(COSINES) / (COSINES - 1)
    # cos^2 theta d theta = cos^2 theta d cos theta / sin theta: as differences of (theta + sin theta cos theta) / 2.
    edges = np.arccos(np.clip((np.arange(COSINES + 1) - 0.5) / (COSINES - 1), 0, 1))
    weights = -np.diff(edges + np.sin(edges) * np.cos(edges))
    weights /= weights.sum()
    phi = (np.arange(ANGLES) + 0.5) * math.pi / ANGLES
    turned = (1 - cosine[:, None]**2) - cosine[:, None]**2 * np.cos(phi)
    x = np.array(fibre.sigma_a) / (np.array(fibre.sigma_a) + HALF_ABSORPTION) * (ABSORPTIONS - 1)

    def mean(weigh: np.ndarray) -> np.ndarray:
        """Over all light, for the lobes and the channels, (4, 3)."""
        lobes = np.einsum("kjip,ji,j->pk", table, weigh, weights)
        return np.stack([np.interp(x, np.arange(ABSORPTIONS), lobe) for lobe in lobes])

    lobes = mean(np.ones_like(turned))
    scattered = np.clip(lobes.sum(axis=0), 1e-9, 1)
    straight = np.clip(mean(turned).sum(axis=0) / scattered, 0, 0.999)
    kept = 1 - scattered * straight
    inclined = np.einsum("pc,plm->clm", lobes / scattered, _inclined(fibre))
    rest = (inclined - straight[:, None, None] * np.eye(ORDERS)) / (1 - straight)[:, None, None]
    onwards = mean(np.broadcast_to(-np.cos(phi), turned.shape))[1].sum() / max(lobes[1].sum(), 1e-9)
    spread = -2 * math.log(min(max(onwards, 0.05), 1.0))
    return FibreMedium(kept, np.minimum(scattered * (1 - straight) / kept, 1), rest, spread)


def _inclined(fibre: Fibre) -> np.ndarray:
    """For each lobe, (4, ORDERS, ORDERS).

    Light from the inclination theta is seen by the next fibre from theta + shift: the scales tilt the lobes. M spreads
    it as a normal distribution on the sphere would, by which a moment of order l counts exp(-l (l + 1) v / 2) times.
    """
    v = longitudinal_variance(fibre.beta_m) * np.array([1, 0.25, 4, 4])
    shift = np.array([-2, 1, 4, 0]) * fibre.tilt
    sines, weights = np.polynomial.legendre.leggauss(64)
    orders = np.arange(ORDERS)
    after = np.polynomial.legendre.legvander(sines, ORDERS - 1) * weights[:, None]
    out = []
    for variance, angle in zip(v, shift, strict=True):
        before = np.polynomial.legendre.legvander(np.sin(np.arcsin(sines) - angle), ORDERS - 1)
        out.append(after.T @ before * (orders + 0.5) * np.exp(-0.5 * orders * (orders + 1) * variance))
    return np.stack(out)
