"""Participating media, which fill volumes and absorb, scatter and emit the light that travels through them."""

from __future__ import annotations

import math
from dataclasses import dataclass

RGB = tuple[float, float, float]


@dataclass(frozen=True)
class Medium:
    """A homogeneous medium, given by the coefficients of the radiative transfer equation (Chandrasekhar 1960).

    `sigma_t` is the extinction coefficient, absorption and scattering together, RGB per world unit: over a distance d
    the transmittance is exp(-sigma_t d) (Beer's law). `albedo` is the single-scattering albedo, the share of extinction
    that is scattering, RGB in [0, 1]. `g`, in (-1, 1), is the mean cosine of the Henyey-Greenstein phase function: with
    g > 0 light is scattered forwards. A `droplet_diameter` of 5 to 50 micrometres means the phase function of droplets
    of water instead (Jendersie and d'Eon 2023). `emission` is radiance per world unit, RGB; only volumes emit. Shaders
    read a medium in shaders/media/medium.glsl.
    """

    sigma_t: RGB = (0.0, 0.0, 0.0)
    albedo: RGB = (0.0, 0.0, 0.0)
    g: float = 0.0
    droplet_diameter: float = 0.0
    emission: RGB = (0.0, 0.0, 0.0)

    @property
    def phase(self) -> float:
        """The number by which shaders know the phase function: `g`, or the diameter of droplets, which is above 1."""
        return self.droplet_diameter or self.g

    @property
    def sigma_a(self) -> RGB:
        """The absorption coefficient, RGB per world unit: sigma_t (1 - albedo)."""
        red, green, blue = (s * (1.0 - a) for s, a in zip(self.sigma_t, self.albedo, strict=True))
        return red, green, blue

    @property
    def scatters(self) -> bool:
        """Whether it scatters light."""
        return any(s > 0 and a > 0 for s, a in zip(self.sigma_t, self.albedo, strict=True))


VACUUM = Medium()


def single_scattering_albedo(color: RGB, g: float = 0.0) -> RGB:
    """The albedo of one scattering for which all scattering together makes a half-space of a medium of one index look
    as bright as `color`, in [0, 1], under light from all around.

    With s = 4.09712 + 4.20863 c - sqrt(9.59217 + 41.6808 c + 17.7126 c^2) it is 1 - s^2 for isotropic scattering
    (KHR_materials_volume_scatter, whatever g), and (1 - s^2) / (1 - g s^2) for the mean cosine `g`
    (KHR_materials_scatter): the fit of Kulla and Conty 2017, "Revisiting Physically Based Shading at Imageworks".
    """
    squares = [(4.09712 + 4.20863 * c - math.sqrt(9.59217 + 41.6808 * c + 17.7126 * c * c)) ** 2 for c in color]
    red, green, blue = (min(max((1.0 - s2) / (1.0 - g * s2), 0.0), 1.0) for s2 in squares)
    return red, green, blue


def scaled(color: RGB, factor: float) -> RGB:
    """`color` times `factor`."""
    red, green, blue = (c * factor for c in color)
    return red, green, blue
