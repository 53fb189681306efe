"""The boundary of a solid whose microfacets scatter light once, as mode path has it, in float64.

GGX facets reflect the share F of the light that meets them and refract the rest. What would meet a second facet is
lost (shaders/bsdf/lobe/dielectric.glsl), so that R + T < 1. Facets are drawn by their visible area (Dupuy & Benyoub
2023, "Sampling Visible GGX Normals with Spherical Caps"), and each counts by G2 / G1 of the two directions.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from .half_space import cosines, fresnel

_FACETS = 32
"""Squared, the number of facets for each direction. Twice as many change no share by more than 1e-3."""
_SMOOTH = 1e-3
"""Below this alpha the shaders take a boundary for smooth, too."""

Array = NDArray[np.float64]


@dataclass(frozen=True)
class RoughBoundary:
    """`ior` is that of the medium inside, over that outside; `masking` a value of the setting of this name."""

    ior: float
    alpha: float
    masking: str = "smith"

    @property
    def is_rough(self) -> bool:
        return self.alpha >= _SMOOTH and self.ior > 1.0

    def from_inside(self, mu: Array, w: Array) -> tuple[Array, Array]:
        """What the boundary makes of radiance that arrives from inside at the cosines `mu` with the weights `w`: the
        radiance it reflects to each of them, (N, N) with the column of what arrives, and the share it lets out, (N,).

        Reflected light between two of the cosines is divided between them, so that its flux is kept.
        """
        (there, reflected), (_, transmitted) = self.scattered(mu, 1.0 / self.ior)
        after = np.clip(np.searchsorted(mu, there), 1, len(mu) - 1)
        upper = np.clip((there - mu[after - 1]) / (mu[after] - mu[after - 1]), 0.0, 1.0)
        flux = np.zeros((len(mu), len(mu)))
        arriving = np.broadcast_to(np.arange(len(mu))[:, None], there.shape)
        np.add.at(flux, (after, arriving), upper * reflected)
        np.add.at(flux, (after - 1, arriving), (1.0 - upper) * reflected)
        return flux * (w * mu) / (w * mu)[:, None], transmitted.sum(axis=1)

    def shares(self, is_outside: bool) -> tuple[float, float]:
        """The shares R and T of light that is the same from everywhere on one side."""
        mu, w = cosines(1.0 if is_outside else self.ior)
        (_, reflected), (_, transmitted) = self.scattered(mu, self.ior if is_outside else 1.0 / self.ior)
        return float(2.0 * (w * mu) @ reflected.sum(axis=1)), float(2.0 * (w * mu) @ transmitted.sum(axis=1))

    def scattered(self, mu: Array, eta: float) -> tuple[tuple[Array, Array], tuple[Array, Array]]:
        """For each of `mu` (N,) and of the facets (M): the cosine to which light is reflected and its share, and those
        of what is refracted, (N, M) each. `eta` is the index on the far side over that on this one."""
        n_o, v_o, v_n = self._visible_facets(mu)
        reflectance = fresnel(v_o, eta)
        back = 2.0 * v_o * v_n - n_o  # cosine of what is reflected
        c_t = np.sqrt(np.maximum(1.0 - (1.0 - v_o * v_o) / (eta * eta), 0.0))
        onward = -((v_o / eta - c_t) * v_n - n_o / eta)
        lambda_o = self._lambda(n_o)
        reflected = np.where(back > 0.0, reflectance * self._seen(lambda_o, self._lambda(back), False), 0.0)
        refracted = np.where(onward > 0.0, (1.0 - reflectance) * self._seen(lambda_o, self._lambda(onward), True), 0.0)
        count = v_n.shape[1]
        return (np.maximum(back, 0.0), reflected / count), (np.maximum(onward, 0.0), refracted / count)

    def _visible_facets(self, mu: Array) -> tuple[Array, Array, Array]:
        """The cosines between normal and direction (N, 1), facet and direction, and facet and normal, (N, M)."""
        u = (np.arange(_FACETS) + 0.5) / _FACETS
        phi, v = (part.ravel() for part in np.meshgrid(math.tau * u, u))
        n_o = mu[:, None]
        sine = np.sqrt(np.maximum(1.0 - n_o * n_o, 0.0))
        length = np.hypot(self.alpha * sine, n_o)
        x, z = self.alpha * sine / length, n_o / length  # the direction where the facets are a half sphere
        cap = (1.0 - v) * (1.0 + z) - z
        around = np.sqrt(np.maximum(1.0 - cap * cap, 0.0))
        h = np.stack([self.alpha * (around * np.cos(phi) + x), self.alpha * (around * np.sin(phi)), cap + z])
        h /= np.linalg.norm(h, axis=0)
        return n_o, np.clip(h[0] * sine + h[2] * n_o, 0.0, 1.0), h[2]

    def _lambda(self, cosine: Array) -> Array:
        tan2 = 1.0 / np.maximum(cosine, 1e-9) ** 2 - 1.0
        return 0.5 * (np.sqrt(1.0 + self.alpha**2 * tan2) - 1.0)

    def _seen(self, lambda_o: Array, lambda_i: Array, is_other_side: bool) -> Array:
        """G2 / G1 (shaders/bsdf/ggx_masking.glsl)."""
        if self.masking == "smith-separable":
            return 1.0 / (1.0 + lambda_i)
        if is_other_side:
            return (1.0 + lambda_o) * _beta(1.0 + lambda_o, 1.0 + lambda_i)
        return (1.0 + lambda_o) / (1.0 + lambda_o + lambda_i)


def _beta(x: Array, y: Array) -> Array:
    return np.exp(_log_gamma(x) + _log_gamma(y) - _log_gamma(x + y)).astype(float)


def _log_gamma(x: Array) -> Array:
    """Of x >= 1, to 1e-10: Stirling's series of x + 7, by x Gamma(x) = Gamma(x + 1)."""
    z = x + 7.0
    steps = x * (x + 1.0) * (x + 2.0) * (x + 3.0) * (x + 4.0) * (x + 5.0) * (x + 6.0)
    series = 1.0 / (12.0 * z) - 1.0 / (360.0 * z**3) + 1.0 / (1260.0 * z**5)
    return (z - 0.5) * np.log(z) - z + 0.5 * math.log(math.tau) + series - np.log(steps)
